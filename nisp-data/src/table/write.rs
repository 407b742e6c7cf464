//! Table to CSV: units in the headers, every number as short as it can be and still read back to the same bits.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Column, Table};
use crate::DataError;
use crate::atomic::write_atomic;

impl Table {
    /// An empty table, to be filled with [`Table::push`] and written.
    pub fn empty() -> Table {
        Table { path: PathBuf::new(), columns: Vec::new(), lines: Vec::new() }
    }

    /// Adds a column. Its header is `name [unit]`, or `name` for a plain number.
    pub fn push(&mut self, name: &str, unit: &str, values: &[f64]) -> Result<(), DataError> {
        if !self.columns.is_empty() && values.len() != self.rows() {
            let what = format!("column `{name}` has {} rows, the table {}", values.len(), self.rows());
            return Err(DataError::invalid(what));
        }
        let header = if matches!(unit, "" | "1") { name.to_string() } else { format!("{name} [{unit}]") };
        self.columns.push(Column { header, values: values.to_vec(), ..Column::default() });
        Ok(())
    }

    /// Writes the table as CSV, whole or not at all.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), DataError> {
        write_atomic(path.as_ref(), |out| self.write_to(out))
    }

    /// Writes the table as CSV into `out`.
    pub fn write_to(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(self.headers()).map_err(io::Error::other)?;
        for row in 0..self.rows() {
            let cells = self.columns.iter().map(|column| number(column.values[row]));
            writer.write_record(cells).map_err(io::Error::other)?;
        }
        writer.flush()
    }
}

/// The shortest text that reads back to the same number; powers of ten outside a readable range.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-4..1e15).contains(&size) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
