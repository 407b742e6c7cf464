//! Noise that neighbouring rows share.
//!
//! A sensor that drifts, or that answers more slowly than its rows come, is off in one row by much the same as in the row before. Were
//! each row's noise its own, a source would follow what they share: nothing else could make it. Here the noise of an observation may be a
//! process that dies away over a length along the coordinate (Ornstein and Uhlenbeck 1930): a row is compared with what the row before it
//! lets expect, which touches the unknowns of two neighbouring places and no more. The length is one more size, and that of the largest
//! evidence. A source reaches the rows through an equation, which passes the less of it the faster it changes; such noise does not fall
//! off as fast. This tells the two apart.

use super::iterate::State;
use super::solver::Solver;
use super::triangle::Row;
use crate::noise::{shared, spacing};
use crate::solve::fault::Fault;

/// Correlation below which a row has noise of its own, and cells between two rows from which on it does.
const NONE: f64 = 1e-4;
const FAR: usize = 8;

/// A row of an observation, and how much of the noise of the row before it it has.
pub(super) struct Link {
    place: usize,
    /// Nothing where the noise begins anew.
    pub(super) before: Option<(usize, f64)>,
}

impl Link {
    /// What remains of the noise's variance when the row before is known.
    pub(super) fn rest(&self) -> f64 {
        self.before.map_or(1.0, |(_, shared)| 1.0 - shared * shared)
    }
}

impl Solver<'_> {
    /// The length over which the noise of a term dies away; nothing where each row has its own.
    pub(super) fn length_of(&self, state: &State, (group, term): (usize, usize)) -> Option<f64> {
        let class = self.lengths[group][term].filter(|_| state.correlated)?;
        Some(state.classes[class].size)
    }

    /// The same of all terms, by group.
    pub(super) fn all_lengths(&self, state: &State) -> Vec<Vec<Option<f64>>> {
        let of = |(group, terms): (usize, &Vec<Option<usize>>)| {
            (0..terms.len()).map(|term| self.length_of(state, (group, term))).collect()
        };
        self.lengths.iter().enumerate().map(of).collect()
    }

    /// True for the class of a length that the evidence finds.
    pub(super) fn is_length(&self, state: &State, class: usize) -> bool {
        state.correlated && self.lengths.iter().flatten().any(|own| *own == Some(class))
    }

    /// The rows of a term along the coordinate, for noise that dies away over a length.
    pub(super) fn links(&self, (group, term): (usize, usize), length: f64) -> Vec<Link> {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let lacking = self.bound.lacking(group, declared);
        let asked = own.asked(declared);
        let is_there = |p: &usize| *p < asked && lacking.as_ref().is_none_or(|measured| measured[*p]);
        let order: Vec<usize> = own.along().into_iter().filter(is_there).collect();
        let at = |p: usize| own.coordinates[p];
        let spacing = spacing(&order.iter().map(|&p| at(p)).collect::<Vec<f64>>()).unwrap_or(length);
        let before = |place: usize, before: usize| {
            let shared = shared(at(place) - at(before), length, spacing);
            let is_near = own.cell(place) - own.cell(before) < FAR;
            (shared > NONE && is_near).then_some((before, shared))
        };
        let links = order.iter().enumerate();
        links
            .map(|(number, &place)| Link {
                place,
                before: number.checked_sub(1).and_then(|number| before(place, order[number])),
            })
            .collect()
    }

    /// Unknowns that a row may see, from its first on.
    pub(super) fn band(&self, state: &State) -> usize {
        let mut band = self.heads.band;
        for (group, own) in self.groups.iter().enumerate() {
            for term in 0..own.schema.terms.len() {
                let Some(length) = self.length_of(state, (group, term)) else { continue };
                let width = |link: Link| {
                    let (before, _) = link.before?;
                    let [first, last] = [before, link.place].map(|p| own.span(&self.heads, p));
                    Some(last.0 + last.1 - first.0)
                };
                band = self.links((group, term), length).into_iter().filter_map(width).fold(band, usize::max);
            }
        }
        band
    }

    /// Gives the rows of a term, each beside what the one before lets expect of it, over their deviation; returns half the sum of their
    /// squares.
    pub(super) fn chained(
        &self,
        state: &State,
        (group, term): (usize, usize),
        (length, slopes): (f64, &[f64]),
        take: &mut dyn FnMut(Row<'_>),
    ) -> Result<f64, Fault> {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let found = own.evaluate(&self.heads, &state.theta, &self.scalars, Some(slopes.len()));
        let width = slopes.len() + state.lines.len();
        let links = self.links((group, term), length);
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
                let scale = link.rest().sqrt().recip();
                let parts = [Some((link.place, scale)), link.before.map(|(before, shared)| (before, -shared * scale))];
                let parts = parts.map(|part| part.map(|(p, scale)| (alone(p), scale)));
                let rows = || parts.iter().flatten().flat_map(|(own, scale)| own.iter().map(move |row| (row, *scale)));
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

    /// Half the sum of squares of a term's rows, each beside what the one before lets expect of it.
    pub(super) fn chained_loss(&self, state: &State, (group, term): (usize, usize), length: f64) -> f64 {
        let own = &self.groups[group];
        let declared = &own.schema.terms[term];
        let found = own.evaluate(&self.heads, &state.theta, &self.scalars, None);
        let links = self.links((group, term), length);
        let square = |row: usize| {
            let own = |link: &Link| {
                let expected = link.before.map_or(0.0, |(before, shared)| shared * found.row(row, before));
                (found.row(row, link.place) - expected).powi(2) / link.rest()
            };
            links.iter().map(own).sum::<f64>() / self.sigma(state, group, term, row).powi(2)
        };
        0.5 * (declared.first..declared.first + declared.rows).map(square).sum::<f64>()
    }

    /// What the rows of a term lose in the sum of the logarithms of what they are divided by.
    pub(super) fn log_rest(&self, state: &State, at: (usize, usize)) -> f64 {
        let Some(length) = self.length_of(state, at) else { return 0.0 };
        let rows = self.groups[at.0].schema.terms[at.1].rows as f64;
        0.5 * rows * self.links(at, length).iter().map(|link| link.rest().ln()).sum::<f64>()
    }
}
