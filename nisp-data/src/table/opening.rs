//! Lines of a text that is still being written, and which of them tell how the others are read.

use std::collections::VecDeque;
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::heading::{Heading, MOST, is_row};
use super::separated::{reader, separator, syntax};
use crate::DataError;

/// Bytes of a line at most.
const LONGEST: usize = 1 << 20;
/// So many rows side by side with equally many cells end what is read before the first row is given.
const ALIKE: usize = 3;

/// The records of a text, line by line. Its first lines are read ahead: they tell what parts cells and where the header is.
pub(super) struct Records<R> {
    pub(super) path: PathBuf,
    lines: Lines<R>,
    /// Lines that were read and not yet given.
    waiting: VecDeque<(usize, String)>,
    pub(super) mark: u8,
    pub(super) heading: Heading,
}

impl<R: BufRead> Records<R> {
    /// Reads the first lines.
    ///
    /// # Errors
    /// What cannot be read, or is no text.
    pub(super) fn open(path: &Path, input: R) -> Result<Self, DataError> {
        let mut lines = Lines { input, number: 0, is_returned: false, has_ended: false };
        let (mut waiting, mut text) = (VecDeque::new(), String::new());
        while waiting.len() < MOST
            && let Some((number, line)) = lines.next(path).transpose()?
        {
            text += &line;
            text.push('\n');
            waiting.push_back((number, line));
            if shows_rows(&waiting, separator(&text)) {
                break;
            }
        }
        let mark = separator(&text);
        Ok(Self { path: path.into(), lines, waiting, mark, heading: Heading::of(&text, mark) })
    }

    /// The next record and its line; nothing at the end of the text. After an error the next one may be asked for.
    pub(super) fn next(&mut self) -> Option<Result<(usize, StringRecord), DataError>> {
        loop {
            let (number, line) = match self.waiting.pop_front() {
                Some(line) => line,
                None => match self.lines.next(&self.path)? {
                    Ok(line) => line,
                    Err(error) => return Some(Err(error)),
                },
            };
            match cells(&line, self.mark) {
                Ok(None) => {}
                Ok(Some(record)) => return Some(Ok((number, record))),
                Err(error) => return Some(Err(syntax(&self.path, &error))),
            }
        }
    }

    /// The records among the lines that were read ahead.
    pub(super) fn waiting(&self) -> impl Iterator<Item = (usize, StringRecord)> + '_ {
        self.waiting.iter().filter_map(|(number, line)| Some((*number, cells(line, self.mark).ok()??)))
    }
}

/// True if the last lines are rows of equally many cells.
fn shows_rows(lines: &VecDeque<(usize, String)>, mark: u8) -> bool {
    let last = lines.iter().rev().filter_map(|(_, line)| cells(line, mark).ok()?);
    let last: Vec<StringRecord> = last.take(ALIKE).collect();
    last.len() == ALIKE && last.iter().all(|record| is_row(record) && record.len() == last[0].len())
}

/// The cells of a line; nothing of one that is empty or a remark. Where a quotation mark is open the last cell has a line end in it.
fn cells(line: &str, mark: u8) -> Result<Option<StringRecord>, csv::Error> {
    if line.is_empty() || line.starts_with('#') {
        return Ok(None);
    }
    reader(mark).from_reader(format!("{line}\n.").as_bytes()).into_records().next().transpose()
}

/// The lines of a text, which may be written while it is read.
struct Lines<R> {
    input: R,
    /// Lines so far.
    number: usize,
    /// True if the last line ended with a carriage return, to which a line feed may belong.
    is_returned: bool,
    has_ended: bool,
}

impl<R: BufRead> Lines<R> {
    /// The next line, without its end, and its number; nothing at the end of the text.
    fn next(&mut self, path: &Path) -> Option<Result<(usize, String), DataError>> {
        let bytes = match self.bytes() {
            Ok(bytes) => bytes?,
            Err(source) => {
                self.has_ended = true;
                return Some(Err(DataError::reading(path, source)));
            }
        };
        self.number += 1;
        if bytes.len() > LONGEST {
            let what = format!("the line is longer than {} MiB; end each row with a line end", LONGEST >> 20);
            return Some(Err(DataError::line(path, self.number, what)));
        }
        let Ok(line) = String::from_utf8(bytes) else {
            return Some(Err(DataError::line(path, self.number, "not UTF-8 text; write it as UTF-8")));
        };
        let line = if self.number == 1 { line.trim_start_matches('\u{feff}').to_string() } else { line };
        Some(Ok((self.number, line)))
    }

    /// The bytes of the next line. Those beyond the longest that a line may have are passed over.
    fn bytes(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut line = Vec::new();
        while !self.has_ended {
            let bytes = match self.input.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                bytes => bytes?,
            };
            if bytes.is_empty() {
                self.has_ended = true;
                return Ok(Some(line).filter(|line| !line.is_empty()));
            }
            if std::mem::take(&mut self.is_returned) && bytes[0] == b'\n' {
                self.input.consume(1);
                continue;
            }
            let end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let until = end.unwrap_or(bytes.len());
            if line.len() <= LONGEST {
                line.extend_from_slice(&bytes[..until]);
            }
            self.is_returned = end.is_some_and(|at| bytes[at] == b'\r');
            self.input.consume(until + usize::from(end.is_some()));
            if end.is_some() {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }
}
