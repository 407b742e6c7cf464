//! What stands above the rows of a table: titles, the header, and a line of units.

use std::collections::BTreeMap;

use csv::StringRecord;
use nisp_units::is_unit;

use super::cell::number;
use super::dates::is_date;
use super::headers::{bracketed, claimed};
use super::separated::reader;
use super::{Column, Fault, Kind};

/// Lines that are searched for the first row, at most.
pub(super) const MOST: usize = 512;

/// Where the header of a table is.
#[derive(Clone, Copy, Default)]
pub(super) struct Heading {
    /// How many lines stand above the header.
    pub(super) titles: usize,
    /// True if the line below the header says units.
    pub(super) has_units: bool,
}

impl Heading {
    /// Looks for the first row of numbers with as many cells as most of them have: the header is the line above it, or the one above
    /// that if the units of its columns stand between.
    pub(super) fn of(text: &str, mark: u8) -> Self {
        let records = reader(mark).from_reader(text.as_bytes()).into_records();
        let lines: Vec<StringRecord> = records.map_while(Result::ok).take(MOST).collect();
        let mut counts = BTreeMap::new();
        for line in lines.iter().filter(|line| is_row(line)) {
            *counts.entry(line.len()).or_insert(0) += 1;
        }
        let Some((width, _)) = counts.into_iter().max_by_key(|(width, count)| (*count, *width)) else {
            return Self::default();
        };
        let row = (1..lines.len()).find(|at| lines[*at].len() == width && is_row(&lines[*at]));
        // Without any the first line is the header, and what is wrong with the others is told.
        let Some(row) = row.filter(|row| lines[row - 1].len() == width) else { return Self::default() };
        if row > 1 && are_units(&lines[row - 2], &lines[row - 1]) {
            return Self { titles: row - 2, has_units: true };
        }
        // Titles may have as many words, and rows of words may stand between. The header is the last line of which most cells say a
        // unit, or else the last line of words.
        let is_header = |at: &usize| {
            let mut cells = lines[*at].iter().filter(|cell| !cell.is_empty()).peekable();
            lines[*at].len() == width && cells.peek().is_some() && cells.all(is_word)
        };
        let says_units = |at: &usize| {
            let own = lines[*at].iter().filter(|cell| claimed(cell).is_some_and(is_unit));
            2 * own.count() > width
        };
        let candidates = || (0..row).rev().filter(is_header);
        let header = candidates().find(says_units).or_else(|| candidates().next());
        Self { titles: header.unwrap_or(row - 1), has_units: false }
    }
}

impl Column {
    /// Says the unit of a column, if there is one, as its header may. A column of two units is refused where it is asked for.
    pub(super) fn add_unit(&mut self, line: usize, unit: &str) {
        if !is_word(unit) {
            return;
        }
        let unit = bracketed(unit).unwrap_or(unit);
        let behind = self.header.rsplit_once('_').map(|(_, own)| own).filter(|own| *own == unit);
        match claimed(&self.header).or(behind) {
            None => self.header = format!("{} [{unit}]", self.header),
            Some(own) if own == unit => {}
            Some(own) => {
                let what = format!("its header says {own}, and the line below {unit}; correct one of them");
                self.fault = Some(Fault { line, what, kind: Kind::Word });
            }
        }
    }
}

/// True of cells without words, or that begin with none and hold a number, or are more numbers than words.
pub(super) fn is_row(line: &StringRecord) -> bool {
    let words = line.iter().filter(|cell| is_word(cell)).count();
    let numbers = line.iter().filter(|cell| is_number(cell)).count();
    let is_empty = line.iter().all(str::is_empty);
    words == 0 && !is_empty || numbers > words || numbers > 0 && !line.iter().next().is_some_and(is_word)
}

/// True of a number or a date.
fn is_number(cell: &str) -> bool {
    number(cell, b';').is_ok_and(f64::is_finite) || is_date(cell)
}

/// True of a cell that is no number, no date, and not empty.
fn is_word(cell: &str) -> bool {
    !cell.is_empty() && number(cell, b';').is_err() && !is_date(cell)
}

/// True if the line below a header says the units of its columns: it holds no number, and every word in it is a unit, or at least half of
/// them are and all of them stand below words.
fn are_units(header: &StringRecord, below: &StringRecord) -> bool {
    let words = || header.iter().zip(below).filter(|(_, cell)| is_word(cell));
    let units = words().filter(|(_, word)| is_unit(bracketed(word).unwrap_or(word))).count();
    let are_below_words = || words().all(|(above, _)| is_word(above));
    below.len() == header.len()
        && units > 0
        && !below.iter().any(is_number)
        && (units == words().count() || 2 * units >= words().count() && are_below_words())
}
