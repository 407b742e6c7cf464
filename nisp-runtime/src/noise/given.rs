//! How noisy the columns are that equations take for known.

use super::{by_differences, deviation, in_order};
use crate::problem::Bound;
use crate::schema::TermKind;

/// Noise of a column that matters, as a share of what it varies by.
const NOISY: f64 = 2e-3;

/// By column of a group, the noise of what equations over one coordinate know; zero where it does not matter.
pub(crate) fn of_given(bound: &Bound, group: usize) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let terms = schema.groups[group].terms;
    if schema.coordinates.len() != 1 || terms.iter().any(|term| term.kind != TermKind::Residual) {
        return vec![0.0; bound.columns[group].len()];
    }
    let of = |column: &Vec<f64>| {
        let values = in_order(&bound.coordinates[group], column);
        by_differences(&values).filter(|noise| *noise > NOISY * deviation(&values)).unwrap_or(0.0)
    };
    bound.columns[group].iter().map(of).collect()
}
