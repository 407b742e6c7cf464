//! What an answer leaves of one observation.

use super::root_mean_square;
use super::slow::chance;
use crate::noise::{Noise, ObservationNoise, by_differences, deviation, in_order};
use crate::problem::Bound;
use crate::schema;
use crate::shared_noise::{SharedNoise, beside_those_before};
use crate::units::Number;

/// Misfit over the noise that differences between neighbouring data show.
pub(super) const MISFIT: f64 = 1.6;
/// Misfits beyond so many of their size by the median are left out by robust losses, and are far from the others.
pub(super) const TAIL: f64 = 3.0;
/// Deviations that chance may make of the misfit of all values.
const CHANCE: f64 = 4.0;

/// Misfits of the values of an observation, and what they are compared with.
pub(super) struct Misfits<'a> {
    pub(super) bound: &'a Bound,
    pub(super) group: usize,
    /// The term's number in its group.
    pub(super) at: usize,
    pub(super) term: &'static schema::Term,
    /// By column, then by point, where it was measured, in the engine's units, as is all that follows: what the answer is more than the values.
    pub(super) plain: Vec<Vec<f64>>,
    /// The same over how noisy each value is, and beside what those before let expect where neighbours share noise.
    pub(super) rows: Vec<Vec<f64>>,
    /// Coordinates of the points, flat.
    pub(super) places: Vec<f64>,
    /// The data's own noise, where it can be judged.
    pub(super) noise: Option<ObservationNoise>,
    /// Whether the loss leaves out outliers.
    pub(super) is_robust: bool,
    /// The misfits' size: their root mean square, or by their median where outliers are left out.
    pub(super) size: f64,
}

impl<'a> Misfits<'a> {
    /// Of the term `at` of a group, whose rows over the group's points are `left`; nothing where nothing was measured. Where
    /// neighbouring rows share noise over a length, of misfits and values beside what those before let expect.
    pub(super) fn of(
        bound: &'a Bound,
        (group, at): (usize, usize),
        left: &[Vec<f64>],
        (noise, shared): (&Noise, Option<SharedNoise>),
    ) -> Option<Self> {
        let term = &bound.problem.scene().schema.groups[group].terms[at];
        let all = term.first..term.first + term.rows;
        let plain: Vec<Vec<f64>> = all.clone().map(|row| bound.measured(group, term, &left[row])).collect();
        let mut rows: Vec<Vec<f64>> =
            all.zip(&plain).map(|(row, own)| bound.evened((group, term), row, own.clone())).collect();
        let places = bound.measured(group, term, &bound.coordinates[group]);
        let mut noise = noise.of(group, at);
        if let Some(shared) = shared {
            let own = |values: &[f64]| beside_those_before(&places, values, shared);
            rows.iter_mut().for_each(|row| *row = own(row));
            let of = |&column: &usize| {
                let values = own(&bound.measured(group, term, &bound.columns[group][column]));
                by_differences(&in_order(&places, &values))
            };
            let found: Option<Vec<f64>> = term.columns.iter().map(of).collect();
            if let (Some(noise), Some(found)) = (&mut noise, found) {
                noise.deviation = noise.deviation.max(root_mean_square(found));
            }
        }
        let is_robust = bound.losses[group][at].is_robust();
        let size = if is_robust { middle(&rows) } else { root_mean_square(rows.iter().flatten().copied()) };
        (!places.is_empty()).then_some(Self { bound, group, at, term, plain, rows, places, noise, is_robust, size })
    }

    /// The names of the group and of the term.
    pub(super) fn name(&self) -> (&'static str, &'static str) {
        (self.bound.problem.scene().schema.groups[self.group].name, self.term.name)
    }

    /// True if the data are exact but for rounding.
    pub(super) fn is_exact(&self) -> bool {
        self.noise.is_some_and(ObservationNoise::is_exact)
    }

    /// True if points have one coordinate, so that they have an order.
    pub(super) fn is_record(&self) -> bool {
        self.axes() == 1
    }

    /// The number of coordinates of a point.
    pub(super) fn axes(&self) -> usize {
        self.bound.problem.scene().schema.coordinates.len()
    }

    /// A number as it is read: in the declared unit, with its name.
    pub(super) fn words(&self, value: f64) -> String {
        let value = self.bound.system.outward(&self.term.unit).of(Number::engine(value));
        format!("{value:.2e}{}", self.term.unit.behind())
    }

    /// How much larger than their deviation normal numbers may be by chance: few may be large.
    pub(super) fn by_chance(&self) -> f64 {
        chance(self.count(), CHANCE)
    }

    /// The number of values.
    pub(super) fn count(&self) -> usize {
        self.rows.iter().map(Vec::len).sum()
    }

    /// Standard deviation of what was measured: the root mean square over the columns.
    pub(super) fn spread(&self) -> f64 {
        let of = |&column: &usize| {
            let own = self.bound.measured(self.group, self.term, &self.bound.columns[self.group][column]);
            deviation(&own)
        };
        root_mean_square(self.term.columns.iter().map(of))
    }

    /// How much larger the noise may be than differences of few data say. Eighth differences of neighbours share most of their
    /// values, so that six data make about one of them that is its own; one and a half deviations of chi squared.
    pub(super) fn doubt(&self) -> f64 {
        let own = self.rows.first().map_or(0.0, |row| (row.len() as f64 - 8.0) / 6.0).max(1.0);
        let part = 2.0 / (9.0 * own);
        (1.0 - part - 1.5 * part.sqrt()).max(0.1).powf(-1.5)
    }

    /// The misfits' size by their median: outliers count for nothing.
    pub(super) fn middle(&self) -> f64 {
        middle(&self.rows)
    }

    /// The rows without what a robust loss leaves out.
    pub(super) fn kept(&self) -> Vec<Vec<f64>> {
        let is_out = |misfit: f64| self.is_robust && misfit.abs() > TAIL * self.size;
        let kept = |row: &Vec<f64>| row.iter().map(|misfit| if is_out(*misfit) { 0.0 } else { *misfit }).collect();
        self.rows.iter().map(kept).collect()
    }
}

/// The size of values by their median magnitude, in standard deviations of normal numbers.
fn middle(rows: &[Vec<f64>]) -> f64 {
    let mut magnitudes: Vec<f64> = rows.iter().flatten().map(|x| x.abs()).collect();
    magnitudes.sort_by(f64::total_cmp);
    magnitudes.get(magnitudes.len() / 2).copied().unwrap_or(0.0) * 1.4826
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_move_the_median() {
        let mut row: Vec<f64> = (0..101).map(|i| (f64::from(i) - 50.0) / 50.0).collect();
        let clean = middle(&[row.clone()]);
        row[0] = 1e6;
        assert!((middle(&[row]) - clean).abs() < 0.05);
    }
}
