//! Columns of dates and times of day, as loggers write them: they become seconds once it is said from when to count.

use std::time::{Duration, SystemTime};

use nisp_units::{Conversion, conversion};

use super::{Column, Fault, Kind, Table};

impl Table {
    /// The earliest first cell of its columns of dates, or else of times of day; none where no column holds any.
    pub fn begins(&self) -> Option<SystemTime> {
        let firsts = || self.columns.iter().filter(|column| column.is_dated()).map(|column| column.dates[0]);
        firsts().filter(|first| !is_of_day(*first)).min().or_else(|| firsts().min())
    }

    /// True if the column that answers to a name holds dates or times of day.
    pub fn is_dated(&self, name: &str) -> bool {
        self.find(name, None).is_ok_and(Column::is_dated)
    }

    /// Makes its columns of dates columns of seconds since a moment. Until then they are no numbers. Times of day stay none where the
    /// moment has a date.
    pub fn count_from(&mut self, begin: SystemTime) {
        let is_alike = |column: &Column| is_of_day(begin) || !is_of_day(column.dates[0]);
        for column in self.columns.iter_mut().filter(|column| column.is_dated() && is_alike(column)) {
            column.values = column.dates.iter().map(|date| seconds(begin, *date)).collect();
            column.fault = None;
        }
    }
}

impl Column {
    /// True if every cell is a date or a time of day.
    pub(super) fn is_dated(&self) -> bool {
        !self.dates.is_empty() && self.dates.len() == self.values.len()
    }

    /// Takes a date, as long as all cells before are some.
    pub(super) fn see_date(&mut self, cell: &str) {
        for (dates, order) in [(&mut self.dates, Order::DayFirst), (&mut self.month_first, Order::MonthFirst)] {
            if dates.len() == self.values.len() {
                dates.extend(date(cell, order));
            }
        }
    }

    /// In which order days parted by slashes are written, once all cells are seen: the one that alone makes them all dates. Nothing where
    /// both do, and they are other dates.
    pub(super) fn order(&self) -> Option<Order> {
        let is_whole = |dates: &[SystemTime]| !dates.is_empty() && dates.len() == self.values.len();
        match (is_whole(&self.dates), is_whole(&self.month_first)) {
            (true, true) if self.dates != self.month_first => None,
            (false, true) => Some(Order::MonthFirst),
            _ => Some(Order::DayFirst),
        }
    }

    /// Reads days in an order.
    pub(super) fn read_days(&mut self, order: Order) {
        let month_first = std::mem::take(&mut self.month_first);
        if order == Order::MonthFirst {
            self.dates = month_first;
        }
    }

    /// Reads days in the order that they are written in. Tables of one problem may not be read in different orders, so that days that
    /// may be either are refused.
    pub(super) fn choose_days(&mut self) {
        let order = self.order();
        self.read_days(order.unwrap_or(Order::DayFirst));
        if order.is_none() {
            let what =
                "its days may have the day of the month first, or the month; write them like `2026-01-31`".into();
            let line = self.fault.as_ref().map_or(0, |fault| fault.line);
            (self.dates, self.fault) = (Vec::new(), Some(Fault { line, what, kind: Kind::Word }));
        }
    }

    /// How its numbers become numbers in a unit where they are seconds since a moment.
    pub(super) fn dated(&self, unit: &str) -> Option<Conversion> {
        conversion("s", unit).filter(|_| self.is_dated())
    }
}

/// The only column that holds days alone.
pub(super) fn column_of_days(columns: &[Column]) -> Option<usize> {
    let is_day = |at: &SystemTime| !is_of_day(*at) && seconds(SystemTime::UNIX_EPOCH, *at) % 86_400.0 == 0.0;
    let mut days = all(columns, is_day);
    days.next().filter(|_| days.next().is_none())
}

/// Columns that hold dates alone of which something is true.
fn all(columns: &[Column], of: impl Fn(&SystemTime) -> bool) -> impl Iterator<Item = usize> {
    let all = move |(_, column): &(usize, &Column)| column.is_dated() && column.dates.iter().all(&of);
    columns.iter().enumerate().filter(all).map(|(at, _)| at)
}

/// Gives times of day the days of a column beside them, which holds no dates of its own then. Without a day they are no times.
pub(super) fn join_days(columns: &mut [Column], of_days: usize) {
    let of_day: Vec<usize> = all(columns, |at| is_of_day(*at)).collect();
    if of_day.is_empty() {
        return;
    }
    if columns[of_days].dates.is_empty() {
        let fault = columns[of_days].fault.clone();
        for at in of_day {
            (columns[at].dates, columns[at].fault) = (Vec::new(), fault.clone());
        }
        return;
    }
    let days = std::mem::take(&mut columns[of_days].dates);
    for at in of_day {
        for (at, day) in columns[at].dates.iter_mut().zip(&days) {
            *at = *day + at.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        }
    }
}

/// A moment as words.
pub fn moment(at: SystemTime) -> String {
    let text = humantime::format_rfc3339_seconds(at).to_string().replace('T', " ");
    let text = text.trim_end_matches('Z');
    text.strip_prefix("1970-01-01 ").unwrap_or(text).to_string()
}

/// What comes first in a day parted by slashes whose year comes last.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Order {
    DayFirst,
    MonthFirst,
}

/// True of a date or a time of day.
pub(super) fn is_date(cell: &str) -> bool {
    date(cell, Order::DayFirst).or_else(|| date(cell, Order::MonthFirst)).is_some()
}

/// A day, a time of day, or both with a space or a `T` between them: `2026-01-02 03:04:05`, `02.01.2026 03:04`, `03:04:05.6`,
/// `01/02/2026 3:04 PM`.
fn date(cell: &str, order: Order) -> Option<SystemTime> {
    let (cell, zone) = zone(cell)?;
    let (day, time) = match cell.split_once([' ', 'T']) {
        Some((day, time)) if !day.contains(':') => (year_first(day, order)?, time.trim()),
        _ if cell.contains(':') => ("1970-01-01".to_string(), cell),
        _ => (year_first(cell, order)?, "00:00"),
    };
    let (time, later) = half_of_day(time)?;
    let hour = if time.find(':')? == 1 { format!("0{time}") } else { time.to_string() };
    let time = if hour.len() == 5 { format!("{hour}:00") } else { hour };
    let there = humantime::parse_rfc3339_weak(&format!("{day} {time}")).ok()?;
    let shift = Duration::from_secs(60 * u64::from((later - zone).unsigned_abs()));
    if later < zone { there.checked_sub(shift) } else { there.checked_add(shift) }
}

/// A time of day without `AM` or `PM`, and by how many minutes it is later than the clock of 24 hours would say.
fn half_of_day(time: &str) -> Option<(&str, i32)> {
    let Some(at) = time.len().checked_sub(2).filter(|&at| time.is_char_boundary(at)) else { return Some((time, 0)) };
    let (clock, half) = (time[..at].trim_end(), time[at..].to_ascii_uppercase());
    if half != "AM" && half != "PM" {
        return Some((time, 0));
    }
    let hour: i32 = clock.split(':').next()?.parse().ok()?;
    let first = if half == "PM" { 12 } else { 0 };
    (1..=12).contains(&hour).then(|| (clock, 60 * (first + hour % 12 - hour)))
}

/// A day with its year first. Parted by points, the day of the month comes first; parted by slashes, what `order` says.
fn year_first(day: &str, order: Order) -> Option<String> {
    let mark = day.chars().find(|mark| !mark.is_ascii_digit())?;
    let parts: Vec<&str> = day.split(mark).collect();
    let (year, month, date) = match (mark, &parts[..]) {
        ('-' | '/', [year, month, date]) if year.len() == 4 => (year, month, date),
        ('.', [date, month, year]) => (year, month, date),
        ('/', [date, month, year]) if order == Order::DayFirst => (year, month, date),
        ('/', [month, date, year]) => (year, month, date),
        _ => return None,
    };
    (year.len() == 4).then(|| format!("{year}-{month:0>2}-{date:0>2}"))
}

/// A moment without its zone, and how many minutes its clock is ahead of that of `Z`: `+01:00` and `+0100` are 60.
fn zone(cell: &str) -> Option<(&str, i32)> {
    let cell = cell.strip_suffix('Z').unwrap_or(cell);
    let sign = cell.rfind(['+', '-']).filter(|sign| cell[..*sign].contains(':'));
    let Some(sign) = sign else { return Some((cell, 0)) };
    let digits = cell[sign + 1..].replacen(':', "", 1);
    let are_digits = matches!(digits.len(), 2 | 4) && digits.bytes().all(|digit| digit.is_ascii_digit());
    let (hours, minutes) = are_digits.then(|| digits.split_at(2))?;
    let (hours, minutes): (i32, i32) =
        (hours.parse().ok()?, if minutes.is_empty() { 0 } else { minutes.parse().ok()? });
    let ahead = Some(60 * hours + minutes).filter(|_| hours < 24 && minutes < 60)?;
    Some((cell[..sign].trim_end(), if cell[sign..].starts_with('-') { -ahead } else { ahead }))
}

/// True of a time of day without a date.
fn is_of_day(at: SystemTime) -> bool {
    at < SystemTime::UNIX_EPOCH + Duration::from_secs(86_400)
}

/// Seconds from one moment to another, which may come before it.
fn seconds(from: SystemTime, to: SystemTime) -> f64 {
    to.duration_since(from).map_or_else(|before| -before.duration().as_secs_f64(), |after| after.as_secs_f64())
}
