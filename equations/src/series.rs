//! Scenes over time: bound to a table with one column for the time and one for each observed field.

use nisp::{BindError, Problem, SceneRef, scene};
use nisp_data::{DataError, Table};
use std::path::Path;

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
}

/// What a user asks for.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Scene of the entry, or its default.
    pub scene: Option<String>,
    /// Table of measurements, or the example's.
    pub data: Option<std::path::PathBuf>,
    /// Truth to score against.
    pub truth: Option<std::path::PathBuf>,
    /// Names and the headers that hold them.
    pub columns: Vec<(String, String)>,
    /// Parameters in their declared units.
    pub parameters: Vec<(String, f64)>,
}

/// A bound problem, what was measured, and what is true if that is known.
#[derive(Debug)]
pub struct Prepared {
    /// The problem.
    pub problem: Problem,
    /// Times of the measurements.
    pub times: Vec<f64>,
    /// Measured values by field.
    pub measured: Vec<(&'static str, Vec<f64>)>,
    /// Truth, for scoring only.
    pub truth: Option<Table>,
    /// Where the data came from.
    pub source: String,
}

/// Why a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// The table.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The binding.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// A scene that the entry does not have.
    #[error("`{entry}` has no scene `{scene}`; it has: {have}")]
    Scene {
        /// The entry.
        entry: &'static str,
        /// The scene asked for.
        scene: String,
        /// The scenes there are.
        have: String,
    },
    /// A `--column` whose name nothing observes.
    #[error("--column {name}=...: the scene observes no `{name}`; it observes: {have}")]
    Column {
        /// The name given.
        name: String,
        /// The names there are.
        have: String,
    },
}

/// Times at which the equations are asked to hold.
const COLLOCATION: usize = 300;

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
        },
        Entry {
            name: "rlc",
            about: "the voltage that drives a circuit, from the voltage that answers",
            scenes: &[scene::<rlc::recover::Scene>, scene::<rlc::free::Scene>],
            data: "data/rlc/rlc_exponential.csv",
            data_bytes: include_bytes!("../../data/rlc/rlc_exponential.csv"),
            truth_bytes: include_bytes!("../../data/rlc/rlc_exponential.csv"),
            columns: &[("v", "v_V")],
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
        scenes.find(|scene| scene.schema.name == name).ok_or_else(|| PrepareError::Scene {
            entry: self.name,
            scene: name.into(),
            have: self.scenes.iter().map(|scene| scene().schema.name).collect::<Vec<_>>().join(", "),
        })
    }

    /// Reads the data and binds the scene.
    ///
    /// # Errors
    /// A table, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, request: &Request) -> Result<Prepared, PrepareError> {
        let scene = self.scene(request.scene.as_deref())?;
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
        let observed: Vec<_> = scene.schema.groups.iter().flat_map(|group| group.columns).collect();
        if let Some((name, _)) = request.columns.iter().find(|(name, _)| !known(name, &observed)) {
            let have = observed.iter().map(|c| c.name).chain(["t"]).collect::<Vec<_>>().join(", ");
            return Err(PrepareError::Column { name: name.clone(), have });
        }
        let header = |name: &str| -> Option<String> {
            let asked = request.columns.iter().find(|(n, _)| n == name).map(|(_, header)| header.clone());
            let default = self.columns.iter().find(|(n, _)| example && *n == name).map(|(_, header)| (*header).into());
            asked.or(default)
        };
        let column = |name: &str, unit: &str| match header(name) {
            Some(header) => table.column(&header).map(<[f64]>::to_vec),
            None => table.quantity(name, unit).map(<[f64]>::to_vec),
        };
        let times = column("t", "s")?;
        table.require_increasing(&header("t").unwrap_or_else(|| "t".into()))?;
        let mut problem = Problem::new(scene);
        for (name, value) in &request.parameters {
            problem.set_parameter(name, *value)?;
        }
        let mut measured = Vec::new();
        let (first, last) = (times[0], times[times.len() - 1]);
        for group in scene.schema.groups {
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
        let source = request.data.as_ref().map_or_else(|| self.data.into(), |path| path.display().to_string());
        Ok(Prepared { problem, times, measured, truth, source })
    }
}

fn known(name: &str, observed: &[&nisp::schema::Column]) -> bool {
    name == "t" || observed.iter().any(|column| column.name == name)
}
