//! Any scene bound to tables: the columns of coordinates and measurements are found by their names and units, and groups
//! without measurements lie in declared domains or, over one coordinate, within the span of the data.

mod check;
mod clock;
mod clouds;
mod read;
mod units;
mod unmeasured;
mod wanted;

use std::path::Path;

use nisp::schema::{Group, Portion, Scene};
use nisp::{Problem, SceneRef};
use nisp_data::{DataError, Table};

use crate::entry::Entry;
use crate::error::PrepareError;
use crate::pairs::require_partners;
use crate::places::{Body, Placed};
use crate::prepared::{Measured, Prepared};
use crate::request::Request;
use crate::truth::{Headers, Truth};
pub(crate) use check::{assumed, columns as check_columns};
pub(crate) use clock::Clock;
pub(crate) use clouds::CloudFile;
use read::Rows;
pub(crate) use read::{header, read};
pub(crate) use units::doubts;
use unmeasured::unmeasured;
use wanted::{planes, wanted};

/// Tables of measurements.
pub(crate) struct Tables<'a> {
    /// For every group that wants data and has no table of its own.
    pub(crate) any: Option<&'a Table>,
    /// For groups by their names.
    pub(crate) own: Vec<(&'a str, &'a Table)>,
    /// What was seen of surfaces.
    pub(crate) clouds: Vec<CloudFile<'a>>,
    /// Where files are looked for that the equation names.
    pub(crate) folder: &'a Path,
}

impl<'a> Tables<'a> {
    fn of(&self, group: &Group) -> Option<&'a Table> {
        let own = self.own.iter().rev().find(|(name, _)| *name == group.name).map(|(_, table)| *table);
        own.or(self.any.filter(|_| wants_data(group)))
    }

    fn files(&self) -> impl Iterator<Item = &'a Path> {
        let tables = self.own.iter().map(|(_, table)| *table).chain(self.any).map(Table::path);
        tables.chain(self.clouds.iter().map(|cloud| cloud.path))
    }
}

/// A scene with all that was found for it.
pub(crate) struct Found {
    pub(crate) problem: Problem,
    /// What was measured.
    pub(crate) measured: Vec<Measured>,
    /// What the user should know of the data.
    pub(crate) warnings: Vec<String>,
    /// Columns whose headers say no unit.
    pub(crate) unlabelled: Vec<&'static str>,
    /// The places of the first measurements.
    pub(crate) places: Vec<f64>,
    /// The least and the greatest of each coordinate.
    pub(crate) bounds: Vec<[f64; 2]>,
    /// The largest of the declared domains.
    pub(crate) body: Option<Body>,
}

/// Reads what is asked for and binds a scene of an equation that has no data of its own.
///
/// # Errors
/// A table, a column, a scene or a parameter that does not fit, or a group without points.
pub(crate) fn prepare(entry: &Entry, folder: &Path, request: &Request) -> Result<Prepared, PrepareError> {
    let scene = entry.scene(request.scene.as_deref())?;
    let schema = scene.schema;
    let (mut read, mut clouds) = (Vec::new(), Vec::new());
    for (at, (group, path)) in request.data.iter().enumerate() {
        if let Some((_, first)) = request.data[..at].iter().find(|(other, _)| other == group) {
            return Err(PrepareError::Twice { group: group.clone(), first: first.clone(), second: path.clone() });
        }
        match clouds::named(schema, group.as_deref()) {
            Some(of) => clouds.push(CloudFile { of, path }),
            None => {
                check::group(schema, group.as_deref(), path)?;
                read.push((group.as_deref(), gauges(Table::read_places(path)?, schema, request)?));
            }
        }
    }
    check::headers(schema, &read.iter().map(|(_, table)| table).collect::<Vec<_>>(), request)?;
    let clock = Clock::of(read.iter().map(|(_, table)| table));
    read.iter_mut().for_each(|(_, table)| clock.count(table));
    let tables = Tables {
        any: read.iter().rev().find(|(group, _)| group.is_none()).map(|(_, table)| table),
        own: read.iter().filter_map(|(group, table)| Some(((*group)?, table))).collect(),
        clouds,
        folder,
    };
    let mut found = bind(scene, &tables, request)?;
    let said = read.iter().find_map(|(_, table)| clock.said(schema, table, request));
    let begin = clock.begin.filter(|_| said.is_some());
    found.warnings.extend(said);
    let truth = request.truth.as_ref().map(Table::read).transpose()?;
    let mut truth = truth.map(|table| gauges(table, schema, request)).transpose()?;
    truth.iter_mut().for_each(|table| clock.count(table));
    // A column may be chosen for what is measured, whose truth has another one.
    let (unmeasured, measured) = request.columns.iter().cloned().partition::<Vec<_>, _>(|(name, _)| {
        schema.heads.iter().any(|head| head.name == name) && !check::are_read(schema).contains(&name.as_str())
    });
    let also: Vec<(&str, &str)> = measured.iter().map(|(name, header)| (name.as_str(), header.as_str())).collect();
    let headers = Headers { chosen: &unmeasured, also: &also, ..Headers::default() };
    let truth = truth.map(|truth| Truth::read(&truth, schema, &found.bounds, headers)).transpose()?;
    let points = wanted(schema, &found, clock, request)?;
    let files: Vec<String> = tables.files().map(|path| path.display().to_string()).collect();
    Ok(Prepared {
        points,
        outline: found.body.as_ref().map_or_else(Vec::new, Body::outline),
        planes: planes(schema, &found),
        measured: found.measured,
        truth,
        source: if files.is_empty() { "no data".into() } else { files.join(", ") },
        begin,
        warnings: found.warnings,
        assumed: assumed(schema, request),
        problem: found.problem,
        rival: None,
        local: None,
        contact: None,
        references: None,
        frames: None,
    })
}

/// A table with a row for each measurement, where it has a column for each gauge along coordinates for which no column was chosen.
fn gauges(table: Table, schema: &Scene, request: &Request) -> Result<Table, DataError> {
    let names = schema.coordinates.iter().map(|axis| axis.name).filter(|name| header(request, name, &table).is_none());
    let names: Vec<&str> = names.collect();
    table.with_rows_of_gauges(&names)
}

/// Binds every group of a scene.
///
/// # Errors
/// As [`prepare`].
pub(crate) fn bind(scene: SceneRef, tables: &Tables<'_>, request: &Request) -> Result<Found, PrepareError> {
    let schema = scene.schema;
    check::columns(schema, request)?;
    check::points(schema, tables, request)?;
    check::normals(schema, tables)?;
    check::measured(schema, tables)?;
    let mut found = Found {
        problem: Problem::new(scene),
        measured: Vec::new(),
        warnings: Vec::new(),
        unlabelled: Vec::new(),
        places: Vec::new(),
        bounds: vec![[f64::INFINITY, f64::NEG_INFINITY]; schema.coordinates.len()],
        body: None,
    };
    let mut rows = Vec::new();
    let mut faults = Vec::new();
    for group in schema.groups {
        require_partners(group)?;
        let read = tables.of(group).map(|table| read::rows(schema, group, table, request, &mut found)).transpose();
        let read = read.unwrap_or_else(|fault| {
            faults.push(fault);
            None
        });
        if let Some(Rows { points, .. }) = &read {
            widen(&mut found.bounds, points);
            if found.places.is_empty() && wants_data(group) {
                found.places.clone_from(points);
            }
        }
        rows.push(read);
    }
    if !faults.is_empty() {
        return Err(PrepareError::all(faults));
    }
    for place in schema.groups.iter().filter_map(|group| group.place) {
        let body = Body::new(place.domain, schema.coordinates, tables.folder)?;
        let (low, high) = body.bounds();
        widen(&mut found.bounds, &low);
        widen(&mut found.bounds, &high);
        found.body.get_or_insert(body);
    }
    for (name, value) in &request.parameters {
        found.problem.set_parameter(name, *value)?;
    }
    for (group, rows) in schema.groups.iter().zip(rows).filter(|(group, _)| !group.is_beliefs()) {
        let (points, columns) = match rows {
            Some(Rows { points, columns }) => (points.into(), columns),
            None => {
                let placed = unmeasured(schema, group, &found.bounds, tables.folder, request)?;
                let columns = normals(schema, group, &placed);
                (placed.points, columns)
            }
        };
        found.problem.set_group(group.name, points, columns)?;
    }
    clouds::bind(&mut found, tables, request)?;
    // What is not sensibly bound is said when it is solved.
    let rests = found.problem.rests().unwrap_or_default();
    let doubts = units::doubts(&rests, &found.unlabelled)?;
    found.warnings.extend(doubts);
    Ok(found)
}

/// True for a group whose columns must come from a table. What is believed of parameters comes with these.
fn wants_data(group: &Group) -> bool {
    !group.is_beliefs() && group.columns.iter().any(|column| !is_normal(group, column.name))
}

/// True for a column that the edge of a declared domain tells.
fn is_normal(group: &Group, column: &str) -> bool {
    group.place.is_some_and(|place| place.portion == Portion::Boundary) && column.starts_with("normal")
}

/// The columns of a group that its points' domain tells: normals, entry by entry, and nothing across coordinates of other
/// regions.
fn normals(schema: &Scene, group: &Group, placed: &Placed) -> Vec<Vec<f64>> {
    let count = placed.points.coordinates.len() / schema.coordinates.len();
    let axis = |name: &str| schema.coordinates.iter().position(|axis| name.ends_with(&format!("_{}", axis.name)));
    let normal = |name: &str| placed.normals.get(axis(name).unwrap_or(0)).cloned();
    group.columns.iter().map(|c| normal(c.name).unwrap_or_else(|| vec![0.0; count])).collect()
}

fn widen(bounds: &mut [[f64; 2]], points: &[f64]) {
    let axes = bounds.len();
    for (at, value) in points.iter().enumerate() {
        let [low, high] = &mut bounds[at % axes];
        (*low, *high) = (low.min(*value), high.max(*value));
    }
}
