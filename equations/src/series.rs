//! Scenes over time: bound to a table with one column for the time and one for each observed field.

use nisp::Problem;
use nisp::network::Stretched;
use nisp::schema::{Origin, Scene};
use nisp_data::Table;
use std::path::Path;

use crate::catalogue::{Assumed, Entry, Prepared, Request, hint};
use crate::copies::noisy_copy;
use crate::error::PrepareError;
use crate::rivals::System;
use crate::truth::{Headers, Truth};

/// What is given besides measurements.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    /// First time of the measurements.
    pub(crate) start: f64,
    /// A parameter's value in its declared unit.
    pub(crate) parameter: &'a dyn Fn(&str) -> f64,
}

/// Times at which the equations are asked to hold.
const COLLOCATION: usize = 300;

/// Place `i` of the collocation points in [0, 1]: half of them spread evenly, half evenly in the logarithm of the time
/// since the start, as the network sees it.
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

/// Products of a few numbers up to this size are finite.
const LARGEST: f64 = 1e60;

/// A scene over time: its example, its truths and its rivals.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    /// The example's measurements.
    pub(crate) data: &'static [u8],
    /// The example's truth.
    pub(crate) truth: &'static [u8],
    /// Columns of the example: name and header.
    pub columns: &'static [(&'static str, &'static str)],
    /// Paths of truths in the repository, from which fresh noisy copies can be made.
    pub truths: &'static [&'static str],
    /// Rows of a truth for each measurement.
    pub every: usize,
    /// The system that classical rivals solve for a scene of this name, where they know how.
    pub(crate) rival: fn(&str, Given<'_>) -> Option<Box<dyn System>>,
}

impl Series {
    /// The repository's truths as if measured anew, `count` times from the first on and then from the beginning: number k
    /// with noise of seed `seed + k`. Without noise every truth comes once at most.
    ///
    /// # Errors
    /// No such files in the folder `repository`, or a scene that the entry does not have.
    pub fn copies(
        &self,
        entry: &Entry,
        request: &Request,
        repository: &Path,
        noise: f64,
        seed: u64,
        count: usize,
    ) -> Result<Vec<Prepared>, PrepareError> {
        let schema = entry.scene(request.scene.as_deref())?.schema;
        let copy = |(index, path): (usize, &&str)| {
            let truth = Table::read(repository.join(path))?;
            let copy = noisy_copy(&truth, schema, self.every, noise, seed.wrapping_add(index as u64))?;
            self.bind(entry, request, &copy, Some(&truth))
        };
        let count = if noise == 0.0 { count.min(self.truths.len()) } else { count };
        self.truths.iter().cycle().take(count).enumerate().map(copy).collect()
    }

    /// Reads the data and binds the scene.
    ///
    /// # Errors
    /// A table, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
        let example = request.data.is_none();
        let table = match &request.data {
            Some(path) => Table::read(path)?,
            None => Table::parse(Path::new(entry.data), self.data)?,
        };
        let truth = match &request.truth {
            Some(path) => Some(Table::read(path)?),
            None if example => Some(Table::parse(Path::new(entry.data), self.truth)?),
            None => None,
        };
        let mut request = request.clone();
        if example {
            let own = self.columns.iter().map(|(name, header)| ((*name).into(), (*header).into()));
            request.columns.splice(0..0, own);
        }
        self.bind(entry, &request, &table, truth.as_ref())
    }

    /// Binds the scene to tables, whatever files the request names.
    ///
    /// # Errors
    /// As [`Series::prepare`].
    pub fn bind(
        &self,
        entry: &Entry,
        request: &Request,
        table: &Table,
        truth: Option<&Table>,
    ) -> Result<Prepared, PrepareError> {
        let scene = entry.scene(request.scene.as_deref())?;
        let schema = scene.schema;
        check_columns(schema, request)?;
        let header = |name: &str| request.columns.iter().rev().find(|(n, _)| n == name).map(|(_, h)| h.as_str());
        let column = |name: &'static str, unit: &'static str, may_lack: bool| {
            let values = match (header(name), may_lack) {
                (Some(header), false) => table.chosen(name, header, unit)?,
                (Some(header), true) => table.chosen_measured(name, header, unit)?,
                (None, false) => table.quantity(name, unit)?,
                (None, true) => table.measured(name, unit)?,
            };
            let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            if largest > LARGEST { Err(PrepareError::Size { name, largest, unit }) } else { Ok(values) }
        };
        let times = column("t", "s", false)?;
        table.require_increasing(header("t").unwrap_or("t"))?;
        let mut problem = Problem::new(scene);
        for (name, value) in &request.parameters {
            problem.set_parameter(name, *value)?;
        }
        let (mut measured, mut warnings) = (Vec::new(), Vec::new());
        let (first, last) = (times[0], times[times.len() - 1]);
        for group in schema.groups {
            let mut columns = Vec::new();
            // A quantity without a column of its own is not measured, as long as another one is.
            let is_lacking = |name: &str| group.may_lack(name) && header(name).is_none() && table.lacks(name);
            let is_any = group.columns.iter().any(|column| !is_lacking(column.name));
            for c in group.columns {
                if is_any && is_lacking(c.name) {
                    let headers = table.headers().collect::<Vec<_>>().join(", ");
                    warnings
                        .push(format!("`{}` is not measured: no column answers to it (columns: {headers})", c.name));
                    columns.push(vec![f64::NAN; times.len()]);
                    continue;
                }
                let values = column(c.name, c.unit.text, group.may_lack(c.name))?;
                let count = values.iter().filter(|value| value.is_nan()).count();
                if count > 0 {
                    warnings.push(format!("`{}` is not measured in {count} of {} rows", c.name, values.len()));
                }
                measured.push((c.name, values.clone()));
                columns.push(values);
            }
            let points: Vec<f64> = match (group.columns.is_empty(), group.name) {
                (false, _) => times.clone(),
                (true, "start") => vec![first],
                (true, _) => (0..COLLOCATION).map(|i| first + (last - first) * collocation(i)).collect(),
            };
            problem.set_group(group.name, points.into(), columns)?;
        }
        let truth =
            truth.map(|truth| Truth::read(truth, schema, Some([first, last]), Headers::default())).transpose()?;
        let source = table.path().display().to_string();
        let rival =
            (self.rival)(schema.name, Given { start: first, parameter: &|name| parameter(schema, request, name) });
        // Rivals know no gaps.
        let rival = rival.filter(|_| warnings.is_empty());
        Ok(Prepared {
            problem,
            points: times,
            outline: Vec::new(),
            measured,
            truth,
            source,
            warnings,
            assumed: assumed(schema, request),
            rival,
            local: None,
            contact: None,
        })
    }
}

/// Every name in `--column` must be one that the scene observes.
fn check_columns(schema: &Scene, request: &Request) -> Result<(), PrepareError> {
    let observed: Vec<_> = schema.groups.iter().flat_map(|group| group.columns).map(|column| column.name).collect();
    let known: Vec<_> = observed.into_iter().chain(["t"]).collect();
    match request.columns.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        Some((name, _)) => {
            Err(PrepareError::Column { name: name.clone(), hint: hint(name, &known), have: known.join(", ") })
        }
        None => Ok(()),
    }
}

/// Parameters that nobody gave beside data of the user's own.
fn assumed(schema: &Scene, request: &Request) -> Vec<Assumed> {
    let declared = schema.scalars.iter().filter(|_| request.data.is_some()).filter_map(|scalar| match scalar.origin {
        Origin::Given(Some(value)) if !scalar.name.is_empty() => {
            Some(Assumed { name: scalar.name, value: value / scalar.unit.factor, unit: scalar.unit.text })
        }
        _ => None,
    });
    declared.filter(|assumed| request.parameters.iter().all(|(name, _)| name != assumed.name)).collect()
}

/// What a parameter was set to, or its declared value.
fn parameter(schema: &Scene, request: &Request, name: &str) -> f64 {
    let asked = request.parameters.iter().rev().find(|(n, _)| n == name).map(|(_, value)| *value);
    let declared = schema.scalars.iter().find(|scalar| scalar.name == name).and_then(|scalar| match scalar.origin {
        Origin::Given(value) => value.map(|value| value / scalar.unit.factor),
        _ => None,
    });
    asked.or(declared).unwrap_or(f64::NAN)
}
