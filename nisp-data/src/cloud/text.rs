//! Text clouds: CSV with columns x, y, z, or bare rows of three or more numbers; or either with two columns, of a plane.

use std::path::Path;

use crate::input::decode;
use crate::table::Points;
use crate::{DataError, Table};

/// The points of a text.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Points, DataError> {
    let text = decode(path, bytes)?;
    let mut rows = content(text).peekable();
    let first = rows.peek().map_or(Vec::new(), |(_, line)| cells(line));
    if first.iter().any(|cell| cell.parse::<f64>().is_err()) {
        return Table::parse(path, bytes)?.points();
    }
    let points: Result<_, _> = rows.map(|(number, line)| bare_row(path, number, &cells(line), first.len())).collect();
    Ok(Points { points: points?, is_in_metres: false, is_flat: first.len() == 2 })
}

/// Lines with something on them, numbered from one.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '/']))
}

/// The cells of a row: between semicolons, if it has some, or commas, or blanks.
fn cells(line: &str) -> Vec<&str> {
    match [';', ','].into_iter().find(|&mark| line.contains(mark)) {
        Some(mark) => line.split(mark).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    }
}

fn bare_row(path: &Path, number: usize, cells: &[&str], width: usize) -> Result<[f64; 3], DataError> {
    let fail = |what: String| Err(DataError::line(path, number, what));
    if cells.len() != width {
        return fail(format!("{} cells where the rows above have {width}; correct or remove this row", cells.len()));
    }
    let mut point = [0.0; 3];
    for (index, axis) in ["x", "y", "z"].into_iter().take(if width == 2 { 2 } else { 3 }).enumerate() {
        let Some(cell) = cells.get(index) else {
            return fail(format!("no number for {axis}; each row needs x, y and z"));
        };
        let Ok(value) = cell.parse() else {
            return fail(format!("`{cell:.24}` for {axis} is not a number; correct it or remove the row"));
        };
        point[index] = value;
    }
    Ok(point)
}
