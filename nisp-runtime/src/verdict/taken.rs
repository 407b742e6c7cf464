//! Columns that equations take as exact, and that are measured.

use crate::noise::{by_differences, deviation, in_order};
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::units::Number;

/// Noise of a column that matters, as a share of what it varies by.
const NOISY: f64 = 2e-3;

/// What to do about a column of an equation over one coordinate that is noisy; nothing where none is.
pub(super) fn noisy(bound: &Bound) -> Option<String> {
    let schema = bound.problem.scene().schema;
    if schema.coordinates.len() != 1 {
        return None;
    }
    let is_equation = |group: usize| schema.groups[group].terms.iter().all(|term| term.kind == TermKind::Residual);
    let groups = (0..schema.groups.len()).filter(|&group| is_equation(group));
    let mut columns = groups.flat_map(|group| (0..schema.groups[group].columns.len()).map(move |at| (group, at)));
    columns.find_map(|(group, at)| {
        let column = &schema.groups[group].columns[at];
        let values = in_order(&bound.coordinates[group], &bound.columns[group][at]);
        let noise = by_differences(&values).filter(|noise| *noise > NOISY * deviation(&values))?;
        Some(format!(
            "equations take `{}` as exact, and it has a noise of {:.2e}{}: where it is measured, declare it among the sources instead of \
             the columns, and observe it with the others",
            column.name,
            bound.system.outward(&column.unit).of(Number::engine(noise)),
            column.unit.behind(),
        ))
    })
}
