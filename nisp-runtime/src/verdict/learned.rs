//! Learned scalars that ended where their range ends, or that are more sure than their equations hold.

use super::Check;
use crate::engine::{Learned, LearnedMap};
use crate::problem::Bound;

/// Share of a range within which a value counts as at its end.
const AT_END: f64 = 5e-3;

/// What is left of the equations, as a change of a scalar in its deviations. Right answers leave up to four; a friction that was a twentieth of
/// its equation's largest part was 34 deviations off where the equation was off by 45.
const LEFT: f64 = 10.0;

/// Checks of learned scalars that are known better than their equations hold.
pub(super) fn held(bound: &Bound, left: &[Option<f64>]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    let check = |(learned, left): (&Learned, &Option<f64>)| {
        let name = schema.scalars[learned.slot].name;
        let left = (*left)?;
        let said = format!(
            "what is left of the equations is as much as another value of learned `{name}` would make, {left:.0} of its deviations off: the \
             answer does not hold them well enough to know it; give a larger budget, or take another carrier"
        );
        Some(Check::new("known", ("", name), (left, LEFT), said))
    };
    bound.learned.iter().zip(left).filter_map(check).collect()
}

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
