//! Any scene bound to tables: the columns of coordinates and measurements are found by their names and units, and groups
//! without measurements lie in declared domains or, over one coordinate, within the span of the data.

use nisp::network::Stretched;
use nisp::schema::{Group, Origin, Place, Portion, Scene, TermKind};
use nisp::{Points, Problem, SceneRef};
use nisp_data::Table;
use std::path::Path;

use crate::entry::{Entry, hint};
use crate::error::PrepareError;
use crate::places::{Body, Placed};
use crate::prepared::{Assumed, Measured, Prepared};
use crate::request::{Request, Wanted};
use crate::truth::{Headers, Truth};

/// Places over one coordinate at which the equations are asked to hold.
const COLLOCATION: usize = 300;

/// Points of an answer along each coordinate, over one, two, three and more coordinates, where nothing else is wanted.
const GRID: [usize; 4] = [201, 61, 21, 9];

/// Products of a few numbers up to this size are finite.
const LARGEST: f64 = 1e60;

/// Tables of measurements.
pub(crate) struct Tables<'a> {
    /// For every group that wants data and has no table of its own.
    pub(crate) any: Option<&'a Table>,
    /// For groups by their names.
    pub(crate) own: Vec<(&'a str, &'a Table)>,
}

impl<'a> Tables<'a> {
    fn of(&self, group: &Group) -> Option<&'a Table> {
        let own = self.own.iter().rev().find(|(name, _)| *name == group.name).map(|(_, table)| *table);
        own.or(self.any.filter(|_| wants_data(group)))
    }

    fn all(&self) -> impl Iterator<Item = &'a Table> {
        self.own.iter().map(|(_, table)| *table).chain(self.any)
    }
}

/// A scene with all that was found for it.
pub(crate) struct Found {
    pub(crate) problem: Problem,
    /// What was measured over one coordinate.
    pub(crate) measured: Vec<Measured>,
    /// What the user should know of the data.
    pub(crate) warnings: Vec<String>,
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
pub(crate) fn prepare(entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    let scene = entry.scene(request.scene.as_deref())?;
    let schema = scene.schema;
    let mut read = Vec::new();
    for (group, path) in &request.data {
        check_group(schema, group.as_deref(), path)?;
        read.push((group.as_deref(), Table::read(path)?));
    }
    let tables = Tables {
        any: read.iter().rev().find(|(group, _)| group.is_none()).map(|(_, table)| table),
        own: read.iter().filter_map(|(group, table)| Some(((*group)?, table))).collect(),
    };
    let found = bind(scene, &tables, request)?;
    let truth = request.truth.as_ref().map(Table::read).transpose()?;
    let range = found.bounds.first().filter(|_| schema.coordinates.len() == 1).copied();
    let truth = truth.map(|truth| Truth::read(&truth, schema, range, Headers::default())).transpose()?;
    let points = wanted(schema, &found, request)?;
    let files: Vec<String> = tables.all().map(|table| table.path().display().to_string()).collect();
    Ok(Prepared {
        points,
        outline: found.body.as_ref().map_or_else(Vec::new, Body::outline),
        planes: planes(schema, &found),
        measured: found.measured,
        truth,
        source: if files.is_empty() { "no data".into() } else { files.join(", ") },
        warnings: found.warnings,
        assumed: assumed(schema, request),
        problem: found.problem,
        rival: None,
        local: None,
        contact: None,
        references: None,
    })
}

/// Binds every group of a scene.
///
/// # Errors
/// As [`prepare`].
pub(crate) fn bind(scene: SceneRef, tables: &Tables<'_>, request: &Request) -> Result<Found, PrepareError> {
    let schema = scene.schema;
    check_columns(schema, request)?;
    let mut found = Found {
        problem: Problem::new(scene),
        measured: Vec::new(),
        warnings: Vec::new(),
        places: Vec::new(),
        bounds: vec![[f64::INFINITY, f64::NEG_INFINITY]; schema.coordinates.len()],
        body: None,
    };
    let mut rows = Vec::new();
    for group in schema.groups {
        let points = tables.of(group).map(|table| places(schema, table, request)).transpose()?;
        if let Some(points) = &points {
            widen(&mut found.bounds, points);
            if found.places.is_empty() && wants_data(group) {
                found.places.clone_from(points);
            }
        }
        rows.push(points);
    }
    for place in schema.groups.iter().filter_map(|group| group.place) {
        let body = Body::new(place.domain)?;
        let (low, high) = body.bounds();
        widen(&mut found.bounds, &low);
        widen(&mut found.bounds, &high);
        found.body.get_or_insert(body);
    }
    for (name, value) in &request.parameters {
        found.problem.set_parameter(name, *value)?;
    }
    for (group, rows) in schema.groups.iter().zip(rows) {
        let placed = match (rows, tables.of(group)) {
            (Some(points), _) => Placed { points: points.into(), normals: Vec::new() },
            (None, _) if wants_data(group) => {
                let columns: Vec<&str> = group.columns.iter().map(|column| column.name).collect();
                return Err(PrepareError::Unmeasured { group: group.name, columns: columns.join(", ") });
            }
            (None, _) => unmeasured(schema, group, &found.bounds)?,
        };
        let columns = columns(schema, group, &placed, tables.of(group), request, &mut found)?;
        found.problem.set_group(group.name, placed.points, columns)?;
    }
    Ok(found)
}

/// True for a group whose columns must come from a table.
fn wants_data(group: &Group) -> bool {
    group.columns.iter().any(|column| !is_normal(group, column.name))
}

/// True for a column that the edge of a declared domain tells.
fn is_normal(group: &Group, column: &str) -> bool {
    group.place.is_some_and(|place| place.portion == Portion::Boundary) && column.starts_with("normal")
}

/// The places of a table's rows, point by point.
fn places(schema: &Scene, table: &Table, request: &Request) -> Result<Vec<f64>, PrepareError> {
    let axes = schema.coordinates.iter().map(|axis| read(table, (axis.name, axis.unit.text), false, request));
    let axes = axes.collect::<Result<Vec<_>, _>>()?;
    if let [axis] = schema.coordinates {
        table.require_increasing(header(request, axis.name).unwrap_or(axis.name))?;
    }
    Ok((0..table.rows()).flat_map(|row| axes.iter().map(move |axis| axis[row])).collect())
}

/// The columns of a group, and what is to be said of them.
fn columns(
    schema: &Scene,
    group: &Group,
    placed: &Placed,
    table: Option<&Table>,
    request: &Request,
    found: &mut Found,
) -> Result<Vec<Vec<f64>>, PrepareError> {
    let count = placed.points.coordinates.len() / schema.coordinates.len();
    let Some(table) = table else {
        // Normals, entry by entry, and nothing across coordinates of other regions.
        let axis = |name: &str| schema.coordinates.iter().position(|axis| name.ends_with(&format!("_{}", axis.name)));
        let normal = |name: &str| placed.normals.get(axis(name).unwrap_or(0)).cloned();
        return Ok(group.columns.iter().map(|c| normal(c.name).unwrap_or_else(|| vec![0.0; count])).collect());
    };
    // A quantity without a column of its own is not measured, as long as another one is.
    let is_lacking = |name: &str| group.may_lack(name) && header(request, name).is_none() && table.lacks(name);
    let is_any = group.columns.iter().any(|column| !is_lacking(column.name));
    let mut columns = Vec::new();
    for c in group.columns {
        if is_any && is_lacking(c.name) {
            let headers = table.headers().collect::<Vec<_>>().join(", ");
            let message = format!("`{}` is not measured: no column answers to it (columns: {headers})", c.name);
            found.warnings.push(message);
            columns.push(vec![f64::NAN; count]);
            continue;
        }
        let values = read(table, (c.name, c.unit.text), group.may_lack(c.name), request)?;
        let gaps = values.iter().filter(|value| value.is_nan()).count();
        if gaps > 0 {
            found.warnings.push(format!("`{}` is not measured in {gaps} of {} rows", c.name, values.len()));
        }
        if schema.coordinates.len() == 1 {
            let at = placed.points.coordinates.clone();
            found.measured.push(Measured { name: c.name, at, values: values.clone() });
        }
        columns.push(values);
    }
    Ok(columns)
}

/// Points of a group for which nothing was measured.
fn unmeasured(schema: &Scene, group: &Group, bounds: &[[f64; 2]]) -> Result<Placed, PrepareError> {
    let is_summed = group.terms.iter().any(|term| term.kind == TermKind::Integral);
    let along = |[first, last]: [f64; 2]| -> Vec<f64> {
        (0..COLLOCATION).map(|i| first + (last - first) * collocation(i)).collect()
    };
    let alone = |coordinates: Vec<f64>| Placed { points: coordinates.into(), normals: Vec::new() };
    let mut placed = match (group.place, bounds) {
        (Some(Place { portion: Portion::Inside, domain }), [_]) if !is_summed => {
            let (low, high) = Body::new(domain)?.bounds();
            return Ok(alone(along([low[0], high[0]])));
        }
        (Some(place), _) => Body::new(place.domain)?.sample(place.portion),
        (None, [range]) if range[0] < range[1] => match group.name {
            "start" => return Ok(alone(vec![range[0]])),
            "end" => return Ok(alone(vec![range[1]])),
            _ => {
                let coordinates = along(*range);
                let weights = if is_summed { trapezoids(&coordinates) } else { Vec::new() };
                return Ok(Placed {
                    points: Points { coordinates, weights, ..Points::default() },
                    normals: Vec::new(),
                });
            }
        },
        (None, _) => {
            let names: Vec<&str> = schema.coordinates.iter().map(|axis| axis.name).collect();
            return Err(PrepareError::Nowhere { group: group.name, coordinates: names.join(", ") });
        }
    };
    if !is_summed {
        placed.points.weights = Vec::new();
    }
    Ok(placed)
}

/// Place `i` of the collocation points in [0, 1]: half of them spread evenly, half evenly in the logarithm of the distance
/// from the start, as the network sees it.
fn collocation(i: usize) -> f64 {
    let ratio = Stretched::default().ratio;
    let share = i as f64 / (COLLOCATION - 1) as f64;
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > f64::EPSILON {
        let middle: f64 = 0.5 * (low + high);
        let so_far = 0.5 * (middle + (ratio * middle).ln_1p() / ratio.ln_1p());
        *(if so_far < share { &mut low } else { &mut high }) = middle;
    }
    high
}

/// What each of several points on a line stands for.
fn trapezoids(points: &[f64]) -> Vec<f64> {
    let last = points.len() - 1;
    let side = |i: usize| points[(i + 1).min(last)] - points[i.saturating_sub(1)];
    (0..points.len()).map(|i| side(i) / 2.0).collect()
}

/// Where the answer is wanted.
fn wanted(schema: &Scene, found: &Found, request: &Request) -> Result<Vec<f64>, PrepareError> {
    let axes = schema.coordinates.len();
    let counts = match &request.wanted {
        Some(Wanted::At(path)) => return places(schema, &Table::read_places(path)?, request),
        Some(Wanted::Grid(counts)) if counts.len() == axes => counts.clone(),
        Some(Wanted::Grid(counts)) => {
            let names: Vec<&str> = schema.coordinates.iter().map(|axis| axis.name).collect();
            return Err(PrepareError::Grid { given: counts.len(), coordinates: names.join(", ") });
        }
        None if axes == 1 && !found.places.is_empty() => return Ok(found.places.clone()),
        None => vec![GRID[(axes - 1).min(GRID.len() - 1)]; axes],
    };
    Ok(grid(&counts, &found.bounds, found.body.as_ref()))
}

/// Planes of the first two coordinates: at the start, the middle and the end of the last one, and in the middle of the others.
fn planes(schema: &Scene, found: &Found) -> Vec<(String, Vec<f64>)> {
    let Some((last, [low, high])) = schema.coordinates.iter().zip(&found.bounds).skip(2).last() else {
        return Vec::new();
    };
    let plane = |share: f64| {
        let at = low + share * (high - low);
        let mut bounds = found.bounds.clone();
        bounds.iter_mut().skip(2).for_each(|[low, high]| [*low, *high] = [(*low + *high) / 2.0; 2]);
        if let Some(range) = bounds.last_mut() {
            *range = [at; 2];
        }
        let counts: Vec<usize> = (0..bounds.len()).map(|axis| if axis < 2 { GRID[1] } else { 1 }).collect();
        (format!("{} = {at} {}", last.name, last.unit.text), grid(&counts, &bounds, found.body.as_ref()))
    };
    [0.0, 0.5, 1.0].map(plane).into()
}

/// A grid of points, the first coordinate running fastest, as far as it lies within the body.
fn grid(counts: &[usize], bounds: &[[f64; 2]], body: Option<&Body>) -> Vec<f64> {
    let total: usize = counts.iter().product();
    let point = |index: usize| -> Vec<f64> {
        let mut rest = index;
        let along = counts.iter().zip(bounds).map(|(count, [low, high])| {
            let at = rest % count;
            rest /= count;
            low + (high - low) * if *count > 1 { at as f64 / (count - 1) as f64 } else { 0.5 }
        });
        along.collect()
    };
    (0..total).map(point).filter(|point| body.is_none_or(|body| body.contains(point))).flatten().collect()
}

fn widen(bounds: &mut [[f64; 2]], points: &[f64]) {
    let axes = bounds.len();
    for (at, value) in points.iter().enumerate() {
        let [low, high] = &mut bounds[at % axes];
        (*low, *high) = (low.min(*value), high.max(*value));
    }
}

/// The header that the user chose for a name; the last word counts.
fn header<'a>(request: &'a Request, name: &str) -> Option<&'a str> {
    request.columns.iter().rev().find(|(own, _)| own == name).map(|(_, header)| header.as_str())
}

/// The values of a quantity in its declared unit.
fn read(
    table: &Table,
    (name, unit): (&'static str, &'static str),
    may_lack: bool,
    request: &Request,
) -> Result<Vec<f64>, PrepareError> {
    let values = match (header(request, name), may_lack) {
        (Some(header), false) => table.chosen(name, header, unit)?,
        (Some(header), true) => table.chosen_measured(name, header, unit)?,
        (None, false) => table.quantity(name, unit)?,
        (None, true) => table.measured(name, unit)?,
    };
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest > LARGEST { Err(PrepareError::Size { name, largest, unit }) } else { Ok(values) }
}

/// A file of data must be for a group that there is.
fn check_group(schema: &Scene, group: Option<&str>, path: &Path) -> Result<(), PrepareError> {
    let known: Vec<&str> = schema.groups.iter().filter(|group| !group.is_beliefs()).map(|group| group.name).collect();
    match group.filter(|group| !known.contains(group)) {
        Some(group) => {
            let (group, path) = (group.to_string(), path.to_path_buf());
            Err(PrepareError::Group { hint: hint(&group, &known), group, path, have: known.join(", ") })
        }
        None => Ok(()),
    }
}

/// Every name in `--column` must be one that the scene observes, or a coordinate.
fn check_columns(schema: &Scene, request: &Request) -> Result<(), PrepareError> {
    let observed = schema.groups.iter().flat_map(|group| group.columns).map(|column| column.name);
    let known: Vec<_> = observed.chain(schema.coordinates.iter().map(|axis| axis.name)).collect();
    match request.columns.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        Some((name, _)) => {
            Err(PrepareError::Column { name: name.clone(), hint: hint(name, &known), have: known.join(", ") })
        }
        None => Ok(()),
    }
}

/// Parameters that nobody gave beside data of the user's own.
pub(crate) fn assumed(schema: &Scene, request: &Request) -> Vec<Assumed> {
    let declared =
        schema.scalars.iter().filter(|_| !request.data.is_empty()).filter_map(|scalar| match scalar.origin {
            Origin::Given(Some(value)) if !scalar.name.is_empty() => {
                Some(Assumed { name: scalar.name, value: value / scalar.unit.factor, unit: scalar.unit.text })
            }
            _ => None,
        });
    declared.filter(|assumed| request.parameters.iter().all(|(name, _)| name != assumed.name)).collect()
}
