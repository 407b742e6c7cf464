//! What errors say, in one place so that they say it alike: what was expected, what was found, what to do.

use crate::loss;
use crate::unit::Dimension;

mod model;
mod nearest;
mod unit;

pub(crate) use model::*;
pub(crate) use nearest::nearest;
pub(crate) use unit::*;

/// A message and the next step.
fn help(message: impl std::fmt::Display, step: impl std::fmt::Display) -> String {
    format!("{message}\n= help: {step}")
}

/// A token's or expression's text, cut where a message would become unreadable.
pub(crate) fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_string();
    }
    format!("{}...", text.chars().take(LONGEST).collect::<String>())
}

/// A dimension as a unit in brackets.
fn bracketed(dimension: &Dimension) -> String {
    format!("[{dimension}]")
}

pub(crate) fn nested_too_deeply(limit: usize) -> String {
    help(format!("this is nested more than {limit} levels deep"), "name parts of it with `let`")
}

pub(crate) fn missing_semicolon() -> String {
    "expected `;` after this".into()
}

pub(crate) fn expected_end(found: &str) -> String {
    let step = if found == "`=`" {
        "an equation is written `a == b`"
    } else if found == "`<`" || found == "`>`" {
        "inequalities are written `a >= b` or `a <= b`"
    } else if found.starts_with("`_") {
        "complementarity is written `0 <= a _|_ b >= 0`"
    } else if is_operand(found) {
        "multiplication is written `a * b`, and a statement ends with `;`"
    } else {
        "a statement ends with `;`"
    };
    help(format!("expected an operator or `;`, found {found}"), step)
}

/// True if what was found could be a factor, so that an operator is missing in front of it.
fn is_operand(found: &str) -> bool {
    found == "`(`" || found.trim_start_matches('`').starts_with(char::is_alphanumeric) && found != "the end"
}

pub(crate) fn expected_separator(found: &str) -> String {
    help(
        format!("expected `,` or `;`, found {found}"),
        "a declaration is a name, then perhaps a unit, bounds or a value: `E [Pa] = 2e9, nu in 0 .. 0.5;`",
    )
}

/// `learn k` where parameters are declared.
pub(crate) fn learned_by_a_scene(found: &str) -> String {
    help(format!("expected `,` or `;`, found {found}"), LEARNED)
}

const LEARNED: &str = "declare the parameter like any other, and let a scene learn it: `scene fit { learn k; }`";

pub(crate) fn expected_name(what: &str, found: &str) -> String {
    format!("expected the name of {what}, found {found}")
}

pub(crate) fn keyword_as_name(name: &str) -> String {
    help(format!("`{name}` is a word of Rust and cannot be a name"), format!("write `{name}_` or another name"))
}

pub(crate) fn raw_name(plain: &str) -> String {
    help(
        format!("`r#{plain}` cannot be a name: names are no raw identifiers"),
        format!("write `{plain}_` or another name"),
    )
}

pub(crate) fn expected_operator(text: &str, after: &str, found: &str) -> String {
    format!("expected `{text}` after `{after}`, found {found}")
}

pub(crate) fn not_a_doc_comment() -> String {
    help("`#` begins nothing here", "comments begin with `//`, and docs with `///`")
}

pub(crate) fn not_a_number(written: &str) -> String {
    format!("expected an expression, found `{}`", shorten(written))
}

pub(crate) fn suffixed_number(number: &str, suffix: &str) -> String {
    if number == "0" && suffix.starts_with(['x', 'b', 'o']) && suffix.len() > 1 {
        return help(format!("`{number}{}` is not a decimal number", shorten(suffix)), "write it in decimal");
    }
    help(
        format!("`{number}{}` is not a number", shorten(suffix)),
        format!("write `{number} * {0}`, or `{number} [{0}]` for a unit", shorten(suffix)),
    )
}

pub(crate) fn number_too_large(written: &str) -> String {
    format!("`{}` is larger than any floating-point number", shorten(written))
}

pub(crate) fn expected_expression(found: &str) -> String {
    let message = format!("expected an expression, found {found}");
    if found == "`*`" { help(message, "a power is written `a^b`") } else { message }
}

pub(crate) fn expected_close(found: &str) -> String {
    let step = "multiplication is written `a * b`; entries are separated by `,`";
    help(format!("expected an operator, `,` or the end of the brackets, found {found}"), step)
}

pub(crate) fn expected_shape(coordinate: bool, found: &str) -> String {
    let expected = if coordinate { "`time`" } else { "`vector`" };
    help(format!("expected {expected} after `:`, found {found}"), "a scalar is written without a colon: `u [m]`")
}

pub(crate) fn bad_vector_length() -> String {
    "a vector has from 1 to 9 components, as in `vector(3)`".into()
}

pub(crate) fn expected_range(found: &str) -> String {
    help(format!("expected `..`, found {found}"), "an interval is written `in 0 .. 5`")
}

pub(crate) fn takes_no_value(what: &str) -> String {
    help(
        format!("{what} takes no value here"),
        "parameters and constants do; fix a source in a scene, a field in a point group",
    )
}

pub(crate) fn takes_no_bounds(what: &str) -> String {
    help(format!("{what} takes no bounds"), "sources, fields and parameters do")
}

pub(crate) fn depends_on_nothing(what: &str) -> String {
    help(format!("{what} takes no coordinates in parentheses"), "fields and sources do: `sources: q(x) [W];`")
}

pub(crate) fn expected_points(found: &str, most: usize) -> String {
    help(format!("expected a number of points, found {found}"), format!("write `with 2000 points`, at most {most}"))
}

pub(crate) fn takes_no_spread(what: &str) -> String {
    help(
        format!("{what} takes no `within` here"),
        "parameters do: how far a learned one is believed to be from its value; terms have one of their own, before their `;`",
    )
}

pub(crate) fn unnamed_observation() -> String {
    help("an observed expression needs a name", "write `observe NAME: expression ~ column;`")
}

pub(crate) fn expected_tilde(found: &str) -> String {
    help(
        format!("expected `~` and a data column, found {found}"),
        "an observation is written `observe NAME: expression ~ column;`",
    )
}

pub(crate) fn unknown_loss(name: &str) -> String {
    help(format!("`{}` is not a loss", shorten(name)), format!("there are {}", loss::words().join(", ")))
}

pub(crate) fn expected_positive(what: &str) -> String {
    format!("expected {what} as a positive number, for instance `2`")
}

pub(crate) fn chained_relation() -> String {
    help("relations cannot be chained", "write two conditions, separated by a comma: `f >= 0, f <= 5`")
}

pub(crate) fn expected_relation(found: &str) -> String {
    let step = match found {
        "`=`" => "an equation is written `a == b`".into(),
        "`<`" | "`>`" | "`=>`" | "`=<`" => "inequalities are written `a >= b` or `a <= b`".to_string(),
        "`~`" => "observations begin with `observe`: `observe NAME: expression ~ column;`".into(),
        _ if is_operand(found) => "multiplication is written `a * b`; a term is written `name: a == b;`".into(),
        _ => "a term is written `name: a == b;`".into(),
    };
    help(format!("expected `==`, `>=` or `<=`, found {found}"), step)
}

pub(crate) fn expected_term(found: &str) -> String {
    help(
        format!("expected a term, found {found}"),
        "a group holds `name: a == b;`, `observe field;`, `columns: name [unit];` and `let name = ...;`",
    )
}

pub(crate) fn expected_scene_item(found: &str) -> String {
    help(
        format!("expected a statement of a scene, found {found}"),
        "a scene holds `f = 0;`, `learn E;`, `without group.term;`, `only group;` and `weight group.term = 2;`",
    )
}

pub(crate) fn fix_with_one_equals(name: &str) -> String {
    help("a scene fixes values with one `=`", format!("write `{name} = ...;`"))
}

pub(crate) fn expected_module(found: &str) -> String {
    help(format!("expected a module, found {found}"), "wrap the problem in `pub mod name { ... }`")
}

pub(crate) fn one_module(found: &str) -> String {
    help(format!("expected nothing after the module, found {found}"), "one `pde!` holds one module")
}

pub(crate) fn expected_statement(found: &str, word: &str, known: &[&'static str]) -> String {
    let step = match nearest(word, known.iter().copied()) {
        _ if word == "learn" => LEARNED.into(),
        Some(found) => format!("did you mean `{found}`?"),
        None => "terms stand in a group of points: `on name { term: a == b; }`".into(),
    };
    help(format!("expected a declaration, `let`, `on` or `scene`, found {found}"), step)
}

pub(crate) fn expected_of(word: &str, found: &str) -> String {
    help(format!("expected `of` and a domain, found {found}"), format!("write `on NAME {word} of DOMAIN {{ ... }}`"))
}

pub(crate) fn expected_by(found: &str) -> String {
    help(
        format!("expected `by` and a distance, found {found}"),
        "write `hard w = 0 by 1 - x^2;`, with a distance that is zero on the boundary",
    )
}
