//! Learned scalars that ended where their range ends.

use super::Check;
use crate::engine::LearnedMap;
use crate::problem::Bound;

/// Share of a range within which a value counts as at its end.
const AT_END: f64 = 5e-3;

/// Checks of all learned scalars that have a range.
pub(super) fn checks(bound: &Bound, scalars: &[f64]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    let learned = bound.learned.iter().filter_map(|learned| {
        let LearnedMap::Between(lower, upper, _) = learned.map else { return None };
        let (name, value) = (schema.scalars[learned.slot].name, scalars[learned.slot]);
        // Ranges of positive quantities span decades.
        let share = match lower > 0.0 {
            true => (value / lower).ln() / (upper / lower).ln(),
            false => (value - lower) / (upper - lower),
        };
        let said = format!(
            "learned `{name}` is at the {} end of its range: widen the range, or doubt the equations and the data",
            if share < 0.5 { "lower" } else { "upper" }
        );
        Some(Check::new("range", ("", name), ((share - 0.5).abs(), 0.5 - AT_END), said))
    });
    learned.collect()
}
