//! CSV that comes row by row, as from a pipe: every row is a table of its own.

use std::io::BufRead;
use std::path::Path;
use std::time::SystemTime;

use super::Table;
use super::read::check_headers;
use super::separated::{reader, separator, syntax};
use crate::DataError;

/// Rows of a CSV that is still being written. Dates in them are counted from those of the first row.
pub struct Rows<R> {
    records: csv::Reader<R>,
    record: csv::StringRecord,
    row: Table,
    separator: u8,
    /// From when dates are counted.
    begin: Option<SystemTime>,
}

impl<R: BufRead> Rows<R> {
    /// Reads the header line; `path` is only used to name the source in errors.
    ///
    /// # Errors
    /// No header line, or none that can be one.
    pub fn read(path: &Path, mut input: R) -> Result<Self, DataError> {
        let mut header = String::new();
        while header.trim().is_empty() || header.starts_with('#') {
            header.clear();
            let read = input.read_line(&mut header);
            match read.map_err(|error| DataError::file(path, error.to_string()))? {
                0 => return Err(DataError::file(path, "it ended before its header line, for instance `t [s],q [m]`")),
                _ => header = header.trim_start_matches('\u{feff}').to_string(),
            }
        }
        let mark = separator(&header);
        let mut first = csv::StringRecord::new();
        let mut line = reader(mark).has_headers(false).from_reader(header.as_bytes());
        line.read_record(&mut first).map_err(|error| syntax(path, &error))?;
        let columns = check_headers(path, &first)?;
        let records = reader(mark).has_headers(false).from_reader(input);
        Ok(Self {
            records,
            record: csv::StringRecord::new(),
            row: Table { path: path.into(), columns, lines: vec![0] },
            separator: mark,
            begin: None,
        })
    }

    /// The table of the header alone.
    pub fn header(&self) -> &Table {
        &self.row
    }

    /// Waits for the next row; nothing at the end. After an error the next row may be asked for.
    pub fn next_row(&mut self) -> Option<Result<&Table, DataError>> {
        match self.records.read_record(&mut self.record) {
            Ok(false) => return None,
            Ok(true) => {}
            Err(error) => return Some(Err(syntax(&self.row.path, &error))),
        }
        // The header's line comes first.
        let line = self.record.position().map_or(0, |at| at.line() as usize + 1);
        let Table { path, columns, lines } = &mut self.row;
        if self.record.len() != columns.len() {
            let what = format!("{} cells where the header has {}", self.record.len(), columns.len());
            return Some(Err(DataError::line(path, line, what)));
        }
        lines[0] = line;
        for (column, cell) in columns.iter_mut().zip(&self.record) {
            column.values.clear();
            column.fault = None;
            column.dates.clear();
            column.push(line, cell, self.separator);
            column.choose_days();
        }
        self.begin = self.begin.or_else(|| self.row.begins());
        if let Some(begin) = self.begin {
            self.row.count_from(begin);
        }
        Some(Ok(&self.row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_one_by_one_and_a_bad_one_does_not_end_them() {
        let text = "# a remark\nt_s;q [mm]\n0;1,0\n1;\n\n2;3;4\n3;x\n4;5\n";
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let mut read = || {
            let row = rows.next_row()?;
            Some(row.and_then(|row| Ok((row.quantity("t", "s")?[0], row.measured("q", "m")?[0]))))
        };
        assert_eq!(read().unwrap().unwrap(), (0.0, 1e-3));
        let (t, q) = read().unwrap().unwrap();
        assert!(t == 1.0 && q.is_nan());
        assert!(read().unwrap().unwrap_err().to_string().contains("3 cells where the header has 2"));
        assert!(read().unwrap().unwrap_err().to_string().contains("`x` is not a number"));
        assert_eq!(read().unwrap().unwrap(), (4.0, 5e-3));
        assert!(read().is_none());
    }

    #[test]
    fn dates_are_counted_from_the_first_row() {
        let text = "time,q\n2026-02-28 23:59:59.5,1\n2026-03-01 00:00:01.500,2\n";
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let mut read = || rows.next_row().unwrap().unwrap().chosen("t", "time", "ms").unwrap()[0];
        assert_eq!([read(), read()], [0.0, 2000.0]);
    }

    #[test]
    fn a_stream_without_a_header_says_what_it_lacks() {
        assert!(Rows::read(Path::new("pipe"), "".as_bytes()).is_err());
        assert!(Rows::read(Path::new("pipe"), "0,1\n".as_bytes()).is_err());
    }
}
