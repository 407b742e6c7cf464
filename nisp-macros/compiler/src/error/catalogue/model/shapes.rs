//! Shapes that do not fit.

use crate::error::catalogue::{help, shorten};

pub(crate) fn expected_scalar(what: &str, text: &str, found: &str) -> String {
    help(
        format!("{what} must be a scalar, but `{}` is {found}", shorten(text)),
        "take a component (`u[0]`), or a scalar of it: `dot`, `norm`, `tr`, `det`",
    )
}

pub(crate) fn bad_list_length(length: usize) -> String {
    format!("a vector has from 1 to 9 entries, found {length}")
}

pub(crate) fn uneven_entries(first: &str, text: &str, found: &str) -> String {
    format!("entries must be alike: the first is {first}, but `{}` is {found}", shorten(text))
}

pub(crate) fn too_many_brackets() -> String {
    "vectors and matrices are all there is: these brackets nest too deeply".into()
}

pub(crate) fn shapes_differ(odd: (&str, &str), other: (&str, &str)) -> String {
    format!("shapes differ: `{}` is {}, but `{}` is {}", shorten(odd.0), odd.1, shorten(other.0), other.1)
}

pub(crate) fn cannot_multiply(left: &str, right: &str, text: &str) -> String {
    let step = if left.contains("vector") && right.contains("vector") {
        "write `dot(a, b)`, `cross(a, b)` or `outer(a, b)`"
    } else {
        "a matrix times a vector or matrix needs as many columns as the other has rows"
    };
    help(format!("{left} cannot be multiplied by `{}`, which is {right}", shorten(text)), step)
}

pub(crate) fn cannot_index(text: &str, found: &str, indices: usize) -> String {
    let step = "units go after numbers only, as in `2 [m]`; components are `u[0]`, `u[x]`, `sigma[x, y]`";
    help(format!("`{}` is {found} and cannot take {indices} index(es)", shorten(text)), step)
}

pub(crate) fn bad_index(text: &str, side: usize) -> String {
    let last = side.saturating_sub(1);
    help(
        format!("`{}` is no index", shorten(text)),
        format!("use a number from 0 to {last}, or the name of a spatial coordinate"),
    )
}

pub(crate) fn wrong_shape(name: &str, text: &str, found: &str, spatial: usize) -> String {
    let expected = match name {
        "div" => format!("a vector of {spatial}, or a matrix of {spatial} columns"),
        "curl" => "a vector of 2 or 3, one entry for each spatial coordinate".into(),
        "hessian" => "a scalar".into(),
        _ => "a scalar or a vector".into(),
    };
    format!("`{name}` takes {expected}, but `{}` is {found}", shorten(text))
}

pub(crate) fn wrong_shapes(name: &str, found: &str) -> String {
    let expected = match name {
        "dot" => "two vectors or two matrices of one shape",
        "cross" => "two vectors of 3, or of 2",
        "outer" => "two vectors",
        "norm" => "a vector or a matrix; of a scalar it is `abs`",
        "det" => "a square matrix of at most 4 x 4",
        "inverse" => "an invertible square matrix of at most 3 x 3",
        "transpose" => "a matrix",
        _ => "a square matrix",
    };
    format!("`{name}` takes {expected}, found {found}")
}
