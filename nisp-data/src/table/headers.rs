//! What a header says: a name, and a unit in brackets or behind an underscore.

use nisp_units::{Conversion, conversion, is_unit};

pub(super) fn base(header: &str) -> &str {
    header.split(['[', '(']).next().unwrap_or(header).trim_end()
}

pub(super) fn starts_with_name(header: &str, name: &str) -> bool {
    header.strip_prefix(name).is_some_and(|rest| rest.starts_with([' ', '_', '[', '(', '.', '-']))
}

/// Whether `header` is `name [unit]`, `name (unit)` or `name_unit`, for the given unit, a multiple of it, or any.
pub(super) fn answers(header: &str, name: &str, unit: Option<&str>) -> bool {
    let Some(rest) = header.strip_prefix(name) else { return false };
    if let Some(inner) = bracketed(rest) {
        return unit.is_none_or(|unit| fits(inner, unit));
    }
    let Some(suffix) = rest.strip_prefix('_') else { return false };
    match unit {
        Some(unit) => !is_plain(unit) && fits(suffix, unit),
        None => is_unit(suffix),
    }
}

pub(super) fn fits(own: &str, unit: &str) -> bool {
    is_plain(own) && is_plain(unit) || own.trim() == unit.trim() || conversion(own, unit).is_some()
}

/// How numbers in the unit that a header ends with become numbers in another: `t [ms]`, `t (ms)`, `t_ms`.
pub(super) fn found(header: &str, unit: &str) -> Option<Conversion> {
    match in_brackets(header) {
        Some(own) => conversion(own, unit),
        None => header.match_indices('_').find_map(|(at, _)| conversion(&header[at + 1..], unit)),
    }
}

/// The unit that a header says it is in: anything in square brackets, and what is a unit in round ones.
pub(super) fn claimed(header: &str) -> Option<&str> {
    in_brackets(header).filter(|inner| header.ends_with(']') || is_unit(inner))
}

/// What stands for a unit at the end of a header, and is none: numbers would be taken for those of another unit.
pub(super) fn misspelt(header: &str) -> Option<&str> {
    in_brackets(header).map(str::trim).filter(|own| !is_unit(own) && is_unit(&own.to_lowercase()))
}

pub(super) fn in_brackets(header: &str) -> Option<&str> {
    let open = if header.ends_with(']') { '[' } else { '(' };
    bracketed(&header[header.find(open)?..])
}

pub(super) fn bracketed(text: &str) -> Option<&str> {
    let text = text.trim_start();
    let within = |open, close| text.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
    within('[', ']').or_else(|| within('(', ')'))
}

pub(super) fn is_plain(unit: &str) -> bool {
    matches!(unit.trim(), "" | "1" | "-")
}
