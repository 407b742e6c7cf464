//! Noise that rows of a record share with those before them: it dies away over a length along the coordinate.

use nalgebra::{DMatrix, DVector};

/// Rows nearer than this share of their mean distance count as so far apart.
const NEAREST: f64 = 0.1;
/// Correlation below which a row has noise of its own.
const NONE: f64 = 1e-4;

/// How noise changes from place to place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alike {
    /// As a walk that is drawn back does (Ornstein and Uhlenbeck 1930): a sensor that drifts, or that answers slowly.
    Rough,
    /// Smoothly, as what a filter of second order leaves of noise does (Matern 3/2).
    Smooth,
}

/// Noise that rows share over a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SharedNoise {
    pub(crate) alike: Alike,
    pub(crate) length: f64,
}

/// What the rows before a row let expect of its noise.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Expected {
    /// How much of the noise of each, the last first.
    pub(crate) weights: Vec<f64>,
    /// What remains of its variance when those are known.
    pub(crate) rest: f64,
}

impl Alike {
    /// Rows before a row beyond which others tell next to nothing of it: of a walk the last one tells all.
    pub(crate) fn memory(self) -> usize {
        match self {
            Self::Rough => 1,
            Self::Smooth => 4,
        }
    }

    /// Power of the length that the deviation goes with where neighbouring rows differ by as much.
    pub(crate) fn growth(self) -> f64 {
        match self {
            Self::Rough => 0.5,
            Self::Smooth => 1.5,
        }
    }
}

impl SharedNoise {
    /// Correlation of the noise at two places so far apart.
    pub(crate) fn correlation(self, distance: f64) -> f64 {
        match self.alike {
            Alike::Rough => (-distance / self.length).exp(),
            Alike::Smooth => {
                let far = 3.0_f64.sqrt() * distance / self.length;
                (1.0 + far) * (-far).exp()
            }
        }
    }

    /// What is expected at a place from those before it, the last first, where rows have a mean distance.
    pub(crate) fn expected(self, place: f64, before: &[f64], spacing: f64) -> Expected {
        let correlation = |a: f64, b: f64| self.correlation((a - b).abs().max(NEAREST * spacing));
        let is_alike = before.first().is_some_and(|last| correlation(place, *last) > NONE);
        let mut count = if is_alike { before.len().min(self.alike.memory()) } else { 0 };
        while count > 0 {
            let own = |i: usize, j: usize| if i == j { 1.0 } else { correlation(before[i], before[j]) };
            let to = DVector::from_fn(count, |i, _| correlation(place, before[i]));
            if let Some(found) = DMatrix::from_fn(count, count, own).cholesky() {
                let weights = found.solve(&to);
                let rest = 1.0 - weights.dot(&to);
                if rest > f64::EPSILON {
                    return Expected { weights: weights.iter().copied().collect(), rest };
                }
            }
            count -= 1;
        }
        Expected { weights: Vec::new(), rest: 1.0 }
    }
}

/// The mean distance of places; nothing where they have none.
pub(crate) fn spacing(places: &[f64]) -> Option<f64> {
    let ends = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
    Some((ends[1] - ends[0]) / (places.len() as f64 - 1.0)).filter(|mean| mean.is_finite() && *mean > 0.0)
}

/// Values beside what those before them let expect, where they share noise: noise of the same size that is each value's own. In the order in
/// which the values are given.
pub(crate) fn beside_those_before(places: &[f64], values: &[f64], shared: SharedNoise) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| places[a].total_cmp(&places[b]));
    let spacing = spacing(places).unwrap_or(shared.length);
    let mut found = values.to_vec();
    for (number, &at) in order.iter().enumerate() {
        let last = order[..number].iter().rev().take(shared.alike.memory());
        let before: Vec<f64> = last.clone().map(|&p| places[p]).collect();
        let Expected { weights, rest } = shared.expected(places[at], &before, spacing);
        let expected: f64 = last.zip(&weights).map(|(&p, weight)| weight * values[p]).sum();
        found[at] = (values[at] - expected) / rest.sqrt();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// A process with correlation `exp(-distance / length)` at uneven places, out of order: its covariance is that of the definition, and
    /// what is left beside those before is white with the same variance.
    #[test]
    fn what_is_left_is_each_values_own() {
        let mut random = StdRng::seed_from_u64(1);
        let (count, length) = (20_000, 3.0);
        let (mut at, mut own) = (0.0, normal(&mut random));
        let mut record = vec![(at, own)];
        while record.len() < count {
            let distance = 0.2 + 1.6 * random.random::<f64>();
            let shared = f64::exp(-distance / length);
            own = shared * own + (1.0 - shared * shared).sqrt() * normal(&mut random);
            at += distance;
            record.push((at, own));
        }
        record.reverse();
        let (places, values): (Vec<f64>, Vec<f64>) = record.into_iter().unzip();
        let found = beside_those_before(&places, &values, SharedNoise { alike: Alike::Rough, length });
        let mean = |of: &dyn Fn(usize) -> f64| (1..count).map(of).sum::<f64>() / (count - 1) as f64;
        assert!(mean(&|i| values[i] * values[i - 1]) > 0.6);
        assert!((mean(&|i| found[i] * found[i]) - 1.0).abs() < 0.04);
        assert!(mean(&|i| found[i] * found[i - 1]).abs() < 0.03);
    }

    #[test]
    fn equal_places_divide_by_nothing() {
        for alike in [Alike::Rough, Alike::Smooth] {
            let shared = SharedNoise { alike, length: 5.0 };
            let found = beside_those_before(&[0.0, 0.0, 1.0, 1.0, 1.0], &[1.0, 2.0, 3.0, 4.0, 5.0], shared);
            assert!(found.iter().all(|x| x.is_finite()));
        }
    }

    /// White noise through a critically damped filter of second order, at its rows: correlation `(1 + d) exp(-d)`.
    #[test]
    fn what_a_filter_leaves_is_made_white_again() {
        let mut random = StdRng::seed_from_u64(2);
        let (count, fine, rate) = (20_000, 20, 0.3);
        let (mut first, mut second, step) = (0.0_f64, 0.0_f64, 1.0 / 20.0);
        let mut values = Vec::new();
        for _ in 0..count {
            for _ in 0..fine {
                first += step * rate * -first + f64::sqrt(step) * normal(&mut random);
                second += step * rate * (first - second);
            }
            values.push(second);
        }
        let places: Vec<f64> = (0..count).map(|i| i as f64).collect();
        let shared = SharedNoise { alike: Alike::Smooth, length: 3.0_f64.sqrt() / rate };
        let found = beside_those_before(&places, &values, shared);
        let mean = |of: &dyn Fn(usize) -> f64| (4..count).map(of).sum::<f64>() / (count - 4) as f64;
        let (before, after) = (mean(&|i| values[i] * values[i]), mean(&|i| found[i] * found[i]));
        assert!((after / before - 1.0).abs() < 0.2, "{before} {after}");
        for lag in 1..4 {
            assert!(mean(&|i| found[i] * found[i - lag]).abs() < 0.05 * after, "{lag}");
        }
    }
}
