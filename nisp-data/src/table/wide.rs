//! Tables with a column for each gauge, `T(x=0.1) [K],T(x=0.3) [K]`: they become tables with a row for each measurement.

use super::headers::in_brackets;
use super::{Column, Fault, Kind, Table};
use crate::DataError;

/// What the header of a gauge says: a quantity with its unit, and where along some coordinates it was measured.
struct Gauge {
    quantity: String,
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
    /// The rows of each place below each other, with columns of the places' coordinates, if its headers name places.
    ///
    /// # Errors
    /// Gauges that do not name the same coordinates in the same units.
    pub(super) fn with_rows_of_gauges(self) -> Result<Table, DataError> {
        let gauges: Vec<Option<Gauge>> = self.columns.iter().map(|column| Gauge::read(&column.header)).collect();
        let Some(first) = gauges.iter().flatten().next() else { return Ok(self) };
        let axes = |gauge: &Gauge| -> Vec<(String, String)> {
            gauge.place.iter().map(|at| (at.coordinate.clone(), at.unit.clone())).collect()
        };
        let named = axes(first);
        if let Some(at) = gauges.iter().position(|gauge| gauge.as_ref().is_some_and(|gauge| axes(gauge) != named)) {
            let what = format!(
                "`{}` is not said along the same coordinates in the same units as the gauge before; write all alike",
                self.columns[at].header
            );
            return Err(DataError::Column { path: self.path, what });
        }
        let mut places: Vec<&[Position]> = Vec::new();
        for gauge in gauges.iter().flatten() {
            if !places.contains(&gauge.place.as_slice()) {
                places.push(&gauge.place);
            }
        }
        let rows = self.rows();
        let mut columns: Vec<Column> = Vec::new();
        for (axis, (coordinate, unit)) in named.iter().enumerate() {
            let header = if unit.is_empty() { coordinate.clone() } else { format!("{coordinate} [{unit}]") };
            let values = places.iter().flat_map(|place| std::iter::repeat_n(place[axis].value, rows)).collect();
            columns.push(Column { header, values, ..Column::default() });
        }
        for (column, gauge) in self.columns.iter().zip(&gauges) {
            match gauge {
                None => columns.push(column.repeated(places.len())),
                Some(gauge) if columns.iter().any(|known| known.header == gauge.quantity) => {}
                Some(gauge) => {
                    let of = |place: &&[Position]| {
                        let mut all = self.columns.iter().zip(&gauges);
                        let is_here = |other: &Gauge| other.quantity == gauge.quantity && other.place == **place;
                        all.find(|(_, other)| other.as_ref().is_some_and(is_here)).map(|(column, _)| column)
                    };
                    columns.push(Column::joined(
                        &gauge.quantity,
                        &places.iter().map(of).collect::<Vec<_>>(),
                        &self.lines,
                    ));
                }
            }
        }
        let lines = self.lines.repeat(places.len());
        Ok(Table { path: self.path, columns, lines })
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
        let lacking = Fault { line: lines[0], what: "no gauge of this quantity is there".into(), kind: Kind::Empty };
        let faults = gauges.iter().filter_map(|gauge| gauge.map_or(Some(&lacking), |own| own.fault.as_ref()));
        let fault = faults.max_by_key(|fault| fault.kind).cloned();
        Column { header: header.into(), values: gauges.iter().flat_map(values).collect(), fault, ..Column::default() }
    }
}

impl Gauge {
    /// The gauge that a header names: `T(x=0.1)`, `w (x = 10 mm, y = 20 mm) [um]`.
    fn read(header: &str) -> Option<Self> {
        let (name, rest) = header.split_once('(')?;
        let (place, unit) = rest.split_once(')')?;
        let place: Vec<Position> = place.split([',', ';']).map(Position::read).collect::<Option<_>>()?;
        let quantity = match in_brackets(unit) {
            Some(unit) => format!("{} [{unit}]", name.trim()),
            None => format!("{}{}", name.trim(), unit.trim_end()),
        };
        Some(Self { quantity, place })
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
