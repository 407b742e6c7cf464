//! Learned scalars of which little more is known than that sources are small.

use super::Check;
use crate::facts::LARGER;
use crate::problem::Bound;

/// How far a scalar may move, as a share of itself or of its natural size, where sources may be larger. Where sources are zero or
/// constant over parts of a record scalars move by less than a hundredth, where they follow what is measured by a fifth and more.
pub(crate) const FARTHEST: f64 = 0.1;

/// A check for every learned scalar, of how far it moves.
pub(super) fn checks(bound: &Bound, leaning: &[f64]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    let check = |(learned, &moved): (&crate::engine::Learned, &f64)| {
        let name = schema.scalars[learned.slot].name;
        let said = format!(
            "learned `{name}` moves by {:.0} % where sources may be {LARGER} times as large: little more is known of it than that it \
             leaves them small; give it, or measure a source, or a part of the record in which sources are known",
            100.0 * moved
        );
        Check::new("leaning", ("", name), (moved, FARTHEST), said)
    };
    bound.learned.iter().zip(leaning).map(check).collect()
}
