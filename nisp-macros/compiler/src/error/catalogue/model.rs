//! What the model stage has to say.

use super::{bracketed, help, shorten};
use crate::unit::Dimension;

mod derivatives;
mod names;
mod shapes;
mod units;

pub(crate) use derivatives::*;
pub(crate) use names::*;
pub(crate) use shapes::*;
pub(crate) use units::*;

/// `1 argument`, `2 arguments`
pub(crate) fn count(expected: usize) -> String {
    if expected == 1 { "1 argument".into() } else { format!("{expected} arguments") }
}

pub(crate) fn wrong_arguments(name: &str, expected: &str, found: usize) -> String {
    let message = format!("`{name}` takes {expected}, found {found}");
    match name {
        "d" => help(message, "a derivative is written `d(u, x)`, `d(u, x, 2)` or `d(u, x, y)`"),
        _ => message,
    }
}

pub(crate) fn expression_too_large(limit: u32) -> String {
    help(
        format!("this expression grows past {limit} operations when it is written out"),
        "break the equation up: introduce a field for a part of it, with an equation of its own",
    )
}

pub(crate) fn expression_too_deep(limit: u32) -> String {
    help(
        format!("this expression is more than {limit} operations deep, with all definitions written out"),
        "break the equation up: introduce a field for a part of it, with an equation of its own",
    )
}

pub(crate) fn spread_not_positive(name: &str) -> String {
    help(
        format!("`{name}` cannot be believed to be within zero or less of its value"),
        format!("give a positive width, or fix it in a scene: `{name} = ...;`"),
    )
}

pub(crate) fn division_by_zero() -> String {
    "this divides by zero".into()
}

pub(crate) fn exponent_too_large(limit: i128) -> String {
    format!("exponents go up to {limit}")
}

pub(crate) fn integral_within() -> String {
    help(
        "`integral(...)` stands alone on one side of a condition",
        "move what is around it inside, or to the other side: `integral(2 * f) == total`; to read an integral over one coordinate \
         from an answer, declare a field `F` with `d(F, t) == 2 * f`, and `F == 0` at the start",
    )
}

pub(crate) fn integral_inequality() -> String {
    "an integral is compared by `==`".into()
}

pub(crate) fn target_varies(text: &str) -> String {
    help(
        format!("`{}` varies from point to point", shorten(text)),
        "what an integral equals is made of parameters and numbers",
    )
}

pub(crate) fn integral_units(integrand: (&str, &Dimension), target: (&str, &Dimension)) -> String {
    help(
        format!(
            "units differ: `integral({})` is {} times a length, an area, a volume or an extent of the coordinates, \
             but `{}` is {}",
            shorten(integrand.0),
            bracketed(integrand.1),
            shorten(target.0),
            bracketed(target.1)
        ),
        "the integral sums over the group with the points' quadrature weights",
    )
}

pub(crate) fn mixed_conditions() -> String {
    help(
        "the conditions of one term must be of one kind",
        "give each kind a term of its own; two that are not negative and one of them zero are `0 <= a _|_ b >= 0`",
    )
}

pub(crate) fn nothing_to_solve(text: &str) -> String {
    help(
        format!("`{}` contains no field, source or parameter", shorten(text)),
        "it holds or fails whatever the solution is",
    )
}

pub(crate) fn holds_always(text: &str) -> String {
    help(
        format!("`{}` holds whatever the solution is: everything cancels", shorten(text)),
        "remove it, or correct a side",
    )
}

pub(crate) fn no_unknown_function(text: &str) -> String {
    help(
        format!("`{}` contains no field and no source", shorten(text)),
        "give a parameter its value where it is declared: `k [N/m] = 2`, or `within` what it is believed to be off by",
    )
}

pub(crate) fn contradicts_bound(text: &str, name: &str) -> String {
    help(
        format!("`{}` contradicts the bound of `{name}`", shorten(text)),
        format!("widen the bound of `{name}`, or correct the value"),
    )
}

pub(crate) fn observed_parameter(name: &str) -> String {
    help(
        format!("`{name}` is a parameter, which is the same at all points"),
        format!("write what is known of it where it is declared: `{name} = 5 within 0.5`"),
    )
}

pub(crate) fn rigid_surface(text: &str) -> String {
    help(
        format!("the surface `{}` contains no field, source or parameter", shorten(text)),
        "write where its points move to, for instance `chamfer [x + u, y + v, w]`",
    )
}

pub(crate) fn nothing_unknown(scene: &str) -> String {
    help(
        format!("in the scene `{scene}` nothing is unknown: all fields and sources are fixed"),
        "leave one of them open, or `learn` a parameter",
    )
}

pub(crate) fn nothing_measured(scene: &str) -> String {
    help(
        format!("the scene `{scene}` has something to find, and nothing is measured"),
        "observe a field: `on samples { observe u; }`",
    )
}

pub(crate) fn learned_in_vain(parameter: &str, scene: &str) -> String {
    help(
        format!("`{parameter}` is learned in the scene `{scene}`, and no term of it reads `{parameter}`"),
        "leave it out of `learn`, or use its term",
    )
}

pub(crate) fn not_separable(parameter: &str, source: &str) -> String {
    help(
        format!(
            "learned `{parameter}` and unknown `{source}` cannot be told apart: one may be doubled where the other is halved or doubled"
        ),
        format!(
            "give `{parameter}` its value, say `within` what it is believed to be off by, or state a value of `{source}`"
        ),
    )
}

pub(crate) fn nothing_to_observe(text: &str) -> String {
    format!("`{}` contains no field or source to observe", shorten(text))
}

pub(crate) fn complementarity_of_equation() -> String {
    help("both sides of a complementarity are inequalities", "write `0 <= a _|_ b >= 0`")
}

pub(crate) fn complementarity_of_vectors() -> String {
    "complementarity is between scalars: write a term for each component".into()
}

pub(crate) fn chamfer_of(found: &str) -> String {
    help(
        format!("`chamfer` takes the position of a surface point (2 to 4 coordinates), found {found}"),
        "write `chamfer [x + u, y + v, w]`",
    )
}

pub(crate) fn empty_group(name: &str) -> String {
    format!("nothing is asked of the points `{name}`")
}

pub(crate) fn empty_interval() -> String {
    "the upper bound is not above the lower one".into()
}

pub(crate) fn outside_bounds(name: &str) -> String {
    format!("the default of `{name}` lies outside its bounds")
}

pub(crate) fn wrong_number_of_values(expected: usize, found: usize) -> String {
    format!("expected {expected} value(s), one for each component, found {found}")
}

pub(crate) fn not_constant(text: &str, reads_parameters: bool) -> String {
    let message = format!("`{}` is not known when this compiles", shorten(text));
    match reads_parameters {
        true => help(message, "a parameter may change from run to run: declare it under `constants` instead"),
        false => help(message, "use numbers and constants"),
    }
}

pub(crate) fn not_finite(text: &str) -> String {
    format!("`{}` has no finite value", shorten(text))
}

pub(crate) fn scene_without_terms(name: &str) -> String {
    format!("the scene `{name}` uses no term")
}

pub(crate) fn fixed_by_fields(text: &str) -> String {
    help(
        format!("`{}` contains fields, so it fixes nothing", shorten(text)),
        "use coordinates, parameters and numbers, or write a term",
    )
}

pub(crate) fn hard_by_fields(text: &str) -> String {
    help(format!("`{}` contains fields", shorten(text)), "a hard condition is made of coordinates and parameters")
}

pub(crate) fn distance_does_not_vary(text: &str) -> String {
    help(
        format!("`{}` does not depend on the coordinates", shorten(text)),
        "the distance is zero on the boundary and not elsewhere: `1 - (x / a)^2`",
    )
}

pub(crate) fn hard_and_bounded(name: &str) -> String {
    format!("`{name}` has bounds by construction and cannot keep a hard condition as well")
}

pub(crate) fn hard_twice(name: &str) -> String {
    format!("`{name}` has a hard condition already")
}

pub(crate) fn source_without_equation(name: &str) -> String {
    help(format!("no equation contains the source `{name}`"), "nothing could be said about it; add it to a term")
}

pub(crate) fn unpinned(name: &str, source: bool, order: u32, scene: Option<&str>) -> String {
    let place = scene.map(|scene| format!(" in scene `{scene}`")).unwrap_or_default();
    if source {
        return help(
            format!(
                "`{name}` occurs only under an operator of order {order}{place}: what that operator sends to zero stays undetermined"
            ),
            format!("add a condition on `{name}`, for instance its value at one point"),
        );
    }
    help(
        format!("no condition and no data pin `{name}`{place}: it occurs only in equations of order {order}"),
        "add boundary or initial conditions, or observe it",
    )
}

pub(crate) fn few_conditions(name: &str, order: u32, needed: usize, found: usize, scene: Option<&str>) -> String {
    let place = scene.map(|scene| format!(" in scene `{scene}`")).unwrap_or_default();
    help(
        format!(
            "`{name}` obeys an equation of order {order}{place}, which usually takes {needed} conditions, found {found}"
        ),
        "a clamped edge, for instance, is `w == 0` and a zero slope `dot(grad(w), n) == 0`",
    )
}
