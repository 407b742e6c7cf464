//! Noise that neighbouring rows share over so much of a record that it may as well be what the equations leave.

use super::Check;
use super::misfits::Misfits;
use crate::ends::ends;
use crate::shared_noise::{SharedNoise, spacing};

/// Share of a record over which noise may die away. A support that has settled and gauges with a common offset left misfits that die away over
/// a quarter of a beam.
const LONGEST: f64 = 0.125;
/// Rows over which noise may die away in any record: where rows are few, neighbours share a little of it by chance.
const ROWS: f64 = 12.0;

/// Whether shared noise dies away within a record; nothing where rows share none.
pub(super) fn check(left: &Misfits, shared: Option<SharedNoise>) -> Option<Check> {
    let shared = shared.filter(|_| left.is_record())?;
    let (first, last) = ends(left.places.iter().copied());
    let share = shared.length / (last - first);
    let longest = LONGEST.max(ROWS * spacing(&left.places)? / (last - first));
    let said = format!(
        "what is left of `{}` is alike over {:.0} % of the record, as an offset or a wrong condition, equation or parameter leaves it: no noise of \
         a sensor dies away so slowly, and a drift that does cannot be told from a source",
        left.term.name,
        100.0 * share
    );
    Some(Check::new("pattern", left.name(), (share, longest), said))
}
