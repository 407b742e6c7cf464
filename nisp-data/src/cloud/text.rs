//! Text clouds: CSV with columns for the components of a point, or bare rows of them.

use std::path::Path;

use crate::components::Components;
use crate::input::decode;
use crate::{DataError, Table};

/// The points, and true where headers say their unit, which makes metres of them.
pub(super) fn parse(path: &Path, bytes: &[u8], components: Components<'_>) -> Result<(Vec<[f64; 3]>, bool), DataError> {
    let text = decode(path, bytes)?;
    let mut rows = content(text).peekable();
    let first = rows.peek().map_or(Vec::new(), |(_, line)| cells(line));
    if first.iter().any(|cell| cell.parse::<f64>().is_err()) {
        return Table::parse(path, bytes)?.points(components);
    }
    if components.count() != 3 {
        components.refuse_width(path, first.len())?;
    }
    let row = |(number, line)| bare_row(path, number, (&cells(line), first.len()), components);
    let points: Result<_, _> = rows.map(row).collect();
    Ok((points?, false))
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

fn bare_row(
    path: &Path,
    number: usize,
    (cells, width): (&[&str], usize),
    components: Components<'_>,
) -> Result<[f64; 3], DataError> {
    let fail = |what: String| Err(DataError::line(path, number, what));
    if cells.len() != width {
        return fail(format!("{} cells where the rows above have {width}; correct or remove this row", cells.len()));
    }
    let mut point = [0.0; 3];
    for (index, axis) in components.names().enumerate() {
        let Some(cell) = cells.get(index) else {
            return fail(format!("no number for {axis}; each row needs {}", components.said()));
        };
        let Ok(value) = cell.parse() else {
            return fail(format!("`{cell:.24}` for {axis} is not a number; correct it or remove the row"));
        };
        point[index] = value;
    }
    Ok(point)
}
