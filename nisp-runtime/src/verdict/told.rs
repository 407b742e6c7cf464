//! Sources that a record does not tell from none: they are smaller than what is left open of them.

use super::Check;
use crate::facts::Told;
use crate::problem::Bound;
use crate::schema::Group;

/// Standard deviations that a source is large at least, in the mean over the time along which it is alike; or by which it is
/// nearer to the truth than none: a source that is large in few places only. Of simulated sources that are smaller one in five is
/// farther off than none would be, or outside of its bars; of larger ones one in thirty.
const LEAST: f64 = 1.2;
const NEARER: f64 = 3.0;

/// Share of what was not known of a source's mean beforehand that data may leave.
const OPEN: f64 = 0.9;

/// Two checks for every source that its carrier tells of.
pub(super) fn checks(bound: &Bound, told: &[Told]) -> Vec<Check> {
    let heads = bound.problem.scene().schema.heads;
    let size = |told: &Told| told.size.map_or(0.0, |size| size.max(told.nearer * LEAST / NEARER));
    let check = |own: &Told| {
        let (name, size_of) = (heads[own.head].name, size(own));
        if own.size.is_none() {
            let said = format!(
                "`{name}` has no error bars, so that nothing says how much of it is noise: give a larger budget or more iterations, or \
                 take another carrier"
            );
            return Check::new("told", ("", name), (f64::INFINITY, 1.0 / LEAST), said);
        }
        let is_beside =
            |other: &&Told| other.head != own.head && size(other) < LEAST && are_together(bound, own.head, other.head);
        let hint = match told.iter().find(is_beside) {
            Some(other) => format!(
                "`{}` acts in the same equations and is told no better, so that only what both make together may be known: then declare \
                 one of them, or measure one",
                heads[other.head].name
            ),
            None => "below that, measure more often, more exactly, or for longer".into(),
        };
        let said = format!(
            "`{name}` is {size_of:.2} times as large as its standard deviation, and is told from none from {LEAST} on; {hint}"
        );
        Check::new("told", ("", name), (size_of.recip(), 1.0 / LEAST), said)
    };
    let open = |told: &Told| {
        let name = heads[told.head].name;
        let said = format!(
            "the data do not determine the mean of `{name}`: {:.0} % of its variance is what was believed before any measurement; a \
             condition on a field that moves along with it would settle it",
            100.0 * told.open
        );
        Check::new("determined", ("", name), (told.open, OPEN), said)
    };
    told.iter().flat_map(|told| [check(told), open(told)]).collect()
}

/// True if some equations read both of two heads.
fn are_together(bound: &Bound, one: usize, other: usize) -> bool {
    let reads = |group: &Group, head| group.jets.iter().any(|jet| jet.head == head);
    bound.problem.scene().schema.groups.iter().any(|group| reads(group, one) && reads(group, other))
}
