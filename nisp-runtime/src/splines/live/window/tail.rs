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

/// A row of a group that is asked for: at which of its places and on which cell, which of its rows, and what it is multiplied by.
pub(super) struct Asked<'r> {
    pub(super) p: usize,
    cell: usize,
    pub(super) number: usize,
    is_observation: bool,
    pub(super) factor: f64,
    pub(super) row: Row<'r>,
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
        let (left, tail) = (self.grid.left(), self.grid.tail_start());
        let mut equations = std::mem::take(&mut self.equations);
        for (at, group) in &mut equations {
            group.begin_at(&self.places, left);
            let cells = (0..self.places.len()).filter_map(|p| Some((p, self.grid.cell_of_equation(p)?)));
            let all: Vec<(usize, usize)> = cells.filter(|(_, cell)| cell + 1 >= tail).collect();
            self.add_group((*at, group), &all, &[], &mut split)?;
        }
        self.equations = equations;
        let schema = self.bound.problem.scene().schema;
        for at in 0..schema.groups.len() {
            let own = || self.events.iter().filter(|event| event.group == at);
            if own().next().is_none() {
                continue;
            }
            let events: Vec<&Event> = own().collect();
            let group = self.group_of(at, &events);
            let cells = events.iter().map(|event| self.grid.cell(event.at));
            let all: Vec<(usize, usize)> = cells.enumerate().filter(|(_, cell)| cell + 1 >= tail).collect();
            self.add_group((at, &group), &all, &events, &mut split)?;
        }
        self.add_priors(&mut split);
        Ok(split)
    }

    /// A group where something is asked for.
    pub(super) fn group_of(&self, at: usize, events: &[&Event]) -> Group {
        let (schema, left) = (&self.bound.problem.scene().schema.groups[at], self.grid.left());
        let places: Vec<f64> = events.iter().map(|event| event.at - left).collect();
        let filled = |x: f64| if x.is_nan() { 0.0 } else { x };
        let column = |column: usize| events.iter().map(|event| filled(event.columns[column])).collect();
        let columns: Vec<Vec<f64>> = (0..schema.columns.len()).map(column).collect();
        let mut group = Group::new(schema, self.kernels[at], &self.heads, &places, &columns);
        group.begin_at(&places, left);
        group
    }

    /// Adds the rows of a group at some of its places, each with its cell.
    fn add_group(
        &self,
        group: (usize, &Group),
        places: &[(usize, usize)],
        events: &[&Event],
        split: &mut Split,
    ) -> Result<(), Fault> {
        let tail = self.grid.tail_start();
        self.rows_of(group, places, events, &mut |asked| {
            split.at(asked.cell < tail).push(asked.row, 0);
            if asked.is_observation && asked.cell >= tail {
                let place = (events[asked.p].at, (group.0, asked.number));
                split.observed.push(Observed::new(place, asked.row));
            }
        })
    }

    /// Gives the rows of a group at some of its places, each with its cell: about the reference, and over what they are known to. What was
    /// measured there comes in events, in the order of the places.
    pub(super) fn rows_of(
        &self,
        (at, group): (usize, &Group),
        places: &[(usize, usize)],
        events: &[&Event],
        take: &mut dyn FnMut(Asked<'_>),
    ) -> Result<(), Fault> {
        let found = group.evaluate(&self.heads, &self.theta, &self.weights.scalars, Some(self.follow.len()));
        let is_there = |term: &Term, p: usize| {
            let counts =
                |event: &&Event| event.measures(term) && !(event.is_stray && term.kind == TermKind::Observation);
            events.get(p).is_none_or(counts)
        };
        for &(p, cell) in places {
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
                    let is_observation = term.kind == TermKind::Observation;
                    bundle.iter().for_each(|own| {
                        take(Asked { p, cell, number: row, is_observation, factor, row: self.about_reference(own) });
                    });
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

    /// Adds the priors' rows of the tail and the cell before it.
    fn add_priors(&self, split: &mut Split) {
        let tail = self.grid.tail_start();
        self.priors((tail - 1, usize::MAX), 1.0, &self.reference, &mut |cell, row| split.at(cell < tail).push(row, 0));
    }

    /// Gives rows that keep sources smooth and small, and those that keep coefficients bounded that nothing else speaks of, each with the
    /// cell from which on it is asked: the first such cell, and the one behind the last. Sources may be so many times as large as the
    /// stretch says. What the unknowns are about is so far from where the rows draw them.
    pub(super) fn priors(
        &self,
        (from, end): (usize, usize),
        larger: f64,
        about: &[f64],
        take: &mut dyn FnMut(usize, Row<'_>),
    ) {
        let (mut slopes, none) = (Vec::new(), vec![0.0; self.follow.len()]);
        for (head, sizes) in self.weights.sizes.iter().enumerate() {
            let Some((roughness, amplitude)) = *sizes else { continue };
            let prior = Prior::new(&self.heads.bases[head], KINDS[self.weights.kind]);
            let smooth = prior.smooth(larger * roughness).take_while(|(first, _)| *first < end);
            for (first, factors) in smooth.filter(|(first, _)| *first >= from) {
                let (number, value) = self.heads.row_of((head, first), &factors[..prior.width()], about, &mut slopes);
                take(first, Row { first: number, slopes: &slopes, shared: &none, value });
            }
            for (first, factor) in prior.small(larger * amplitude).enumerate().take(end).skip(from) {
                let number = self.heads.numbers(head, first)[0];
                take(first, Row { first: number, slopes: &[factor], shared: &none, value: factor * about[number] });
            }
        }
        let last = if end < self.grid.cells { self.first(end) } else { self.theta.len() };
        for (number, own) in about.iter().enumerate().take(last).skip(self.first(from)) {
            let value = RIDGE * own;
            take(number / self.heads_count(), Row { first: number, slopes: &[RIDGE], shared: &none, value });
        }
    }
}
