//! CSV that comes row by row, as from a pipe: every row is a table of its own.

use std::io::BufRead;
use std::path::Path;
use std::time::SystemTime;

use super::Table;
use csv::StringRecord;

use super::dates::{Order, column_of_days, is_date, join_days};
use super::opening::Records;
use super::read::{check_headers, doubt_thousands, unlike};
use crate::DataError;

/// What becomes of a row that is none.
const LEFT_OUT: &str = "the row is left out";

/// Rows of a CSV that is still being written, with all that tables in files may have: titles above the header, a line of units below
/// it, remarks, dates. What a file tells as a whole the first rows tell: what parts cells, where the header is, and in which order days
/// are written. Dates are counted from those of the first row.
pub struct Rows<R> {
    records: Records<R>,
    /// The first rows with their dates alone.
    first: Table,
    row: Table,
    /// In which order each column writes days.
    orders: Vec<Order>,
    /// The column of days to which times of day belong.
    of_days: Option<usize>,
    /// From when dates are counted.
    begin: Option<SystemTime>,
}

impl<R: BufRead> Rows<R> {
    /// Reads the header and the first rows; `path` is only used to name the source in errors.
    ///
    /// # Errors
    /// No header line, or none that can be one, and what is no text.
    pub fn read(path: &Path, input: R) -> Result<Self, DataError> {
        let mut records = Records::open(path, input)?;
        let heading = records.heading;
        let none = || DataError::file(path, "it ended before its header line, for instance `t [s],q [m]`");
        for _ in 0..heading.titles {
            records.next().transpose()?;
        }
        let (line, header) = records.next().transpose()?.ok_or_else(none)?;
        let mut columns = check_headers(path, &header)?;
        if heading.has_units
            && let Some((line, units)) = records.next().transpose()?
        {
            columns.iter_mut().zip(&units).for_each(|(column, unit)| column.add_unit(line, unit));
        }
        let row = Table { path: path.into(), columns, lines: vec![line] };
        let (mut first, orders, of_days) = first_rows(row.clone(), &records);
        let begin = first.begins();
        begin.into_iter().for_each(|begin| first.count_from(begin));
        Ok(Self { records, first, row, orders, of_days, begin })
    }

    /// The table of the first rows, of whose cells only dates are known.
    pub fn first(&self) -> &Table {
        &self.first
    }

    /// From when dates are counted, if there are any.
    pub fn begin(&self) -> Option<SystemTime> {
        self.begin
    }

    /// Waits for the next row; nothing at the end. After an error the next row may be asked for.
    pub fn next_row(&mut self) -> Option<Result<&Table, DataError>> {
        let (line, record) = loop {
            match self.records.next()? {
                // Spreadsheets write rows of nothing but separators below their table.
                Ok((_, record)) if record.iter().all(str::is_empty) => {}
                Ok(row) => break row,
                Err(error) => return Some(Err(error)),
            }
        };
        let Table { path, columns, lines } = &mut self.row;
        if let Some(what) = unlike(&record, columns.len(), LEFT_OUT) {
            return Some(Err(DataError::line(path, line, what)));
        }
        lines[0] = line;
        for ((column, cell), order) in columns.iter_mut().zip(&record).zip(&self.orders) {
            column.fault = None;
            column.values.clear();
            column.dates.clear();
            column.push(line, cell, self.records.mark);
            column.read_days(*order);
        }
        doubt_thousands(columns);
        if let Some(of_days) = self.of_days {
            join_days(columns, of_days);
        }
        self.begin = self.begin.or_else(|| self.row.begins());
        if let Some(begin) = self.begin {
            self.row.count_from(begin);
        }
        Some(Ok(&self.row))
    }
}

/// A table of the rows that were read ahead, in which order each of its columns writes days, and which one holds days for times beside it.
/// Of its cells only dates are kept: what is wrong with a row is told when it comes.
fn first_rows<R: BufRead>(mut table: Table, records: &Records<R>) -> (Table, Vec<Order>, Option<usize>) {
    let is_row = |record: &StringRecord| {
        !record.iter().all(str::is_empty) && unlike(record, table.columns.len(), LEFT_OUT).is_none()
    };
    let rows: Vec<_> = records.waiting().filter(|(_, record)| is_row(record)).collect();
    table.lines = rows.iter().map(|(line, _)| *line).collect();
    let mut orders = Vec::new();
    for (at, column) in table.columns.iter_mut().enumerate() {
        let of_header = column.fault.clone();
        // A day that is not there says nothing of the others.
        let has_dates = rows.iter().any(|(_, record)| is_date(&record[at]));
        let cells = rows.iter().map(|(line, record)| (*line, &record[at]));
        cells.filter(|(_, cell)| !has_dates || is_date(cell)).for_each(|(line, cell)| {
            column.push(line, cell, records.mark);
        });
        column.values.fill(f64::NAN);
        let order = column.order();
        orders.push(order.unwrap_or(Order::DayFirst));
        match order {
            Some(order) => {
                column.read_days(order);
                column.fault = of_header;
            }
            None => column.choose_days(),
        }
    }
    let of_days = column_of_days(&table.columns);
    of_days.into_iter().for_each(|at| join_days(&mut table.columns, at));
    (table, orders, of_days)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_one_by_one_and_a_bad_one_does_not_end_them() {
        let text = "# a remark\nt_s;q [mm]\n0;1,0\n1;\n\n2;3;4\n3;x\n4;\"5\n5;6\n";
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let mut read = || {
            let row = rows.next_row()?;
            Some(row.and_then(|row| Ok((row.quantity("t", "s")?[0], row.measured("q", "m")?[0]))))
        };
        assert_eq!(read().unwrap().unwrap(), (0.0, 1e-3));
        let (t, q) = read().unwrap().unwrap();
        assert!(t == 1.0 && q.is_nan());
        let mut wrong = |words: &str| {
            let message = read().unwrap().unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        };
        wrong("line 6: 3 cells where the header has 2");
        wrong("line 7, column `q [mm]`: `x` is not a number");
        wrong("line 8: a cell goes on in the next line");
        assert_eq!(read().unwrap().unwrap(), (5.0, 6e-3));
        assert!(read().is_none());
    }

    /// A text that comes byte by byte, of which it is known how much was read.
    struct Drops<'a> {
        text: &'a [u8],
        read: &'a std::cell::Cell<usize>,
    }

    impl std::io::Read for Drops<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let at = self.read.get();
            let count = self.text[at..].len().min(into.len()).min(1);
            into[..count].copy_from_slice(&self.text[at..at + count]);
            self.read.set(at + count);
            Ok(count)
        }
    }

    #[test]
    fn what_files_may_have_streams_may_have_and_no_row_waits_for_later_ones() {
        let text =
            "Logger 7\r\nRun,of today\r\n\r\nt,T\r\nms,degC\r\n# begun\r\n0,20\r\n10,21\r\n20,n/a\r\n30,x\r\n40,22";
        let read = std::cell::Cell::new(0);
        let drops = Drops { text: text.as_bytes(), read: &read };
        let mut rows = Rows::read(Path::new("pipe"), std::io::BufReader::new(drops)).unwrap();
        // The first row is there when three are: a carriage return ends its line.
        assert_eq!(read.get(), text.find("\n30").unwrap());
        let mut next = |t: f64, kelvins: f64| {
            let row = rows.next_row().unwrap().unwrap();
            assert_eq!(row.quantity("t", "s").unwrap(), [t]);
            assert_eq!(row.measured("T", "K").unwrap()[0].to_bits(), kelvins.to_bits());
        };
        next(0.0, 293.15);
        next(0.01, 294.15);
        next(0.02, f64::NAN);
        let wrong = rows.next_row().unwrap().unwrap().measured("T", "K").unwrap_err().to_string();
        assert!(wrong.contains("line 10, column"), "{wrong}");
        assert_eq!(rows.next_row().unwrap().unwrap().measured("T", "K").unwrap(), [295.15]);
        assert!(rows.next_row().is_none());
    }

    #[test]
    fn dates_are_counted_from_the_first_row() {
        let text = "time,q\n2026-02-28 23:59:59.5,1\n2026-03-01 00:00:01.500,2\n";
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let mut read = || rows.next_row().unwrap().unwrap().chosen("t", "time", "ms").unwrap()[0];
        assert_eq!([read(), read()], [0.0, 2000.0]);
    }

    /// The first rows tell what comes first in a day, and no later row is read otherwise.
    #[test]
    fn days_are_read_in_one_order_and_joined_with_the_times_beside_them() {
        let text = "day,clock,q\n1/31/2026,11:59:58 PM,1\n1/31/2026,11:59:59 PM,2\n2/1/2026,12:00:01 AM,3\n2/2/2026,12:00:01 AM,4\n";
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let mut read = || rows.next_row().unwrap().unwrap().chosen("t", "clock", "s").unwrap()[0];
        assert_eq!([read(), read(), read(), read()], [0.0, 1.0, 3.0, 86_403.0]);
        let either = "day,q\n1/2/2026,1\n1/3/2026,2\n1/4/2026,3\n1/31/2026,4\n";
        let rows = Rows::read(Path::new("pipe"), either.as_bytes()).unwrap();
        let refused = rows.first().chosen("t", "day", "s").unwrap_err().to_string();
        assert!(refused.contains("line 2") && refused.contains("write them like `2026-01-31`"), "{refused}");
        // Rows of separators, and days that are not there, do not hide the order that others tell.
        let gaps = "day,clock,q\n1/2/2026,11:00,1\n,,\n,12:00,2\n1/31/2026,11:00,3\n2/1/2026,11:00,4\n";
        let mut rows = Rows::read(Path::new("pipe"), gaps.as_bytes()).unwrap();
        let mut read = || rows.next_row().unwrap().unwrap().chosen("t", "clock", "s").map(|t| t[0]);
        assert_eq!(read().unwrap(), 0.0);
        let missing = read().unwrap_err().to_string();
        assert!(missing.contains("line 4"), "{missing}");
        assert_eq!([read().unwrap(), read().unwrap()], [29.0 * 86_400.0, 30.0 * 86_400.0]);
    }

    #[test]
    fn marks_of_thousands_are_doubted_once_they_are_seen() {
        let mut rows = Rows::read(Path::new("pipe"), "t;n\n0;998\n1;999\n2;1.001\n".as_bytes()).unwrap();
        let mut read = || rows.next_row().unwrap().unwrap().quantity("n", "1").map(|n| n[0]);
        assert_eq!((read().unwrap(), read().unwrap()), (998.0, 999.0));
        assert!(read().unwrap_err().to_string().contains("parts thousands"));
    }

    #[test]
    fn a_stream_without_a_header_says_what_it_lacks() {
        assert!(Rows::read(Path::new("pipe"), "".as_bytes()).is_err());
        assert!(Rows::read(Path::new("pipe"), "0,1\n".as_bytes()).is_err());
    }

    #[test]
    fn a_line_without_end_is_bounded() {
        let text = format!("t,q\n0,1\n1,2\n2,3\n{}\n3,4\n", "9".repeat(3 << 20));
        let mut rows = Rows::read(Path::new("pipe"), text.as_bytes()).unwrap();
        let last = std::iter::from_fn(|| Some(rows.next_row()?.map(|row| row.column("q").unwrap()[0])));
        let told: Vec<String> = last.map(|row| row.map_or_else(|e| e.to_string(), |q| q.to_string())).collect();
        assert_eq!(told.len(), 5);
        assert!(told[3].contains("line 5: the line is longer"), "{}", told[3]);
        assert_eq!(told[4], "4");
    }
}
