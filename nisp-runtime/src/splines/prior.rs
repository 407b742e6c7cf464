//! What is believed of a source before any measurement: how large it is, and how smooth along which time.
//!
//! A source is a straight line and a Gaussian process about it: of what is left beside the line,
//! `|g|^2 / amplitude^2 + |d^order g / ds^order|^2 / roughness^2` is small, in the mean over a time `s`. Either `s` is the record's own
//! time and `g` what is left; or `s` passes faster at the record's start, and `g = f dt/ds` is what the rest `f` adds up to in it. What
//! is set off with the record answers at first in a layer that is thin beside the rest, then slower and slower, and dies away as it
//! does so.
//!
//! The line is an unknown of its own. Were sources small about zero, they would be drawn to it wherever the data leave their level
//! open, as beside a field that nothing measures and that may begin anywhere. Were they small about a mean, they would be drawn to where
//! they drift least; but most sources drift over a record by more than their faster waves let expect.

use std::f64::consts::PI;

use super::basis::{Basis, Line};
use super::straight::{self, Straight};
use super::triangle::{Row, Triangle};
use crate::schema;

/// Range of a stretched time over the width of the layer at its start.
const LAYER: f64 = 100.0;

/// What is alike all along a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// The source, along the record's own time.
    Steady,
    /// What the source adds up to in a stretched time: it falls off as that time slows down.
    Fading,
}

impl Course {
    /// The share of the record's own time that has passed at a share of this course's.
    pub(super) fn passed(self, share: f64) -> f64 {
        match self {
            Self::Steady => share,
            Self::Fading => (share * LAYER.ln_1p()).exp_m1() / LAYER,
        }
    }
}

/// A kind of smoothness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Smoothness {
    /// Order of the derivative that is kept small.
    pub(super) order: usize,
    pub(super) course: Course,
}

/// Kinds of smoothness that may be the right one, the first tried first.
pub(super) const KINDS: [Smoothness; 7] = {
    use Course::{Fading, Steady};
    [of(2, Steady), of(2, Fading), of(1, Steady), of(3, Steady), of(1, Fading), of(3, Fading), of(5, Steady)]
};

/// The highest order that noisy data are asked about. Of ends they say the less the higher the order is.
pub(super) const HIGHEST_NOISY: usize = 3;

const fn of(order: usize, course: Course) -> Smoothness {
    Smoothness { order, course }
}

/// True if something may be set off with the records of a scene: they are over time.
pub(super) fn may_stretch(schema: &schema::Scene) -> bool {
    schema.coordinates[0].unit.is_time() && schema.heads.iter().any(|head| head.source)
}

/// How much faster than on average a stretched time passes, at a share of the record.
pub(super) fn pace(share: f64) -> f64 {
    LAYER / ((1.0 + LAYER * share) * LAYER.ln_1p())
}

/// The rows of a head's prior, by the head's coefficients.
#[derive(Clone, Debug)]
pub(super) struct Prior {
    order: usize,
    /// The head's functions along the time that the prior goes by.
    along: Basis,
    /// What the head's coefficients are multiplied by for what is alike all along.
    evened: Vec<f64>,
    /// By function, how rough the head is there beside its mean.
    uneven: Vec<f64>,
    /// The line that the head keeps near to.
    pub(super) straight: Straight,
}

/// What the rows of a prior are worth.
pub(super) struct Worth {
    /// Logarithm of their determinant.
    pub(super) log_determinant: f64,
    /// Unknowns that the amplitude alone settles, of all that the prior does.
    pub(super) amplitude: f64,
}

impl Prior {
    /// Of functions over cells. The coefficients of a function of time are, to the second order in the width of a cell, those of
    /// the same function along another time.
    pub(super) fn new(basis: &Basis, kind: Smoothness) -> Self {
        let places = basis.breakpoints();
        let (first, length) = (places[0], places[places.len() - 1] - places[0]);
        let ones = vec![1.0; basis.len()];
        let (order, straight) = (kind.order, Straight::new(basis));
        match kind.course {
            Course::Steady => Self { order, along: basis.clone(), evened: ones.clone(), uneven: ones, straight },
            Course::Fading => {
                let stretch = |at: &f64| first + length * (LAYER * (at - first) / length).ln_1p() / LAYER.ln_1p();
                let along = Basis::new(basis.degree, &places.iter().map(stretch).collect::<Vec<f64>>());
                let even = |function: usize| pace((basis.centre(function) - first) / length).recip();
                Self { order, along, evened: (0..basis.len()).map(even).collect(), uneven: ones, straight }
            }
        }
    }

    /// The same with a head that is as rough as this beside its mean, function by function.
    pub(super) fn with(self, uneven: &[f64]) -> Self {
        Self { uneven: uneven.to_vec(), ..self }
    }

    /// By function, how rough the head is there beside its mean.
    pub(super) fn uneven(&self) -> &[f64] {
        &self.uneven
    }

    /// Rows that keep the head smooth: for each the first of its coefficients, and what so many of them are multiplied by.
    pub(super) fn smooth(&self, roughness: f64) -> impl Iterator<Item = (usize, Line)> + '_ {
        self.along.differences(self.order).map(move |(first, mut factors, width)| {
            let evened = self.evened[first..].iter();
            let roughness = roughness * self.uneven[first + self.order / 2];
            factors.iter_mut().zip(evened).for_each(|(factor, even)| *factor *= even * width.sqrt() / roughness);
            (first, factors)
        })
    }

    /// Coefficients that a row of [`Prior::smooth`] multiplies.
    pub(super) fn width(&self) -> usize {
        self.order + 1
    }

    /// Rows that keep the head small: what each of its coefficients is multiplied by.
    pub(super) fn small(&self, amplitude: f64) -> impl Iterator<Item = f64> + '_ {
        self.along.differences(0).map(move |(at, _, width)| self.evened[at] * width.sqrt() / amplitude)
    }

    /// Standard deviation, at a place, of what is left of the head beside its line.
    pub(super) fn beside(&self, roughness: f64, amplitude: f64) -> f64 {
        straight::beside(self.order, roughness, amplitude)
    }

    /// All rows.
    pub(super) fn triangle(&self, roughness: f64, amplitude: f64) -> Triangle {
        let mut triangle = Triangle::new(self.along.len(), self.width(), 0);
        let mut smooth = self.smooth(roughness);
        for (first, factor) in self.small(amplitude).enumerate() {
            triangle.add(Row { first, slopes: &[factor], shared: &[], value: 0.0 });
            if let Some((first, factors)) = smooth.next() {
                triangle.add(Row { first, slopes: &factors[..self.width()], shared: &[], value: 0.0 });
            }
        }
        triangle
    }

    /// What all rows are worth.
    pub(super) fn worth(&self, roughness: f64, amplitude: f64) -> Worth {
        let triangle = self.triangle(roughness, amplitude);
        let covariance = triangle.covariance();
        let settled = self.small(amplitude).enumerate().map(|(first, factor)| covariance.of(first, &[factor], &[]));
        Worth { log_determinant: triangle.log_determinant(), amplitude: settled.sum() }
    }

    /// The variance, about a function, of waves shorter than four cells, for a head of this roughness and amplitude. Splines on the
    /// cells hold few of them, and cells are chosen so that the data say little of them.
    pub(super) fn unresolved(&self, function: usize, roughness: f64, amplitude: f64) -> f64 {
        let roughness = roughness * self.uneven[function];
        let power = 2 * self.order as i32 - 1;
        let longest = 2.0 * self.along.width(function) / PI;
        // The spectrum `1 / (amplitude^-2 + frequency^(2 order) roughness^-2)` above a frequency; no more than below it.
        let above = roughness.powi(2) * longest.powi(power) / (PI * f64::from(power));
        let below = amplitude.powi(2) / (PI * longest);
        above.min(below) / self.evened[function].powi(2)
    }

    /// A roughness at which a head of this amplitude is one wave over so many cells of the mean width.
    pub(super) fn roughness(&self, amplitude: f64, cells: f64) -> f64 {
        amplitude * (std::f64::consts::TAU / (cells * self.mean_width())).powi(self.order as i32)
    }

    /// Mean cells to one wave of a head of such a roughness and amplitude.
    pub(super) fn cells(&self, roughness: f64, amplitude: f64) -> f64 {
        let wave = std::f64::consts::TAU / (roughness / amplitude).powf(1.0 / self.order as f64);
        wave / self.mean_width()
    }

    fn mean_width(&self) -> f64 {
        let places = self.along.breakpoints();
        (places[places.len() - 1] - places[0]) / self.along.cells() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The determinant and the trace by a dense factorisation of the sum of squares.
    #[test]
    fn worth_is_that_of_the_dense_matrix() {
        let places: Vec<f64> = (0..9).map(|at| f64::from(at) / 8.0).collect();
        for kind in KINDS {
            let prior = Prior::new(&Basis::new(5, &places), kind);
            let count = prior.along.len();
            // Waves of six cells: squares of derivatives of longer ones are lost in rounding.
            let amplitude = 0.4;
            let roughness = prior.roughness(amplitude, 6.0);
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for (first, factors) in prior.smooth(roughness) {
                let mut row = vec![0.0; count];
                row[first..][..prior.width()].copy_from_slice(&factors[..prior.width()]);
                rows.push(row);
            }
            let smooth = rows.len();
            for (at, factor) in prior.small(amplitude).enumerate() {
                let mut row = vec![0.0; count];
                row[at] = factor;
                rows.push(row);
            }
            let square = |from: usize| {
                let mut sum = vec![0.0; count * count];
                for row in &rows[from..] {
                    (0..count * count).for_each(|at| sum[at] += row[at / count] * row[at % count]);
                }
                sum
            };
            let (log, inverse) = inverted(square(0), count);
            let small = square(smooth);
            let trace: f64 = (0..count * count).map(|at| inverse[at] * small[at]).sum();
            let worth = prior.worth(roughness, amplitude);
            // The sum of squares has half of the digits of its root.
            assert!((worth.log_determinant - 0.5 * log).abs() < 1e-6 * log.abs(), "{kind:?}");
            assert!((worth.amplitude - trace).abs() < 1e-5 * trace, "{kind:?}: {} {trace}", worth.amplitude);
        }
    }

    /// The spectrum summed up from a wave of four cells on, octave by octave (trapezoids in the logarithm of the frequency).
    #[test]
    fn what_is_unresolved_is_the_rest_of_the_spectrum() {
        let places: Vec<f64> = (0..=40).map(|at| 0.25 * f64::from(at)).collect();
        for (order, roughness) in [(1, 0.7), (2, 0.3), (3, 2.0)] {
            let prior = Prior::new(&Basis::new(5, &places), Smoothness { order, course: Course::Steady });
            let lowest = PI / (2.0 * 0.25);
            let density = |octave: f64| {
                let frequency = lowest * octave.exp2();
                frequency * std::f64::consts::LN_2 * roughness * roughness * frequency.powi(-2 * order as i32) / PI
            };
            let sum: f64 = (0..30_000).map(|i| 1e-3 * density(1e-3 * (f64::from(i) + 0.5))).sum();
            let found = prior.unresolved(20, roughness, 1e6);
            assert!((found / sum - 1.0).abs() < 1e-5, "order {order}: {found} {sum}");
            // A source without long waves has no more in short ones.
            assert!(prior.unresolved(20, 1e9, 0.1) <= 0.01 / (PI / lowest) + 1e-12);
        }
    }

    /// Logarithm of the determinant and inverse of a positive matrix, by Gauss and Jordan.
    fn inverted(mut a: Vec<f64>, n: usize) -> (f64, Vec<f64>) {
        let mut inverse: Vec<f64> = (0..n * n).map(|at| f64::from(at / n == at % n)).collect();
        let mut log = 0.0;
        for at in 0..n {
            let pivot = a[at * n + at];
            log += pivot.ln();
            (0..n).for_each(|j| {
                (a[at * n + j], inverse[at * n + j]) = (a[at * n + j] / pivot, inverse[at * n + j] / pivot)
            });
            for i in (0..n).filter(|&i| i != at) {
                let factor = a[i * n + at];
                for j in 0..n {
                    a[i * n + j] -= factor * a[at * n + j];
                    inverse[i * n + j] -= factor * inverse[at * n + j];
                }
            }
        }
        (log, inverse)
    }
}
