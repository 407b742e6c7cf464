//! Learned scalars that steps still changed where the budget ended them.

use super::Check;
use crate::problem::Bound;

/// How far the next whole step may move a learned scalar's parameter: a hundredth of a value that is positive.
const NEAR: f64 = 1e-2;

/// The check of an answer whose next whole step moves a parameter so far; none at the end of the steps, or with nothing learned.
pub(super) fn check(bound: &Bound, ahead: Option<f64>) -> Option<Check> {
    let ahead = ahead.filter(|_| !bound.learned.is_empty())?;
    let said = format!(
        "the run ended while a step still moved a learned parameter by {:.1} %: give a larger budget, or more iterations",
        100.0 * ahead
    );
    Some(Check::new("settled", ("", ""), (ahead, NEAR), said))
}
