//! Noise that neighbouring rows share.
//!
//! A sensor that drifts, or that answers more slowly than its rows come, is off in one row by much the same as in the row before. Were
//! each row's noise its own, a source would follow what they share: nothing else could make it. Here the noise of an observation may be a
//! process that dies away over a length along the coordinate: a row is compared with what the few rows before it let expect (Vecchia 1988), which
//! touches the unknowns of neighbouring places and no more. The length is one more size, and that of the largest
//! evidence. A source reaches the rows through an equation, which passes the less of it the faster it changes; such noise does not fall
//! off as fast. This tells the two apart.

use super::iterate::State;
use super::solver::Solver;
use super::triangle::Row;
use crate::shared_noise::{Expected, SharedNoise, spacing};
use crate::solve::fault::Fault;

/// Cells between two rows from which on they share no noise.
const FAR: usize = 8;

/// A row of an observation, and what those before it let expect of its noise.
pub(super) struct Link {
    pub(super) place: usize,
    /// Rows before it, the last first; none where the noise begins anew.
    pub(super) before: Vec<usize>,
    pub(super) expected: Expected,
}

impl Link {
    /// Those before it, with how much of their noise it has.
    fn shares(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.before.iter().copied().zip(self.expected.weights.iter().copied())
    }
}

impl Solver<'_> {
    /// The noise that rows of a term share; nothing where each has its own.
    pub(super) fn shared(&self, state: &State, (group, term): (usize, usize)) -> Option<SharedNoise> {
        let class = self.lengths[group][term]?;
        Some(SharedNoise { alike: state.sharing?, length: state.classes[class].size })
    }

    /// The same of all terms, by group.
    pub(super) fn all_shared(&self, state: &State) -> Vec<Vec<Option<SharedNoise>>> {
        let of = |(group, terms): (usize, &Vec<Option<usize>>)| {
            (0..terms.len()).map(|term| self.shared(state, (group, term))).collect()
        };
        self.lengths.iter().enumerate().map(of).collect()
    }

    /// True for the class of a length that the evidence finds.
    pub(super) fn is_length(&self, state: &State, class: usize) -> bool {
        state.sharing.is_some() && self.lengths.iter().flatten().any(|own| *own == Some(class))
    }

    /// The rows of a term along the coordinate, for noise that they share.
    pub(super) fn links(&self, (group, term): (usize, usize), shared: SharedNoise) -> Vec<Link> {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let lacking = self.bound.lacking(group, declared);
        let asked = own.asked(declared);
        let is_there = |p: &usize| *p < asked && lacking.as_ref().is_none_or(|measured| measured[*p]);
        let order: Vec<usize> = own.along().into_iter().filter(is_there).collect();
        let at = |p: usize| own.coordinates[p];
        let spacing = spacing(&order.iter().map(|&p| at(p)).collect::<Vec<f64>>()).unwrap_or(shared.length);
        let link = |(number, &place): (usize, &usize)| {
            let is_near = |before: &&usize| own.cell(place) - own.cell(**before) < FAR;
            let last = order[..number].iter().rev().take(shared.alike.memory());
            let before: Vec<usize> = last.take_while(is_near).copied().collect();
            let places: Vec<f64> = before.iter().map(|&p| at(p)).collect();
            Link { place, before, expected: shared.expected(at(place), &places, spacing) }
        };
        order.iter().enumerate().map(link).collect()
    }

    /// Unknowns that a row may see, from its first on.
    pub(super) fn band(&self, state: &State) -> usize {
        let mut band = self.heads.band;
        for (group, own) in self.groups.iter().enumerate() {
            for term in 0..own.schema.terms.len() {
                let Some(shared) = self.shared(state, (group, term)) else { continue };
                let width = |link: Link| {
                    let (before, _) = link.shares().last()?;
                    let [first, last] = [before, link.place].map(|p| own.span(&self.heads, p));
                    Some(last.0 + last.1 - first.0)
                };
                band = self.links((group, term), shared).into_iter().filter_map(width).fold(band, usize::max);
            }
        }
        band
    }

    /// Gives the rows of a term, each beside what those before let expect of it, over their deviation; returns half the sum of their
    /// squares.
    pub(super) fn chained(
        &self,
        state: &State,
        (group, term): (usize, usize),
        (shared, slopes): (SharedNoise, &[f64]),
        take: &mut dyn FnMut(Row<'_>),
    ) -> Result<f64, Fault> {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let found = own.evaluate(&self.heads, &state.theta, &self.scalars, Some(slopes.len()));
        let width = slopes.len() + state.lines.len();
        let links = self.links((group, term), shared);
        let mut cost = 0.0;
        for row in declared.first..declared.first + declared.rows {
            let factor = self.sigma(state, group, term, row).recip();
            let alone = |p: usize| {
                let mut bundle = own.bundle(&self.heads, own.cell(p), width);
                own.add_row(&self.heads, (&found, row, p), slopes, factor, &mut bundle);
                bundle
            };
            for link in &links {
                if !found.row(row, link.place).is_finite() {
                    let name = format!("{}.{}", own.schema.name, declared.name);
                    return Err(Fault::residual(name, Some(link.place)));
                }
                let scale = link.expected.rest.sqrt().recip();
                let before = link.shares().map(|(p, weight)| (alone(p), -weight * scale));
                let parts: Vec<_> = std::iter::once((alone(link.place), scale)).chain(before).collect();
                let rows = || parts.iter().flat_map(|(own, scale)| own.iter().map(move |row| (row, *scale)));
                let first = rows().map(|(row, _)| row.first).min().unwrap_or(0);
                let end = rows().map(|(row, _)| row.first + row.slopes.len()).max().unwrap_or(first);
                let (mut sum, mut beside, mut value) = (vec![0.0; end - first], vec![0.0; width], 0.0);
                for (row, scale) in rows() {
                    sum[row.first - first..].iter_mut().zip(row.slopes).for_each(|(sum, slope)| *sum += scale * slope);
                    beside.iter_mut().zip(row.shared).for_each(|(sum, slope)| *sum += scale * slope);
                    value += scale * row.value;
                }
                cost += 0.5 * value * value;
                take(Row { first, slopes: &sum, shared: &beside, value });
            }
        }
        Ok(cost)
    }

    /// Half the sum of squares of a term's rows, each beside what those before let expect of it.
    pub(super) fn chained_loss(&self, state: &State, (group, term): (usize, usize), shared: SharedNoise) -> f64 {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let found = own.evaluate(&self.heads, &state.theta, &self.scalars, None);
        let links = self.links((group, term), shared);
        let square = |row: usize| {
            let own = |link: &Link| {
                let expected: f64 = link.shares().map(|(before, weight)| weight * found.row(row, before)).sum();
                (found.row(row, link.place) - expected).powi(2) / link.expected.rest
            };
            links.iter().map(own).sum::<f64>() / self.sigma(state, group, term, row).powi(2)
        };
        0.5 * (declared.first..declared.first + declared.rows).map(square).sum::<f64>()
    }

    /// What the rows of a term lose in the sum of the logarithms of what they are divided by.
    pub(super) fn log_rest(&self, state: &State, at: (usize, usize)) -> f64 {
        let Some(shared) = self.shared(state, at) else { return 0.0 };
        let rows = self.groups[at.0].schema.terms[at.1].rows as f64;
        0.5 * rows * self.links(at, shared).iter().map(|link| link.expected.rest.ln()).sum::<f64>()
    }
}
