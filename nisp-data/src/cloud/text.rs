//! Text clouds: CSV with columns x, y, z, or bare rows of three or more numbers.

use std::path::Path;

use crate::{DataError, Table};

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| DataError::NotUtf8 { path: path.to_path_buf(), byte: error.valid_up_to() })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = content(text).peekable();
    let bare = rows.peek().is_none_or(|(_, line)| words(line).all(|word| word.parse::<f64>().is_ok()));
    if bare { rows.map(|(number, line)| bare_row(path, number, line)).collect() } else { table(path, bytes) }
}

fn table(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let table = Table::parse(path, bytes)?;
    let [x, y, z] = [table.raw("x")?, table.raw("y")?, table.raw("z")?];
    Ok((0..table.rows()).map(|row| [x[row], y[row], z[row]]).collect())
}

/// Lines with something on them, numbered from one.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '/']))
}

fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty())
}

fn bare_row(path: &Path, number: usize, line: &str) -> Result<[f64; 3], DataError> {
    let mut row = words(line);
    let mut point = [0.0; 3];
    for (value, axis) in point.iter_mut().zip(["x", "y", "z"]) {
        let Some(word) = row.next() else {
            return Err(DataError::line(path, number, format!("no number for {axis}; each row needs x, y and z")));
        };
        let what = || format!("`{word}` for {axis} is not a number; correct it or remove the row");
        *value = word.parse().map_err(|_| DataError::line(path, number, what()))?;
    }
    Ok(point)
}
