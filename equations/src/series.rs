//! Scenes over time: bound to a table with one column for the time and one for each observed field.

use nisp::schema::{Origin, Scene};
use nisp::{Problem, SceneRef, scene};
use nisp_data::{Table, nearest_name};
use std::path::{Path, PathBuf};

use crate::error::PrepareError;
use crate::rivals::{Answer, Measurements, System, contest, noise_level};
use crate::truth::Truth;

/// An equation that the command line knows by name.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Its scenes; the first is the default.
    pub scenes: &'static [fn() -> SceneRef],
    /// Path of the example's data in the repository.
    pub data: &'static str,
    data_bytes: &'static [u8],
    truth_bytes: &'static [u8],
    /// Columns of the example: name and header.
    pub columns: &'static [(&'static str, &'static str)],
    /// Paths of truths in the repository, from which fresh noisy copies can be made.
    pub truths: &'static [&'static str],
    /// Rows of a truth for each measurement.
    pub every: usize,
    /// The system that classical rivals solve for a scene of this name, where they know how.
    rival: fn(&str, Given<'_>) -> Option<Box<dyn System>>,
}

/// What is given besides measurements.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    /// First time of the measurements.
    pub(crate) start: f64,
    /// A parameter's value in its declared unit.
    pub(crate) parameter: &'a dyn Fn(&str) -> f64,
}

/// What a user asks for.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Scene of the entry, or its default.
    pub scene: Option<String>,
    /// Table of measurements, or the example's.
    pub data: Option<PathBuf>,
    /// Truth to score against.
    pub truth: Option<PathBuf>,
    /// Names and the headers that hold them; the last word on a name counts.
    pub columns: Vec<(String, String)>,
    /// Parameters in their declared units; the last word on a name counts.
    pub parameters: Vec<(String, f64)>,
}

/// A bound problem, what was measured, and what is true if that is known.
pub struct Prepared {
    /// The problem.
    pub problem: Problem,
    /// Times of the measurements.
    pub times: Vec<f64>,
    /// Measured values by field.
    pub measured: Vec<(&'static str, Vec<f64>)>,
    /// Truth, for scoring only.
    pub truth: Option<Truth>,
    /// Where the data came from.
    pub source: String,
    /// What classical rivals solve, if they know this scene.
    pub rival: Option<Box<dyn System>>,
}

impl Prepared {
    /// What the classical rivals answer at times `at`, where `truth` is true; nothing where none knows this scene. They
    /// are given the noise that they find themselves.
    pub fn contest(&self, at: &[f64], truth: &[f64]) -> Vec<Answer> {
        let Some(system) = &self.rival else { return Vec::new() };
        let states: Vec<&[f64]> = self.measured.iter().map(|(_, values)| values.as_slice()).collect();
        let noise: Result<Vec<f64>, _> = states.iter().map(|values| noise_level(&self.times, values)).collect();
        let answers = noise.and_then(|noise| {
            contest(system.as_ref(), &Measurements { times: &self.times, states: &states, noise: &noise }, at, truth)
        });
        // Rivals that cannot answer have no row in a table.
        answers.unwrap_or_default()
    }
}

/// Times at which the equations are asked to hold.
const COLLOCATION: usize = 300;

/// Products of a few numbers up to this size are finite.
const LARGEST: f64 = 1e60;

/// Everything that the command line can solve.
pub fn catalogue() -> [Entry; 2] {
    use crate::{pendulum::pendulum, rlc::rlc};
    [
        Entry {
            name: "pendulum",
            about: "the force on a cart with two links, from noisy positions and angles",
            scenes: &[scene::<pendulum::recover::Scene>],
            data: "data/pendulum/run_07_obs.csv",
            data_bytes: include_bytes!("../../data/pendulum/run_07_obs.csv"),
            truth_bytes: include_bytes!("../../data/pendulum/run_07_truth.csv"),
            columns: &[("q", "q_m_sigma0.01"), ("psi", "psi_rad_sigma0.01"), ("phi", "phi_rad_sigma0.01")],
            truths: &[
                "data/pendulum/run_01_truth.csv",
                "data/pendulum/run_03_truth.csv",
                "data/pendulum/run_05_truth.csv",
                "data/pendulum/run_07_truth.csv",
                "data/pendulum/run_09_truth.csv",
                "data/pendulum/run_11_truth.csv",
                "data/pendulum/run_13_truth.csv",
                "data/pendulum/run_15_truth.csv",
                "data/pendulum/run_17_truth.csv",
                "data/pendulum/run_19_truth.csv",
                "data/pendulum/run_21_truth.csv",
                "data/pendulum/run_23_truth.csv",
            ],
            every: 4,
            rival: crate::pendulum::rival,
        },
        Entry {
            name: "rlc",
            about: "the voltage that drives a circuit, from the voltage that answers",
            scenes: &[scene::<rlc::recover::Scene>, scene::<rlc::free::Scene>],
            data: "data/rlc/rlc_exponential.csv",
            data_bytes: include_bytes!("../../data/rlc/rlc_exponential.csv"),
            truth_bytes: include_bytes!("../../data/rlc/rlc_exponential.csv"),
            columns: &[("v", "v_V")],
            truths: &["data/rlc/rlc_exponential.csv"],
            every: 3,
            rival: crate::rlc::rival,
        },
    ]
}

impl Entry {
    /// The scene of a name, or the default.
    ///
    /// # Errors
    /// No such scene.
    pub fn scene(&self, name: Option<&str>) -> Result<SceneRef, PrepareError> {
        let mut scenes = self.scenes.iter().map(|scene| scene());
        let Some(name) = name else { return Ok(self.scenes[0]()) };
        scenes.find(|scene| scene.schema.name == name).ok_or_else(|| {
            let have: Vec<_> = self.scenes.iter().map(|scene| scene().schema.name).collect();
            PrepareError::Scene { entry: self.name, scene: name.into(), hint: hint(name, &have), have: have.join(", ") }
        })
    }

    /// Reads the data and binds the scene.
    ///
    /// # Errors
    /// A table, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, request: &Request) -> Result<Prepared, PrepareError> {
        let example = request.data.is_none();
        let table = match &request.data {
            Some(path) => Table::read(path)?,
            None => Table::parse(Path::new(self.data), self.data_bytes)?,
        };
        let truth = match &request.truth {
            Some(path) => Some(Table::read(path)?),
            None if example => Some(Table::parse(Path::new(self.data), self.truth_bytes)?),
            None => None,
        };
        let mut request = request.clone();
        if example {
            let own = self.columns.iter().map(|(name, header)| ((*name).into(), (*header).into()));
            request.columns.splice(0..0, own);
        }
        self.bind(&request, &table, truth.as_ref())
    }

    /// Binds the scene to tables, whatever files the request names.
    ///
    /// # Errors
    /// As [`Entry::prepare`].
    pub fn bind(&self, request: &Request, table: &Table, truth: Option<&Table>) -> Result<Prepared, PrepareError> {
        let scene = self.scene(request.scene.as_deref())?;
        let schema = scene.schema;
        check_columns(schema, request)?;
        let header = |name: &str| request.columns.iter().rev().find(|(n, _)| n == name).map(|(_, h)| h.as_str());
        let column = |name: &'static str, unit: &'static str| {
            let values = match header(name) {
                Some(header) => table.chosen(name, header, unit)?,
                None => table.quantity(name, unit)?,
            };
            let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            if largest > LARGEST { Err(PrepareError::Size { name, largest, unit }) } else { Ok(values) }
        };
        let times = column("t", "s")?;
        table.require_increasing(header("t").unwrap_or("t"))?;
        let mut problem = Problem::new(scene);
        for (name, value) in &request.parameters {
            problem.set_parameter(name, *value)?;
        }
        let mut measured = Vec::new();
        let (first, last) = (times[0], times[times.len() - 1]);
        for group in schema.groups {
            let mut columns = Vec::new();
            for c in group.columns {
                let values = column(c.name, c.unit.text)?;
                measured.push((c.name, values.clone()));
                columns.push(values);
            }
            let points: Vec<f64> = match (group.columns.is_empty(), group.name) {
                (false, _) => times.clone(),
                (true, "start") => vec![first],
                (true, _) => {
                    (0..COLLOCATION).map(|i| first + (last - first) * i as f64 / (COLLOCATION - 1) as f64).collect()
                }
            };
            problem.set_group(group.name, points.into(), columns)?;
        }
        let truth = truth.map(|truth| Truth::read(truth, schema, [first, last])).transpose()?;
        let source = table.path().display().to_string();
        let rival =
            (self.rival)(schema.name, Given { start: first, parameter: &|name| parameter(schema, request, name) });
        Ok(Prepared { problem, times, measured, truth, source, rival })
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

fn hint(name: &str, have: &[&str]) -> String {
    nearest_name(name, have.iter().copied()).map_or_else(String::new, |near| format!(", did you mean `{near}`?"))
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
