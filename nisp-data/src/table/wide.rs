//! Tables with a column for each gauge, `T(x=0.1) [K],T(x=0.3) [K]`: they become tables with a row for each measurement.

use super::headers::{base, in_brackets};
use super::{Column, Fault, Kind, Table};
use crate::DataError;

/// What the header of a gauge says: a quantity, with its unit if one is said, and where along some coordinates it was measured.
struct Gauge {
    name: String,
    header: String,
    place: Vec<Position>,
}

/// A number along a coordinate, and its unit if one is said.
#[derive(Clone, PartialEq)]
struct Position {
    coordinate: String,
    value: f64,
    unit: String,
}

impl Table {
    /// The rows of each place below each other, with columns of the places' coordinates, if headers name places along coordinates of
    /// which the table has no columns. Other headers with brackets are left as they are.
    ///
    /// # Errors
    /// A place that cannot be read, two gauges at one place, and gauges that do not say their places or their quantity alike.
    pub fn with_rows_of_gauges(self, coordinates: &[&str]) -> Result<Table, DataError> {
        let lacking: Vec<&str> = coordinates.iter().copied().filter(|name| !self.has(name)).collect();
        let read = |column: &Column| Gauge::read(&column.header, &lacking);
        let gauges: Vec<Option<Gauge>> = match self.columns.iter().map(read).collect() {
            Ok(gauges) => gauges,
            Err(what) => return Err(self.refused(what)),
        };
        let Some(first) = gauges.iter().flatten().next() else { return Ok(self) };
        if let Some(what) = self.unlike(&gauges) {
            return Err(self.refused(what));
        }
        let mut places: Vec<&[Position]> = Vec::new();
        for gauge in gauges.iter().flatten() {
            if !places.contains(&gauge.place.as_slice()) {
                places.push(&gauge.place);
            }
        }
        let along = |(axis, at): (usize, &Position)| {
            let header =
                if at.unit.is_empty() { at.coordinate.clone() } else { format!("{} [{}]", at.coordinate, at.unit) };
            let values = places.iter().flat_map(|place| std::iter::repeat_n(place[axis].value, self.rows())).collect();
            Column { header, values, ..Column::default() }
        };
        let mut columns: Vec<Column> = first.place.iter().enumerate().map(along).collect();
        for (column, gauge) in self.columns.iter().zip(&gauges) {
            match gauge {
                None => columns.push(column.repeated(places.len())),
                Some(gauge) if columns.iter().any(|known| known.header == gauge.header) => {}
                Some(gauge) => {
                    let of = |place: &&[Position]| {
                        let is_here = |other: &Gauge| other.name == gauge.name && other.place == **place;
                        let at = gauges.iter().position(|other| other.as_ref().is_some_and(is_here))?;
                        Some(&self.columns[at])
                    };
                    let all: Vec<Option<&Column>> = places.iter().map(of).collect();
                    columns.push(Column::joined(&gauge.header, &all, &self.lines));
                }
            }
        }
        let lines = self.lines.repeat(places.len());
        Ok(Table { path: self.path, columns, lines })
    }

    fn refused(self, what: String) -> DataError {
        DataError::Column { path: self.path, what }
    }

    /// What is wrong with gauges that are not said alike, or beside columns that are said like them.
    fn unlike(&self, gauges: &[Option<Gauge>]) -> Option<String> {
        let axes = |gauge: &Gauge| -> Vec<(String, String)> {
            gauge.place.iter().map(|at| (at.coordinate.clone(), at.unit.clone())).collect()
        };
        let mut before: Vec<(&Gauge, &str)> = Vec::new();
        for (gauge, column) in gauges.iter().zip(&self.columns) {
            let Some(gauge) = gauge else { continue };
            let own = &column.header;
            let same = || before.iter().filter(|(other, _)| other.name == gauge.name);
            if let Some((_, first)) = before.first().filter(|(first, _)| axes(first) != axes(gauge)) {
                return Some(format!(
                    "`{first}` and `{own}` do not name the same coordinates in the same units; write all alike"
                ));
            }
            if let Some((_, other)) = same().find(|(other, _)| other.header != gauge.header) {
                return Some(format!("`{other}` and `{own}` are one quantity in two units; write it in one"));
            }
            if let Some((_, other)) = same().find(|(other, _)| other.place == gauge.place) {
                return Some(format!("`{other}` and `{own}` are at the same place; keep one of them"));
            }
            before.push((gauge, own));
        }
        let is_plain = |header: &&str| before.iter().any(|(gauge, _)| base(header) == gauge.name);
        let plain = self.columns.iter().zip(gauges).filter(|(_, gauge)| gauge.is_none());
        let plain = plain.map(|(column, _)| column.header.as_str()).find(is_plain)?;
        Some(format!(
            "`{plain}` says no place beside `{}`, which does; write it into its header, or remove it",
            before[0].1
        ))
    }
}

impl Column {
    fn repeated(&self, times: usize) -> Column {
        Column { values: self.values.repeat(times), dates: self.dates.repeat(times), ..self.clone() }
    }

    /// The columns of a quantity's gauges below each other, with cells that were not measured where there is no gauge.
    fn joined(header: &str, gauges: &[Option<&Column>], lines: &[usize]) -> Column {
        let values =
            |gauge: &Option<&Column>| gauge.map_or_else(|| vec![f64::NAN; lines.len()], |own| own.values.clone());
        let line = lines.first().copied().unwrap_or(1);
        let lacking = Fault { line, what: "no gauge of this quantity is there".into(), kind: Kind::Empty };
        let faults = gauges.iter().filter_map(|gauge| gauge.map_or(Some(&lacking), |own| own.fault.as_ref()));
        let fault = faults.max_by_key(|fault| fault.kind).cloned();
        Column { header: header.into(), values: gauges.iter().flat_map(values).collect(), fault, ..Column::default() }
    }
}

impl Gauge {
    /// The gauge that a header names: `T(x=0.1)`, `w (x = 10 mm, y = 20 mm) [um]`; nothing where no coordinate begins what stands in
    /// brackets, or nothing follows it.
    ///
    /// # Errors
    /// A place that cannot be read.
    fn read(header: &str, coordinates: &[&str]) -> Result<Option<Self>, String> {
        let Some((name, (place, unit))) =
            header.split_once('(').and_then(|(name, rest)| Some((name, rest.split_once(')')?)))
        else {
            return Ok(None);
        };
        let is_of = |name: &&&str| {
            let rest = place.trim_start().strip_prefix(**name).map(str::trim_start);
            rest.is_some_and(|rest| rest.starts_with(|mark: char| mark == '=' || mark.is_ascii_digit()))
        };
        if !coordinates.iter().any(|name| is_of(&name)) {
            return Ok(None);
        }
        let read: Option<Vec<Position>> = place.split([',', ';']).map(Position::read).collect();
        let is_known = |at: &Position| coordinates.contains(&at.coordinate.as_str());
        let Some(place) = read.filter(|place| place.iter().all(is_known)) else {
            return Err(format!(
                "the place in `{header}` cannot be read; write it as in `T(x=0.1)` or `T(x=10 mm, y=20 mm)`"
            ));
        };
        let name = name.trim().to_string();
        let header = match in_brackets(unit) {
            Some(unit) => format!("{name} [{unit}]"),
            None => format!("{name}{}", unit.trim_end()),
        };
        Ok(Some(Self { name, header, place }))
    }
}

impl Position {
    /// `x=0.1`, `x = 10 mm`.
    fn read(text: &str) -> Option<Self> {
        let (coordinate, at) = text.split_once('=')?;
        let at = at.trim();
        let number = |end: usize| Some((at.get(..end)?.trim().parse::<f64>().ok()?, at.get(end..)?));
        let (value, unit) = (1..=at.len()).rev().find_map(number).filter(|(value, _)| value.is_finite())?;
        let unit = in_brackets(unit).unwrap_or(unit).trim().to_string();
        Some(Self { coordinate: coordinate.trim().into(), value, unit })
    }
}
