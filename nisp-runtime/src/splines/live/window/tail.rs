//! The rows of a step: those of the tail, about the present state.

use super::Window;
use crate::schema::{Term, TermKind};
use crate::solve::fault::Fault;
use crate::splines::KINDS;
use crate::splines::assembly::RIDGE;
use crate::splines::group::Group;
use crate::splines::live::event::Event;
use crate::splines::prior::Prior;
use crate::splines::rows::Rows;
use crate::splines::triangle::Row;

/// Which rows of a step are wanted: those of the cell that leaves the tail, and those that stay in it.
pub(super) struct Split {
    pub(super) leaving: Rows,
    pub(super) staying: Rows,
    /// Those of the rows that stay that compare with something measured.
    pub(super) observed: Vec<Observed>,
}

impl Split {
    /// The rows that leave the window, or those that stay.
    fn at(&mut self, leaves: bool) -> &mut Rows {
        if leaves { &mut self.leaving } else { &mut self.staying }
    }
}

/// A row of an observation, over its noise and about the reference.
pub(super) struct Observed {
    /// Place of its event, and the group and row of what it observes.
    pub(super) at: f64,
    pub(super) what: (usize, usize),
    pub(super) first: usize,
    pub(super) slopes: Vec<f64>,
    pub(super) value: f64,
}

impl Observed {
    fn new((at, what): (f64, (usize, usize)), row: Row<'_>) -> Self {
        Self { at, what, first: row.first, slopes: row.slopes.to_vec(), value: row.value }
    }
}

impl Window {
    /// Rows of the tail, and of the cell before it, about the present state.
    pub(super) fn rows(&mut self) -> Result<Split, Fault> {
        let mut split = Split {
            leaving: Rows::new(self.follow.len()),
            staying: Rows::new(self.follow.len()),
            observed: Vec::new(),
        };
        let left = self.grid.left();
        let mut equations = std::mem::take(&mut self.equations);
        for (at, group) in &mut equations {
            group.begin_at(&self.places, left);
            let mut places = (0..self.places.len()).filter_map(|p| Some((p, self.grid.cell_of_equation(p)?)));
            self.add_group(*at, group, &mut places, &[], &mut split)?;
        }
        self.equations = equations;
        let schema = self.bound.problem.scene().schema;
        for (at, schema) in schema.groups.iter().enumerate() {
            let own = || self.events.iter().filter(|event| event.group == at);
            if own().next().is_none() {
                continue;
            }
            let places: Vec<f64> = own().map(|event| event.at - left).collect();
            let filled = |x: f64| if x.is_nan() { 0.0 } else { x };
            let column = |column: usize| own().map(|event| filled(event.columns[column])).collect();
            let columns: Vec<Vec<f64>> = (0..schema.columns.len()).map(column).collect();
            let mut group = Group::new(schema, self.kernels[at], &self.heads, &places, &columns);
            group.begin_at(&places, left);
            let events: Vec<&Event> = own().collect();
            let cells: Vec<usize> = events.iter().map(|event| self.grid.cell(event.at)).collect();
            let mut all = cells.into_iter().enumerate();
            self.add_group(at, &group, &mut all, &events, &mut split)?;
        }
        self.add_priors(&mut split);
        Ok(split)
    }

    /// Adds the rows of a group at those of its places that are in the tail or the cell before it. What was measured there comes in
    /// events, in the order of the places.
    fn add_group(
        &self,
        at: usize,
        group: &Group,
        places: &mut dyn Iterator<Item = (usize, usize)>,
        events: &[&Event],
        split: &mut Split,
    ) -> Result<(), Fault> {
        let found = group.evaluate(&self.heads, &self.theta, &self.weights.scalars, Some(self.follow.len()));
        let tail = self.grid.tail_start();
        let is_there = |term: &Term, p: usize| {
            let counts =
                |event: &&Event| event.measures(term) && !(event.is_stray && term.kind == TermKind::Observation);
            events.get(p).is_none_or(counts)
        };
        for (p, cell) in places.filter(|(_, cell)| cell + 1 >= tail) {
            for (number, term) in group.schema.terms.iter().enumerate().filter(|(_, term)| is_there(term, p)) {
                let loss = self.bound.losses[at][number];
                for row in term.first..term.first + term.rows {
                    let (misfit, sigma) = (found.row(row, p), self.weights.sigma[at][row]);
                    if !misfit.is_finite() {
                        return Err(Fault::residual(format!("{}.{}", group.schema.name, term.name), Some(p)));
                    }
                    let factor = loss.weight(misfit / sigma).sqrt() / sigma;
                    let mut bundle = group.bundle(&self.heads, group.cell(p), self.follow.len());
                    let by_learned = &self.weights.by_learned;
                    group.add_row(&self.heads, (&found, row, p), by_learned, factor, &mut bundle);
                    let out = split.at(cell < tail);
                    bundle.iter().for_each(|row| out.push(self.about_reference(row), 0));
                    if term.kind == TermKind::Observation && cell >= tail {
                        let place = (events[p].at, (at, row));
                        split.observed.extend(bundle.iter().map(|row| Observed::new(place, self.about_reference(row))));
                    }
                }
            }
        }
        Ok(())
    }

    /// A row about the present state as one about the reference.
    fn about_reference<'r>(&self, row: Row<'r>) -> Row<'r> {
        let unknowns = row.first..row.first + row.slopes.len();
        let apart = self.reference[unknowns.clone()].iter().zip(&self.theta[unknowns]);
        let moved: f64 = row.slopes.iter().zip(apart).map(|(slope, (reference, own))| slope * (reference - own)).sum();
        Row { value: row.value + moved, ..row }
    }

    /// Rows that keep sources smooth and small, and those that keep coefficients bounded that nothing else speaks of.
    fn add_priors(&self, split: &mut Split) {
        let tail = self.grid.tail_start();
        let (mut slopes, none) = (Vec::new(), vec![0.0; self.follow.len()]);
        for (head, sizes) in self.weights.sizes.iter().enumerate() {
            let Some((roughness, amplitude)) = *sizes else { continue };
            let prior = Prior::new(&self.heads.bases[head], KINDS[self.weights.kind]);
            for (first, factors) in prior.smooth(roughness).filter(|(first, _)| *first >= tail - 1) {
                let (number, value) =
                    self.heads.row_of((head, first), &factors[..prior.width()], &self.reference, &mut slopes);
                split.at(first < tail).push(Row { first: number, slopes: &slopes, shared: &none, value }, 0);
            }
            let small = prior.small(amplitude).enumerate().skip(tail - 1);
            for (first, factor) in small {
                let number = self.heads.numbers(head, first)[0];
                let value = factor * self.reference[number];
                split.at(first < tail).push(Row { first: number, slopes: &[factor], shared: &none, value }, 0);
            }
        }
        let unknowns = self.first(tail - 1)..self.theta.len();
        for number in unknowns {
            let value = RIDGE * self.reference[number];
            split.at(number < self.first(tail)).push(Row { first: number, slopes: &[RIDGE], shared: &none, value }, 0);
        }
    }
}
