//! CSV to table. Accepts comment lines (`#`), a byte order mark, CRLF, and `;` or tabs as separators, decimal commas with them.

use std::path::Path;

use csv::StringRecord;

use super::dates::date;
use super::heading::Heading;
use super::{Column, Fault, Kind, Table};
use crate::DataError;
use crate::input::{MOST_BYTES, decode, read_bytes};

/// What parts cells, and those first that are nothing else within them.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// So many lines at the end tell the separator.
const LAST: usize = 3;

/// Fewer rows than this carry no equation of motion.
const MIN_ROWS: usize = 2;

/// What loggers and spreadsheets write where nothing was measured.
const NOT_MEASURED: [&str; 9] = ["na", "n/a", "n.a.", "#n/a", "null", "none", "missing", "-", "--"];

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
        columns.iter_mut().zip(&units).for_each(|(column, unit)| column.add_unit(unit));
        let mut lines = Vec::new();
        let mut place = Place { at: 0, line: 1 };
        for record in records {
            let record = record.map_err(|error| syntax(path, &error))?;
            let line = place.of_record(text, record.position().map_or(0, |at| at.byte() as usize));
            // Spreadsheets write rows of nothing but separators below their table.
            if record.iter().all(str::is_empty) {
                continue;
            }
            if record.len() != columns.len() {
                let instead = if lines.is_empty() || columns.len() == 1 {
                    format!(
                        "; if the line that begins with `{}` is a title, begin it with `#` or remove it",
                        &headers[0]
                    )
                } else {
                    "; fill or remove this row".into()
                };
                let what = format!("{} cells where the header has {}{instead}", record.len(), columns.len());
                return Err(DataError::line(path, line, what));
            }
            if record.iter().any(|cell| cell.contains(['\n', '\r'])) {
                // Rows below would be taken for one long remark.
                return Err(DataError::line(path, line, "a cell goes on in the next line; close its quotation mark"));
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
        columns.iter_mut().for_each(Column::doubt_thousands);
        Table { path: path.to_path_buf(), columns, lines }.with_rows_of_gauges()
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

/// How CSV with a separator is read.
pub(super) fn reader(separator: u8) -> csv::ReaderBuilder {
    let mut reader = csv::ReaderBuilder::new();
    reader.delimiter(separator).comment(Some(b'#')).flexible(true).has_headers(false).trim(csv::Trim::All);
    reader
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
        } else if self.dates.len() == self.values.len() {
            self.dates.extend(date(cell));
        }
        // The worst is what must be told.
        let worse = self.fault.as_ref().is_none_or(|fault| fault.kind < kind);
        if !value.is_finite() && worse {
            self.fault = Some(Fault { line, what: describe(cell), kind });
        }
        self.values.push(value);
    }

    /// A column whose numbers may be a thousand times larger is refused where it is asked for.
    fn doubt_thousands(&mut self) {
        if let (None, Some((line, what))) = (&self.fault, self.thousands.doubt()) {
            self.fault = Some(Fault { line, what, kind: Kind::Word });
        }
    }
}

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

fn describe(cell: &str) -> String {
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

/// The separator: what parts the last lines, since titles may stand above the header, or else the first line that has one.
pub(super) fn separator(text: &str) -> u8 {
    let lines = || text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let last: Vec<&str> = lines().rev().take(LAST).collect();
    let parts = |mark: &u8, line: &str| line.as_bytes().contains(mark);
    let of_last = SEPARATORS.into_iter().find(|mark| last.iter().all(|line| parts(mark, line)));
    let of_first = || lines().find_map(|line| SEPARATORS.into_iter().find(|mark| parts(mark, line)));
    of_last.or_else(of_first).unwrap_or(b',')
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

pub(super) fn syntax(path: &Path, error: &csv::Error) -> DataError {
    match error.position() {
        Some(at) => DataError::line(path, at.line() as usize, format!("not CSV: {error}")),
        None => DataError::file(path, format!("not CSV: {error}")),
    }
}
