//! Learned parameters that ended far from what was believed of them.

use super::Check;
use crate::problem::Bound;
use crate::schema;
use crate::units::{Engine, Number};

/// Distance from what was believed, in its own deviations, beyond which it is contradicted.
const FAR: f64 = 4.0;

/// Checks of the beliefs of a group whose rows are the distances from what was believed.
pub(super) fn checks(bound: &Bound, group: &'static schema::Group, rows: &[Vec<f64>]) -> Vec<Check> {
    let check = |term: &'static schema::Term| {
        let within = bound.system.size(&term.unit).back(term.within?);
        let away = Number::engine(*rows[term.first].first()?);
        let words = |number: Number<Engine>| {
            let number = bound.system.outward(&term.unit).of(number);
            format!("{number:.2e}{}", term.unit.behind())
        };
        let said = format!(
            "learned `{}` is off by {} from what was believed of it within {}: the data contradict the belief; check both, or the \
             equations",
            term.name,
            words(away),
            words(within)
        );
        Some(Check::new("belief", (group.name, term.name), ((away.as_engine() / within.as_engine()).abs(), FAR), said))
    };
    group.terms.iter().filter_map(check).collect()
}
