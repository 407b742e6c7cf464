//! Columns that equations take as exact, and that are measured.

use crate::noise::of_given;
use crate::problem::Bound;
use crate::units::Number;

/// What to do about a column of an equation over one coordinate that is noisy; nothing where none is.
pub(super) fn noisy(bound: &Bound) -> Option<String> {
    let groups = bound.problem.scene().schema.groups;
    let mut columns = (0..groups.len()).flat_map(|at| of_given(bound, at).into_iter().zip(groups[at].columns));
    columns.find(|(noise, _)| *noise > 0.0).map(|(noise, column)| {
        format!(
            "equations take `{}` as exact, and it has a noise of {:.2e}{}: where it is measured, declare it among the sources instead of \
             the columns, and observe it with the others",
            column.name,
            bound.system.outward(&column.unit).of(Number::engine(noise)),
            column.unit.behind(),
        )
    })
}
