//! Names that the user gave must be names that there are.

use std::path::Path;

use nisp::schema::{Coordinate, Origin, Portion, Scene};
use nisp_data::Table;

use super::{Tables, wants_data};
use crate::entry::hint;
use crate::error::PrepareError;
use crate::prepared::Assumed;
use crate::request::Request;

/// A file of data must be for a group that there is.
pub(super) fn group(schema: &Scene, group: Option<&str>, path: &Path) -> Result<(), PrepareError> {
    let known: Vec<&str> = schema.groups.iter().filter(|group| !group.is_beliefs()).map(|group| group.name).collect();
    match group.filter(|group| !known.contains(group)) {
        Some(group) => {
            let (group, path) = (group.to_string(), path.to_path_buf());
            Err(PrepareError::Group { hint: hint(&group, &known), group, path, have: known.join(", ") })
        }
        None => Ok(()),
    }
}

/// Every name in `--points` must be that of a group which lies in a domain and has no table of points.
pub(super) fn points(schema: &Scene, tables: &Tables<'_>, request: &Request) -> Result<(), PrepareError> {
    let drawn = schema.groups.iter().filter(|group| group.place.is_some() && tables.of(group).is_none());
    let known: Vec<&str> = drawn.map(|group| group.name).collect();
    match request.points.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        Some((name, _)) => {
            let none = "none, since all points come with data".to_string();
            let have = if known.is_empty() { none } else { known.join(", ") };
            Err(PrepareError::Points { group: name.clone(), hint: hint(name, &known), have })
        }
        None => Ok(()),
    }
}

/// Every header in `--column` must stand in some table.
pub(super) fn headers(schema: &Scene, tables: &[&Table], request: &Request) -> Result<(), PrepareError> {
    let known = are_read(schema);
    let chosen = request.columns.iter().filter(|(name, _)| known.contains(&name.as_str()));
    let mut unknown = chosen.filter(|(_, header)| tables.iter().all(|table| !table.offers(header)));
    match (unknown.next(), tables) {
        (Some((name, header)), [first, _, ..]) => Err(first.absent(name, header).into()),
        _ => Ok(()),
    }
}

/// An edge knows its normal under the name `normal` alone. A vector that no table has may be meant for it under another name.
pub(super) fn normals(schema: &Scene, tables: &Tables<'_>) -> Result<(), PrepareError> {
    let [axis, ..] = schema.coordinates else { return Ok(()) };
    let edges = schema.groups.iter().filter(|group| group.place.is_some_and(|at| at.portion == Portion::Boundary));
    for group in edges {
        let lacks = |name: &str| tables.of(group).is_none_or(|table| table.lacks(name, std::iter::empty()));
        let vectors = group.columns.iter().filter_map(|column| {
            let base = column.name.strip_suffix(&format!("_{}", axis.name))?;
            let is_whole = |other: &Coordinate| {
                let entry = format!("{base}_{}", other.name);
                group.columns.iter().any(|column| column.name == entry && column.unit.text.is_empty())
            };
            schema.coordinates.iter().filter(|other| other.unit == axis.unit).all(is_whole).then_some((column, base))
        });
        let mut unknown = vectors.filter(|(column, base)| *base != "normal" && lacks(column.name));
        if let Some((_, base)) = unknown.next() {
            return Err(PrepareError::Normal { group: group.name, column: base.to_string() });
        }
    }
    Ok(())
}

/// Every group with columns of measurements must have a table.
pub(super) fn measured(schema: &Scene, tables: &Tables<'_>) -> Result<(), PrepareError> {
    let lacking = schema.groups.iter().filter(|group| wants_data(group) && tables.of(group).is_none());
    let faults = lacking.map(|group| {
        let columns: Vec<&str> = group.columns.iter().map(|column| column.name).collect();
        PrepareError::Unmeasured { group: group.name, columns: columns.join(", ") }
    });
    let faults: Vec<_> = faults.collect();
    if faults.is_empty() { Ok(()) } else { Err(PrepareError::all(faults)) }
}

/// Every name in `--column` must be one that the scene observes, or a coordinate, or a quantity that the truth has.
pub(crate) fn columns(schema: &Scene, request: &Request) -> Result<(), PrepareError> {
    let mut known = are_read(schema);
    if request.truth.is_some() {
        let others = schema.heads.iter().map(|head| head.name).filter(|head| !known.contains(head));
        known.extend(others.collect::<Vec<_>>());
    }
    match request.columns.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        Some((name, _)) => {
            Err(PrepareError::Column { name: name.clone(), hint: hint(name, &known), have: known.join(", ") })
        }
        None => Ok(()),
    }
}

/// The names that are read from tables of measurements.
pub(super) fn are_read(schema: &Scene) -> Vec<&'static str> {
    let measured = schema.groups.iter().filter(|group| !group.is_beliefs());
    let observed = measured.flat_map(|group| group.columns).map(|column| column.name);
    observed.chain(schema.coordinates.iter().map(|axis| axis.name)).collect()
}

/// Parameters that nobody gave beside data of the user's own.
pub(crate) fn assumed(schema: &Scene, request: &Request) -> Vec<Assumed> {
    let declared =
        schema.scalars.iter().filter(|_| !request.data.is_empty()).filter_map(|scalar| match scalar.origin {
            Origin::Given(Some(value)) if !scalar.name.is_empty() => {
                let value = without_rounding(scalar.unit.factor.back(value).as_declared());
                Some(Assumed { name: scalar.name, value, unit: scalar.unit.text })
            }
            _ => None,
        });
    declared.filter(|assumed| request.parameters.iter().all(|(name, _)| name != assumed.name)).collect()
}

/// A number as it was written, before a unit's factor was put on and taken off.
fn without_rounding(value: f64) -> f64 {
    format!("{value:.13e}").parse().unwrap_or(value)
}
