//! From a table to the places and the columns of a group.

use nisp::schema::{Column, Group, Scene};
use nisp_data::Table;

use super::Found;
use crate::error::PrepareError;
use crate::prepared::Measured;
use crate::request::Request;

/// Products of a few numbers up to this size are finite.
const LARGEST: f64 = 1e60;

/// A group's part of a table.
pub(super) struct Rows {
    /// Its points, point by point.
    pub(super) points: Vec<f64>,
    /// Its columns, NaN where nothing was measured.
    pub(super) columns: Vec<Vec<f64>>,
}

/// Reads what a group takes from its table; all that is wrong with it at once.
pub(super) fn rows(
    schema: &Scene,
    group: &Group,
    table: &Table,
    request: &Request,
    found: &mut Found,
) -> Result<Rows, PrepareError> {
    let points = places(schema, table, request);
    let columns = columns((schema, group), table, request, found);
    let (points, columns) = match (points, columns) {
        (Ok(points), Ok(columns)) => (points, columns),
        (points, columns) => {
            return Err(PrepareError::all([points.err(), columns.err()].into_iter().flatten().collect()));
        }
    };
    let measured = group.columns.iter().zip(&columns).filter(|(_, values)| !values.iter().all(|x| x.is_nan()));
    found.measured.extend(measured.map(|(c, values)| Measured {
        name: c.name,
        at: points.clone(),
        values: values.clone(),
    }));
    Ok(Rows { points, columns })
}

/// Those values that were read, or everything that is wrong.
fn gathered<T>(results: impl Iterator<Item = Result<T, PrepareError>>) -> Result<Vec<T>, PrepareError> {
    let (mut values, mut faults) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(values) } else { Err(PrepareError::all(faults)) }
}

/// The places of a table's rows, point by point.
pub(super) fn places(schema: &Scene, table: &Table, request: &Request) -> Result<Vec<f64>, PrepareError> {
    let axes = schema.coordinates.iter().map(|axis| read(table, (axis.name, axis.unit.text), false, request));
    let axes = gathered(axes).map_err(|fault| gauges(schema, table, fault))?;
    if let [axis] = schema.coordinates {
        table.require_increasing(header(request, axis.name, table).unwrap_or(axis.name))?;
    }
    Ok((0..table.rows()).flat_map(|row| axes.iter().map(move |axis| axis[row])).collect())
}

/// What is said where a table has some of the coordinates: it may have a column for each gauge.
fn gauges(schema: &Scene, table: &Table, fault: PrepareError) -> PrepareError {
    let lacking: Vec<&str> =
        schema.coordinates.iter().map(|axis| axis.name).filter(|axis| table.lacks(axis, std::iter::empty())).collect();
    let many = schema.coordinates.len() + 1;
    match &lacking[..] {
        [axis, ..] if lacking.len() < schema.coordinates.len() && table.headers().count() > many => {
            PrepareError::Gauges { fault: fault.to_string(), axis: (*axis).to_string() }
        }
        _ => fault,
    }
}

/// The columns of a group, and what is to be said of them.
fn columns(
    (schema, group): (&Scene, &Group),
    table: &Table,
    request: &Request,
    found: &mut Found,
) -> Result<Vec<Vec<f64>>, PrepareError> {
    // A quantity without a column of its own is not measured, as long as another one is.
    let names =
        || schema.coordinates.iter().map(|axis| axis.name).chain(group.columns.iter().map(|column| column.name));
    let is_lacking =
        |name: &str| group.may_lack(name) && header(request, name, table).is_none() && table.lacks(name, names());
    let is_any = group.columns.iter().any(|column| !is_lacking(column.name));
    let columns = gathered(group.columns.iter().map(|c| {
        if is_any && is_lacking(c.name) {
            let headers = table.headers().collect::<Vec<_>>().join(", ");
            let message = format!("`{}` is not measured: no column answers to it (columns: {headers})", c.name);
            found.warnings.push(message);
            return Ok(vec![f64::NAN; table.rows()]);
        }
        let values = read(table, (c.name, c.unit.text), group.may_lack(c.name), request)?;
        if !table.says_unit(c.name, header(request, c.name, table), c.unit.text) {
            found.unlabelled.push(c.name);
        }
        let gaps = values.iter().filter(|value| value.is_nan()).count();
        if gaps > 0 {
            found.warnings.push(format!("`{}` is not measured in {gaps} of {} rows", c.name, values.len()));
        }
        Ok(values)
    }))?;
    found.warnings.extend(twins(group, &columns));
    Ok(columns)
}

/// What is to be said of two quantities that have the same numbers in all rows: noise alone makes them differ.
fn twins(group: &Group, columns: &[Vec<f64>]) -> Vec<String> {
    let is_varied = |values: &[f64]| values.iter().any(|x| x.is_finite() && *x != values[0]);
    let all = group.columns.iter().zip(columns).enumerate();
    let of = |(at, (one, values)): (usize, (&Column, &Vec<f64>))| {
        let later = group.columns.iter().zip(columns).skip(at + 1);
        let other = later.into_iter().find(|(_, other)| *other == values && is_varied(values))?.0;
        let (one, other) = (one.name, other.name);
        Some(format!("`{one}` and `{other}` have the same numbers in every row: is one column taken for both?"))
    };
    all.filter_map(of).collect()
}

/// The header that the user chose for a name in a table: the last one that it has. One that it has not may be meant for another table.
pub(crate) fn header<'a>(request: &'a Request, name: &str, table: &Table) -> Option<&'a str> {
    let chosen = || request.columns.iter().rev().filter(|(own, _)| own == name).map(|(_, header)| header.as_str());
    chosen().find(|header| table.offers(header)).or_else(|| chosen().next().filter(|_| request.data.len() < 2))
}

/// The values of a quantity in its declared unit.
pub(crate) fn read(
    table: &Table,
    (name, unit): (&'static str, &'static str),
    may_lack: bool,
    request: &Request,
) -> Result<Vec<f64>, PrepareError> {
    let values = match (header(request, name, table), may_lack) {
        (Some(header), false) => table.chosen(name, header, unit)?,
        (Some(header), true) => table.chosen_measured(name, header, unit)?,
        (None, false) => table.quantity(name, unit)?,
        (None, true) => table.measured(name, unit)?,
    };
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest > LARGEST { Err(PrepareError::Size { name, largest, unit }) } else { Ok(values) }
}
