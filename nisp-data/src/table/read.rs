//! CSV to table. Accepts comment lines (`#`), a byte order mark, CRLF, and `;` or tabs as separators, decimal commas with them.

use std::path::Path;

use csv::StringRecord;

use super::cell::{describe, number};
use super::dates::{column_of_days, join_days};
use super::heading::Heading;
use super::separated::{reader, separator, syntax};
use super::thousands::Marks;
use super::{Column, Fault, Kind, Table};
use crate::DataError;
use crate::input::{MOST_BYTES, decode, read_bytes};

/// Fewer rows than this carry no equation of motion.
const MIN_ROWS: usize = 2;

impl Table {
    /// Reads a CSV file with one header line.
    ///
    /// A cell that is no finite number is reported when its column is asked for, so that a column of remarks does no
    /// harm.
    pub fn read(path: impl AsRef<Path>) -> Result<Table, DataError> {
        let path = path.as_ref();
        Table::parse(path, &read_bytes(path, MOST_BYTES)?)
    }

    /// As [`Table::read`], for a table of which one row is enough: of places, or of values beside equations that hold elsewhere too.
    pub fn read_places(path: impl AsRef<Path>) -> Result<Table, DataError> {
        let path = path.as_ref();
        Table::parse_rows(path, &read_bytes(path, MOST_BYTES)?, 1)
    }

    /// Reads CSV from memory; `path` is only used to name the source in errors.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Table, DataError> {
        Table::parse_rows(path, bytes, MIN_ROWS)
    }

    /// Reads CSV with so many rows at least.
    fn parse_rows(path: &Path, bytes: &[u8], least: usize) -> Result<Table, DataError> {
        let text = decode(path, bytes)?;
        if text.trim().is_empty() {
            return Err(DataError::file(path, "the file is empty; a header line and rows of numbers are needed"));
        }
        let mark = separator(text);
        let heading = Heading::of(text, mark);
        let mut records = reader(mark).from_reader(text.as_bytes()).into_records().skip(heading.titles);
        let mut next = || Ok(records.next().transpose().map_err(|error| syntax(path, &error))?.unwrap_or_default());
        let (headers, units) = (next()?, if heading.has_units { next()? } else { StringRecord::new() });
        let mut columns = check_headers(path, &headers)?;
        let mut place = Place { at: 0, line: 1 };
        let mut line_of =
            |record: &StringRecord| place.of_record(text, record.position().map_or(0, |at| at.byte() as usize));
        let below = line_of(&units);
        columns.iter_mut().zip(&units).for_each(|(column, unit)| column.add_unit(below, unit));
        let is_parted = headers.iter().any(|header| header.contains('(') && !header.contains(')'));
        let title = match is_parted {
            true => "put a header with a comma in it into quotation marks, as in `\"T(x=0.1 m, y=0.2 m) [K]\"`".into(),
            false => {
                format!("if the line that begins with `{}` is a title, begin it with `#` or remove it", &headers[0])
            }
        };
        let mut lines = Vec::new();
        for record in records {
            let record = record.map_err(|error| syntax(path, &error))?;
            let line = line_of(&record);
            // Spreadsheets write rows of nothing but separators below their table.
            if record.iter().all(str::is_empty) {
                continue;
            }
            let instead = if lines.is_empty() || columns.len() == 1 { &title } else { "fill or remove this row" };
            if let Some(what) = unlike(&record, columns.len(), instead) {
                return Err(DataError::line(path, line, what));
            }
            for (column, cell) in columns.iter_mut().zip(&record) {
                column.push(line, cell, mark);
            }
            lines.push(line);
        }
        if lines.len() < least {
            let are = if least == 1 { "is" } else { "are" };
            let what = format!("{} row(s) of data below the header; at least {least} {are} needed", lines.len());
            return Err(DataError::file(path, what));
        }
        doubt_thousands(&mut columns);
        columns.iter_mut().for_each(Column::choose_days);
        if let Some(of_days) = column_of_days(&columns) {
            join_days(&mut columns, of_days);
        }
        Ok(Table { path: path.to_path_buf(), columns, lines })
    }
}

/// A place in a text and its line. Readers count the line of a record from the end of the one before, which may come before the
/// end of its line.
struct Place {
    at: usize,
    line: usize,
}

impl Place {
    /// The line of the record that begins at a byte or after line ends and remarks there. Records are asked for in their order.
    fn of_record(&mut self, text: &str, begin: usize) -> usize {
        let bytes = text.as_bytes();
        let mut first = begin;
        while let Some(byte @ (b'\r' | b'\n' | b'#')) = bytes.get(first) {
            let rest = &bytes[first..];
            first += if *byte == b'#' { rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len()) } else { 1 };
        }
        self.line += bytes[self.at..first].iter().filter(|byte| **byte == b'\n').count();
        self.at = first;
        self.line
    }
}

impl Column {
    /// Adds a cell of a table with a separator.
    pub(super) fn push(&mut self, line: usize, cell: &str, mark: u8) {
        let parsed = number(cell, mark);
        let kind = match parsed {
            _ if cell.is_empty() => Kind::Empty,
            Ok(value) if value.is_nan() => Kind::NotANumber,
            Ok(_) => Kind::Infinite,
            Err(_) => Kind::Word,
        };
        let value = parsed.unwrap_or(f64::NAN);
        if value.is_finite() {
            self.thousands.see(line, cell, value);
        } else {
            self.see_date(cell);
        }
        // The worst is what must be told.
        let worse = self.fault.as_ref().is_none_or(|fault| fault.kind < kind);
        if !value.is_finite() && worse {
            self.fault = Some(Fault { line, what: describe(cell), kind });
        }
        self.values.push(value);
    }
}

/// Columns whose numbers may be a thousand times larger are refused where they are asked for.
pub(super) fn doubt_thousands(columns: &mut [Column]) {
    let marks = Marks::of(columns.iter().map(|column| &column.thousands));
    for column in columns {
        if let (None, Some((line, what))) = (&column.fault, column.thousands.doubt(&marks)) {
            column.fault = Some(Fault { line, what, kind: Kind::Word });
        }
    }
}

/// What is wrong with a row as a whole, and what to do where it has too few cells or too many.
pub(super) fn unlike(record: &StringRecord, columns: usize, instead: &str) -> Option<String> {
    // Rows below would be taken for one long remark.
    if record.iter().any(|cell| cell.contains(['\n', '\r'])) {
        return Some("a cell goes on in the next line; close its quotation mark".into());
    }
    (record.len() != columns).then(|| format!("{} cells where the header has {columns}; {instead}", record.len()))
}

pub(super) fn check_headers(path: &Path, headers: &StringRecord) -> Result<Vec<Column>, DataError> {
    if headers.is_empty() {
        return Err(DataError::file(path, "only comments; a header line and rows of numbers are needed"));
    }
    if headers.iter().all(|header| header.parse::<f64>().is_ok()) {
        let what = "the first line holds numbers; put a line of column names above it, for instance `t [s],q [m]`";
        return Err(DataError::file(path, what));
    }
    Ok(headers.iter().map(|header| Column { header: header.to_string(), ..Column::default() }).collect())
}
