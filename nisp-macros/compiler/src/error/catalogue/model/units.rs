//! Messages about units.

use super::super::{bracketed, help, shorten};
use crate::unit::Dimension;

/// `` `h6` is [m^2], `q` is [m] ``, for the few names of a wrong term.
fn listed(names: &[(String, Dimension)]) -> String {
    const MOST: usize = 6;
    let shown: Vec<String> =
        names.iter().take(MOST).map(|(name, dimension)| format!("`{name}` is {}", bracketed(dimension))).collect();
    shown.join(", ")
}

pub(crate) fn units_differ(what: &str, odd: (&str, &Dimension), other: (&str, &Dimension), hint: &str) -> String {
    help(
        format!(
            "units differ between {what}: `{}` is {}, but `{}` is {}",
            shorten(odd.0),
            bracketed(odd.1),
            shorten(other.0),
            bracketed(other.1)
        ),
        hint,
    )
}

pub(crate) fn units_differ_by(found: &Dimension, expected: &Dimension, names: &[(String, Dimension)]) -> String {
    let factor = expected.over(found).map(|factor| format!("a factor {} is missing", bracketed(&factor)));
    let factor = factor.unwrap_or_else(|| "check its exponents".into());
    if names.is_empty() { factor } else { format!("{factor}; here {}", listed(names)) }
}

pub(crate) fn give_a_unit(number: &str, expected: &Dimension) -> String {
    format!("give the number a unit: `{number} [{expected}]`")
}

pub(crate) fn not_dimensionless(what: &str, text: &str, found: &Dimension, names: &[(String, Dimension)]) -> String {
    let step = if names.len() == 1 && names[0].0 == text { String::new() } else { format!("; here {}", listed(names)) };
    help(
        format!("{what} must be a pure number, but `{}` is {}", shorten(text), bracketed(found)),
        format!("divide by something of the same unit{step}"),
    )
}

pub(crate) fn value_has_other_unit(text: &str, found: &Dimension, declared: &Dimension) -> String {
    format!("`{}` is {}, but the declared unit is {}", shorten(text), bracketed(found), bracketed(declared))
}

pub(crate) fn constant_without_value(name: &str) -> String {
    help(format!("the constant `{name}` has no value"), format!("write `{name} = 3`, or declare it under `parameters`"))
}

pub(crate) fn within_unit(given: &Dimension, rows: &Dimension) -> String {
    help(
        format!("units differ: rows may be off by {}, but they are {}", bracketed(given), bracketed(rows)),
        "give what follows `within` the unit of the condition's sides",
    )
}

pub(crate) fn observed_unit(observed: (&str, &Dimension), column: (&str, &Dimension)) -> String {
    format!(
        "units differ: `{}` is {}, but the column `{}` is {}",
        shorten(observed.0),
        bracketed(observed.1),
        shorten(column.0),
        bracketed(column.1)
    )
}

pub(crate) fn column_has_unit(name: &str) -> String {
    help(format!("the column `{}` is declared already, with its unit", shorten(name)), "leave the unit out here")
}
