//! Derivatives and partners that make no sense.

use crate::error::catalogue::{help, shorten};

pub(crate) fn no_coordinates(name: &str) -> String {
    format!("`{name}` needs spatial coordinates")
}

pub(crate) fn derivative_of_column() -> String {
    help("a data column has no derivative", "it is known at single points; make it a field, and `observe` that")
}

pub(crate) fn derivative_of_partner() -> String {
    help("take the derivative first", "write `partner(d(u, x))`")
}

pub(crate) fn derivative_is_zero(text: &str) -> String {
    format!("this derivative is zero: `{}` does not depend on the coordinates", shorten(text))
}

pub(crate) fn derivative_of_jump() -> String {
    help(
        "what jumps is differentiated: its derivative is taken to be zero there, and the jump's own part is left out",
        "for two materials declare two fields, and say at their interface what goes on across it",
    )
}

pub(crate) fn order_too_high(order: u32, limit: u32) -> String {
    help(
        format!("this is a derivative of order {order}; the highest is {limit}"),
        "introduce a field for a lower derivative, with an equation that defines it",
    )
}

pub(crate) fn bad_order(text: &str) -> String {
    help(format!("`{}` is no order of a derivative", shorten(text)), "use a whole number from 1, as in `d(u, x, 2)`")
}

pub(crate) fn partner_without_pairs() -> String {
    help("points have partners in groups of pairs only", "declare the group with `on name pairs { ... }`")
}

pub(crate) fn partner_of_partner() -> String {
    "a partner's partner is the point itself".into()
}

pub(crate) fn partner_of_column() -> String {
    help("a data column belongs to the point, not to its partner", "give the partner's value a column of its own")
}

pub(crate) fn operator_over_time(operator: &str, time: &str) -> String {
    help(
        format!("`{operator}` also goes over `{time}`"),
        format!("declare it as `{time}: time` if it is one: without units nothing else tells"),
    )
}
