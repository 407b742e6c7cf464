//! CSV as text: which mark parts its cells, and how they are read.

use std::path::Path;

use super::cell::number;
use super::dates::is_date;
use crate::DataError;

/// What parts cells, and those first that are nothing else within them.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// So many lines at the end tell the separator: titles may stand above the header.
const LAST: usize = 8;

/// The separator. Candidates are the marks in all of the last lines, or else those in the last one. The one that gives the largest share of
/// numbers among the cells of the last lines is taken, or else the first that any line has.
pub(super) fn separator(text: &str) -> u8 {
    let lines = || text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let last: Vec<&str> = lines().rev().take(LAST).collect();
    let is_in = |mark: &u8, line: &str| line.as_bytes().contains(mark);
    let numbers = |mark: u8| {
        let cells =
            || last.iter().flat_map(|line| line.split(char::from(mark))).map(|cell| cell.trim().trim_matches('"'));
        let is_number = |cell: &&str| number(cell, mark).is_ok() || is_date(cell);
        cells().filter(is_number).count() as f64 / cells().count() as f64
    };
    let in_first = |count: usize| -> Vec<u8> {
        SEPARATORS.into_iter().filter(|mark| last.iter().take(count).all(|line| is_in(mark, line))).collect()
    };
    let in_all = in_first(LAST);
    let there = if in_all.is_empty() { in_first(1) } else { in_all };
    let most = there.into_iter().map(|mark| (numbers(mark), mark)).filter(|(share, _)| *share > 0.0);
    let of_last = most.reduce(|best, other| if other.0 > best.0 { other } else { best }).map(|(_, mark)| mark);
    let of_first = || lines().find_map(|line| SEPARATORS.into_iter().find(|mark| is_in(mark, line)));
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
