//! Tables of measurements: CSV in, CSV out, columns found by name and unit.

mod cell;
mod dates;
mod headers;
mod heading;
mod lookup;
mod opening;
mod points;
mod read;
mod rows;
mod separated;
mod thousands;
mod wide;
mod write;

pub use dates::moment;
pub use rows::Rows;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::DataError;
use thousands::Thousands;

/// Columns of numbers with one header each, all of the same length.
#[derive(Debug, Clone)]
pub struct Table {
    path: PathBuf,
    columns: Vec<Column>,
    /// The line of the file that each row came from.
    lines: Vec<usize>,
}

/// One column of a table.
#[derive(Debug, Clone, Default)]
struct Column {
    header: String,
    values: Vec<f64>,
    /// The first cell that is no finite number. It only matters where this column is asked for.
    fault: Option<Fault>,
    thousands: Thousands,
    /// What the cells say where every one so far is a date or a time of day, days parted by slashes with the day of the month first.
    dates: Vec<SystemTime>,
    /// The same with the month first, until all cells have been seen.
    month_first: Vec<SystemTime>,
}

#[derive(Debug, Clone)]
struct Fault {
    line: usize,
    what: String,
    kind: Kind,
}

/// What stands in a cell that is no finite number, from the least harm to the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Not measured: `nan`, which a cloud may hold too.
    NotANumber,
    /// Not measured: nothing.
    Empty,
    /// A cloud may hold it.
    Infinite,
    Word,
}

impl Table {
    /// The file this was read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// All headers, in file order.
    pub fn headers(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.header.as_str())
    }

    /// Checks that a column rises strictly, as a time must.
    pub fn require_increasing(&self, name: &str) -> Result<(), DataError> {
        let values = self.column(name)?;
        let Some(row) = values.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
        let column = self.find(name, None)?;
        let shown = |row: usize| match column.dates.get(row).filter(|_| column.is_dated()) {
            Some(at) => moment(*at),
            None => values[row].to_string(),
        };
        let (before, after) = (shown(row), shown(row + 1));
        let again = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let what = if values[row] == values[row + 1] && again > values.len() / 10 {
            format!(
                "the value {after} is there twice, as are {again} of {}: they were rounded; give them with more digits",
                values.len()
            )
        } else if values[row] == values[row + 1] {
            format!("the value {after} is there twice; keep one row for each value")
        } else {
            format!("{after} comes after {before}; sort the rows by this column")
        };
        let column = column.header.clone();
        let line = self.lines.get(row + 1).copied().unwrap_or(row + 2);
        Err(DataError::Cell { path: self.path.clone(), line, column, what })
    }
}
