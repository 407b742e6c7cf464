//! Sources that crowd along what is stated of a field all around a domain: many times as large there as elsewhere. Data that are off from what is
//! stated, as those of a cloud that was lifted, ask for that: in a layer at the edges the source bends the field from the one to the other.

use super::Check;
use crate::solve::vector::root_mean_square;

/// A source at the edges over what it is at nine of ten other places, at most. Of clouds that were lifted by a tenth of their height it was 15 to 28,
/// of those that were moved aside by as much 8 to 11, and of right answers 0.3 to 1.2.
const LARGEST: f64 = 6.0;

/// One check for a source that crowds along what is stated of a field: sizes of the source next to the places where it is stated, and at places
/// that are far from them.
pub(crate) fn check(
    source: &'static str,
    field: &'static str,
    (mut beside, mut elsewhere): (Vec<f64>, Vec<f64>),
) -> Option<Check> {
    [&mut beside, &mut elsewhere].into_iter().for_each(|sizes| sizes.sort_by(f64::total_cmp));
    // More at half of the places, and at both of two.
    let own = beside.get(beside.len().checked_sub(1)? / 2)?;
    // Of a source in patches most places have nothing.
    let most = elsewhere.get(9 * elsewhere.len() / 10)?.max(root_mean_square(elsewhere.iter().copied()));
    let size = own / most;
    let said = format!(
        "`{source}` is {size:.0} times as large at the edges, where values of `{field}` are stated, as at nine of ten places elsewhere: there it \
         bends the answer from what is stated to what is measured; check what is stated, and where the data are"
    );
    (size > LARGEST).then(|| Check::new("edge", ("", source), (size, LARGEST), said))
}
