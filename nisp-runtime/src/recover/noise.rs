//! How noisy the data are, before anything is fitted to them.

use crate::problem::Bound;
use crate::schema::TermKind;

/// Noise of observed columns.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    /// For every observed column: group, column, standard deviation in the engine's units, and that over the data's
    /// own spread. The deviation is absent where it cannot be judged.
    pub(crate) columns: Vec<ColumnNoise>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColumnNoise {
    pub(crate) group: usize,
    pub(crate) column: usize,
    pub(crate) deviation: f64,
    pub(crate) relative: f64,
}

/// Noise below this share of the data's spread is taken for rounding of the data or for what differences miss.
const EXACT: f64 = 1e-3;

impl Noise {
    /// True if no observed column shows noise.
    pub(crate) fn is_exact(&self) -> bool {
        self.columns.iter().all(|c| c.relative < EXACT)
    }

    /// Standard deviation of a column of a group.
    pub(crate) fn of(&self, group: usize, column: usize) -> Option<f64> {
        self.columns.iter().find(|c| (c.group, c.column) == (group, column)).map(|c| c.deviation)
    }
}

/// Estimates the noise of every column of groups with observations.
pub(crate) fn estimate(bound: &Bound) -> Noise {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let mut columns = Vec::new();
    for (at, group) in schema.groups.iter().enumerate() {
        if !group.terms.iter().any(|t| t.kind == TermKind::Observation) {
            continue;
        }
        for (column, values) in bound.columns[at].iter().enumerate() {
            let ordered = in_order(&bound.coordinates[at], inputs, values);
            let spread = deviation(&ordered);
            if let Some(deviation) = by_differences(&ordered) {
                let relative = if spread > 0.0 { deviation / spread } else { 0.0 };
                columns.push(ColumnNoise { group: at, column, deviation, relative });
            }
        }
    }
    Noise { columns }
}

/// Values along the first coordinate.
fn in_order(coordinates: &[f64], inputs: usize, values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| coordinates[a * inputs].total_cmp(&coordinates[b * inputs]));
    order.into_iter().map(|at| values[at]).collect()
}

fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt()
}

/// From fourth differences, which a smooth signal hardly has: their median magnitude, so that a layer or an outlier
/// does not count. Noise of deviation s gives differences of deviation `sqrt(70) s`.
fn by_differences(values: &[f64]) -> Option<f64> {
    let mut differences: Vec<f64> =
        values.windows(5).map(|y| (y[0] - 4.0 * y[1] + 6.0 * y[2] - 4.0 * y[3] + y[4]).abs()).collect();
    if differences.len() < 8 {
        return None;
    }
    differences.sort_by(f64::total_cmp);
    // The median magnitude of a standard normal number.
    const MEDIAN: f64 = 0.674_489_75;
    Some(differences[differences.len() / 2] / (MEDIAN * 70.0_f64.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    #[test]
    fn differences_see_the_noise_and_not_the_signal() {
        let mut random = StdRng::seed_from_u64(1);
        let noisy: Vec<f64> = (0..2000).map(|i| (i as f64 * 0.01).sin() + 0.03 * normal(&mut random)).collect();
        let found = by_differences(&noisy).unwrap();
        assert!((found / 0.03 - 1.0).abs() < 0.1, "{found}");
        let smooth: Vec<f64> = (0..200).map(|i| (i as f64 * 0.05).sin()).collect();
        assert!(by_differences(&smooth).unwrap() < 1e-5);
    }

    #[test]
    fn few_values_say_nothing() {
        assert_eq!(by_differences(&[1.0, 2.0, 3.0, 2.0, 1.0]), None);
    }
}
