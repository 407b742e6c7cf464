//! What the text of a cell says: a number, that nothing was measured, or something that it should not.

/// What loggers and spreadsheets write where nothing was measured.
const NOT_MEASURED: [&str; 9] = ["na", "n/a", "n.a.", "#n/a", "null", "none", "missing", "-", "--"];

/// The number in a cell, NaN where it says that nothing was measured. Where cells are not parted by commas, one may stand for the
/// decimal point.
pub(super) fn number(cell: &str, mark: u8) -> Result<f64, std::num::ParseFloatError> {
    if NOT_MEASURED.contains(&cell.to_lowercase().as_str()) {
        return Ok(f64::NAN);
    }
    match mark {
        b',' => cell.parse(),
        _ => cell.replacen(',', ".", 1).parse(),
    }
}

/// True of `1,234.5`, `1.234,5`, `1'234` and `1 234`.
fn parts_thousands(cell: &str) -> bool {
    let digits = cell.trim_start_matches(['-', '+']);
    let mut parts = digits.split([',', '.', '\'', ' ', '\u{a0}', '\u{202f}']);
    let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    parts.next().is_some_and(|first| first.len() < 4 && is_digits(first))
        && parts.next().is_some_and(|second| second.len() == 3 && is_digits(second))
        && parts.all(is_digits)
}

/// True of a date or a time of day: digits with dashes, slashes or colons between them.
fn is_date(cell: &str) -> bool {
    let mut parts = cell.split(['-', '/', ':', '.', ' ', 'T', 'Z', '+']).filter(|part| !part.is_empty());
    let are_digits = parts.clone().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()));
    are_digits && parts.nth(1).is_some() && cell.starts_with(|first: char| first.is_ascii_digit())
}

/// What is wrong with a cell that holds no finite number, and what to do.
pub(super) fn describe(cell: &str) -> String {
    let shown: String = cell.chars().take(24).collect();
    if cell.is_empty() {
        "the cell is empty; fill it or remove the row".into()
    } else if cell.parse::<f64>().is_ok() {
        format!("`{shown}` is not a finite number; remove the row")
    } else if cell.matches(',').count() == 1 && cell.replace(',', ".").parse::<f64>().is_ok() {
        format!("`{shown}` is not a number; write the decimal comma as a point, or part cells by semicolons")
    } else if parts_thousands(cell) {
        format!("`{shown}` is not a number; write it without marks between thousands, with a point for decimals")
    } else if is_date(cell) {
        format!(
            "`{shown}` is a date or a time of day; write seconds, or another unit, from a start of your choice, or dates like `2026-01-31 12:00:00` in \
             every row"
        )
    } else {
        format!("`{shown}` is not a number; correct it or remove the row")
    }
}
