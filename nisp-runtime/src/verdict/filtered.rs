//! Rows that were filtered, as their noise says: it is smooth from row to row.

use super::Check;
use super::misfits::Misfits;
use crate::shared_noise::{Alike, SharedNoise, spacing};

/// Lengths of smooth noise from which on two rows hardly share any: a tenth.
const APART: f64 = 2.3;

/// Rows up to which smooth noise and noise that changes as a walk does are alike.
const LEAST: f64 = 2.0;

/// What a filter leaves of noise in the band that it lets pass looks like a source's own course: how large it is can be seen only where the filter
/// takes it away.
pub(super) fn check(left: &Misfits, shared: Option<SharedNoise>) -> Option<Check> {
    let shared = shared.filter(|own| own.alike == Alike::Smooth)?;
    let rows = shared.length / spacing(&left.places)?;
    let every = (APART * rows).ceil().max(2.0);
    let said = format!(
        "the noise of `{0}` is smooth over about {rows:.1} rows, as a filter leaves it, and a source takes what of it changes more slowly: give the \
         rows as they were measured, or only one of every {every}, or say how exact they are (`observe {0} within ...`)",
        left.term.name
    );
    Some(Check::new("filtered", left.name(), (rows, LEAST), said))
}
