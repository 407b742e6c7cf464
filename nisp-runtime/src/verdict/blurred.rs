//! Whether what is left of an equation is no more than the noise of its columns makes of it.
//!
//! An equation that takes a measured column for known may be missed by as much as the noise of that column. Such a miss has no slow
//! course: no mode of it has more power than the noise. A wrong parameter leaves all of its own in few slow modes.

use super::{Check, slow};
use crate::facts::Facts;
use crate::noise::{in_order, of_given};
use crate::problem::Bound;
use crate::residual::Programs;

/// Excess of slow modes in standard deviations. The noise is known from differences alone, which chance puts off as well.
const PATTERN: f64 = 6.0;

/// Checks of the equations of a group that know noisy columns, whose rows over the group's points are `rows`.
pub(super) fn checks(
    bound: &Bound,
    group: usize,
    (facts, rows): (&Facts, &[Vec<f64>]),
    programs: &dyn Programs<f64>,
    scalars: &[f64],
) -> Vec<Check> {
    let schema = &bound.problem.scene().schema.groups[group];
    let blurs = facts.blurs(programs, schema, scalars, &of_given(bound, group));
    let own =
        |row: usize| Some(&rows[row]).filter(|left| blurs[row] > 0.0 && left.len() == bound.coordinates[group].len());
    let terms = schema.terms.iter().flat_map(|term| (term.first..term.first + term.rows).map(move |row| (term, row)));
    let check = |(term, row): (&'static crate::schema::Term, usize)| {
        let (excess, share) = slow::above(&in_order(&bound.coordinates[group], own(row)?), blurs[row].powi(2));
        let said = format!(
            "what is left of `{}.{}` is more than the noise of what it takes for known: {:.0} % of its square is a slow course, so \
             a parameter, a column or the equation itself does not describe the data",
            schema.name,
            term.name,
            100.0 * share
        );
        Some(Check::new("pattern", (schema.name, term.name), (excess, PATTERN), said))
    };
    terms.filter_map(check).collect()
}
