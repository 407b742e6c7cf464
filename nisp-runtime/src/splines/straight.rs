//! The straight line that a source keeps near to.

use std::f64::consts::PI;

use super::basis::Basis;

/// What is believed of the lines of all sources.
#[derive(Clone, Copy, Debug)]
pub(super) struct Belief {
    /// Numbers of a line: its mean, and how far it rises.
    pub(super) numbers: usize,
    /// How much larger each of them is than the source varies beside its line.
    pub(super) far: f64,
}

impl Belief {
    /// Sources are small about zero.
    pub(super) const NONE: Self = Self { numbers: 0, far: 1.0 };
    /// Sources have a level. Beside learned scalars they have no more: how small a source is tells what a scalar is, and a rise would
    /// take over what the scalar does.
    pub(super) const LEVEL: Self = Self { numbers: 1, far: 1.0 };
    /// Sources have a level and drift. With half as large a line bars of sources whose level is open are too short; with one twice as
    /// large fewer of them are told from none.
    pub(super) const DRIFT: Self = Self { numbers: 2, far: 2.0 };
}

/// The most numbers of a line.
const MOST: usize = 2;

/// Standard deviation, at a place, of what is left beside the line: of a process of such an order, roughness and amplitude.
pub(super) fn beside(order: usize, roughness: f64, amplitude: f64) -> f64 {
    let order = order as f64;
    // The integral of the spectrum `1 / (amplitude^-2 + frequency^(2 order) roughness^-2)` is the variance at a place.
    let frequency = (roughness / amplitude).powf(order.recip());
    amplitude * (frequency / (2.0 * order * (PI / (2.0 * order)).sin())).sqrt()
}

/// A mean of one and a line that rises, in the functions of a head. Both have a root mean square of one over the record.
#[derive(Clone, Debug)]
pub(super) struct Straight {
    /// By function, a line through zero in the middle of the record.
    rising: Vec<f64>,
}

impl Straight {
    /// The line of functions over cells.
    pub(super) fn new(basis: &Basis) -> Self {
        let places = basis.breakpoints();
        let (first, length) = (places[0], places[places.len() - 1] - places[0]);
        let share = |function: usize| (basis.centre(function) - first) / length;
        Self { rising: (0..basis.len()).map(|function| 12_f64.sqrt() * (share(function) - 0.5)).collect() }
    }

    /// What a row, of so many coefficients from a first function on, says of either.
    pub(super) fn along(&self, first: usize, factors: &[f64]) -> [f64; MOST] {
        let rising = factors.iter().zip(&self.rising[first..]).map(|(factor, rising)| factor * rising);
        [factors.iter().sum(), rising.sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a spline at the middles of many parts are rows of its coefficients.
    #[test]
    fn both_have_a_square_of_one_and_nothing_in_common() {
        let basis = Basis::new(5, &[2.0, 2.1, 2.5, 3.5, 3.6, 4.0]);
        let straight = Straight::new(&basis);
        let parts = 2000;
        let mut sums = [0.0; 3];
        for part in 0..parts {
            let share = (f64::from(part) + 0.5) / f64::from(parts);
            let at = 2.0 + 2.0 * share;
            let cell = basis.cell(at);
            let [mean, rising] = straight.along(cell, &basis.line(cell, at, 0)[..6]);
            assert!((rising - 12_f64.sqrt() * (share - 0.5)).abs() < 1e-12, "{share}: {rising}");
            sums = [sums[0] + mean * mean, sums[1] + rising * rising, sums[2] + mean * rising];
        }
        let [one, same, none] = sums.map(|sum| sum / f64::from(parts));
        assert!((one - 1.0).abs() < 1e-12 && (same - 1.0).abs() < 1e-6 && none.abs() < 1e-12, "{one} {same} {none}");
    }

    /// The spectrum summed up over all frequencies (trapezoids in their logarithms), to both sides of zero.
    #[test]
    fn a_process_varies_by_the_integral_of_its_spectrum() {
        for (order, roughness, amplitude) in [(1, 0.7_f64, 0.4_f64), (2, 0.3, 2.0), (3, 5.0, 0.9)] {
            let density = |logarithm: f64| {
                let frequency = logarithm.exp();
                let inverse = amplitude.powi(-2) + frequency.powi(2 * order as i32) * roughness.powi(-2);
                frequency / (PI * inverse)
            };
            let sum: f64 = (-30_000..30_000).map(|i| 1e-3 * density(1e-3 * f64::from(i))).sum();
            let found = beside(order, roughness, amplitude);
            assert!((found.powi(2) / sum - 1.0).abs() < 1e-9, "order {order}: {found} {sum}");
        }
    }
}
