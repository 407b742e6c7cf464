//! Units that cannot be read.

use super::{help, nearest, shorten};
use crate::unit::{known_symbols, look_up};

/// Names of units, for those who spell them out; the first that fits is meant.
const SPELLED_OUT: [(&str, &str); 12] = [
    ("kilogram", "kg"),
    ("gram", "g"),
    ("met", "m"),
    ("sec", "s"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("joule", "J"),
    ("watt", "W"),
    ("volt", "V"),
    ("kelvin", "K"),
    ("radian", "rad"),
    ("degree", "deg"),
];

pub(crate) fn absurd_unit() -> String {
    "this unit is too large, too small, or has an absurd exponent".into()
}

pub(crate) fn ambiguous_unit(text: &str, found: &str) -> String {
    let next = found.trim_matches('`');
    let (above, below) = text.rsplit_once('/').unwrap_or((text, ""));
    help(
        "it is not clear whether this stands above or below the fraction bar",
        format!("write `[{above}/({below} {next})]` or `[{above}/{below} * {next}]`"),
    )
}

pub(crate) fn expected_unit(found: &str) -> String {
    help(format!("expected a unit, found {found}"), "for instance `[m/s^2]`, `[kg m^-3]`, or `[1]` for a pure number")
}

/// `Nm` as `N` and `m`.
fn two_units(symbol: &str) -> Option<(&str, &str)> {
    let cuts = symbol.char_indices().skip(1).map(|(cut, _)| symbol.split_at(cut));
    cuts.into_iter().find(|(first, second)| look_up(first).is_some() && look_up(second).is_some())
}

pub(crate) fn unknown_unit(symbol: &str) -> String {
    let stem = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    let step = if matches!(symbol, "degC" | "degF") {
        format!("temperatures of equations are in `K`; columns of tables may be in `{symbol}`")
    } else if stem.len() < symbol.len() && look_up(stem).is_some() {
        format!("a power is written `{stem}^{}`", &symbol[stem.len()..])
    } else if let Some((_, short)) = SPELLED_OUT.iter().find(|(long, _)| symbol.to_lowercase().starts_with(long)) {
        format!("write `{short}`")
    } else if let Some((first, second)) = two_units(symbol) {
        format!("a product is written `{first} {second}`")
    } else {
        // The commonest prefixed units come first, so that ties go to them.
        match nearest(symbol, ["kg", "mm", "kN", "kPa", "MPa", "GPa", "ms"].into_iter().chain(known_symbols())) {
            Some(found) => format!("did you mean `{found}`?"),
            None => {
                "SI units with prefixes are known (`mm`, `kPa`, `GHz`), `deg`, `bar`, `min`, `h`, `L`, `t`, `%`".into()
            }
        }
    };
    help(format!("`{}` is not a unit", shorten(symbol)), step)
}

pub(crate) fn expected_exponent(found: &str) -> String {
    help(format!("expected an exponent, found {found}"), "for instance `m^2`, `s^-1`, `m^0.5`, `m^(1/2)`")
}
