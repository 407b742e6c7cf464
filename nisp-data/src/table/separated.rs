//! CSV as text: which mark parts its cells, and how they are read.

use std::path::Path;

use crate::DataError;

/// What parts cells, and those first that are nothing else within them.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// So many lines at the end tell the separator.
const LAST: usize = 3;

/// The separator: what parts the last lines, since titles may stand above the header, or else the first line that has one.
pub(super) fn separator(text: &str) -> u8 {
    let lines = || text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let last: Vec<&str> = lines().rev().take(LAST).collect();
    let parts = |mark: &u8, line: &str| line.as_bytes().contains(mark);
    let of_last = SEPARATORS.into_iter().find(|mark| last.iter().all(|line| parts(mark, line)));
    let of_first = || lines().find_map(|line| SEPARATORS.into_iter().find(|mark| parts(mark, line)));
    of_last.or_else(of_first).unwrap_or(b',')
}

/// How CSV with a separator is read.
pub(super) fn reader(separator: u8) -> csv::ReaderBuilder {
    let mut reader = csv::ReaderBuilder::new();
    reader.delimiter(separator).comment(Some(b'#')).flexible(true).has_headers(false).trim(csv::Trim::All);
    reader
}

pub(super) fn syntax(path: &Path, error: &csv::Error) -> DataError {
    match error.position() {
        Some(at) => DataError::line(path, at.line() as usize, format!("not CSV: {error}")),
        None => DataError::file(path, format!("not CSV: {error}")),
    }
}
