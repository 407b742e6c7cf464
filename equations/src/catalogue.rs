//! The equations by name, and how a user's request becomes a bound problem.
//!
//! A new equation is one new file with its `pde!` and its entry, and one line in [`catalogue`].

use std::path::{Path, PathBuf};
use std::time::Duration;

use nisp::local::Local;
use nisp::schema::TermKind;
use nisp::{Carrier, Settings};
use nisp::{Problem, SceneRef};
use nisp_data::cloud::LengthUnit;
use nisp_data::nearest_name;

use crate::contact::{Contact, References};
use crate::error::PrepareError;
use crate::rivals::{Answer, Measurements, System, contest, noise_level};
use crate::series::Series;
use crate::tables;
use crate::truth::Truth;
#[cfg(feature = "shipped")]
use crate::{bubble, membrane, pendulum, plate, rlc, sponge};

/// The equations that are shipped.
#[cfg(feature = "shipped")]
// Inlined, the scenes would have every crate that asks compile all kernels again.
#[inline(never)]
pub fn catalogue() -> [Entry; 6] {
    [pendulum::entry(), rlc::entry(), plate::entry(), membrane::entry(), bubble::entry(), sponge::entry()]
}

/// An equation and how it is bound to data.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Its scenes; the first is the default.
    pub scenes: Vec<SceneRef>,
    /// Path of the example's data in the repository; empty if there are none.
    pub data: &'static str,
    /// How it is bound.
    pub binding: Binding,
}

/// How an entry's scenes are bound to what a user asks for.
#[derive(Clone, Copy, Debug)]
pub enum Binding {
    /// To tables over time, one of which is shipped.
    Series(Series),
    /// To tables of its user's own. Files that the equation names are looked for from this folder.
    Tables(&'static Path),
    /// In a way of its own.
    Own(fn(&Entry, &Request) -> Result<Prepared, PrepareError>),
    /// To a point cloud.
    Cloud(fn(&Entry, &Request) -> Result<Prepared, PrepareError>),
}

impl Entry {
    /// An equation of a user's own, bound to tables; nothing if it has no scene.
    pub fn own(scenes: Vec<SceneRef>) -> Option<Self> {
        let schema = scenes.first()?.schema;
        let about = schema.docs.lines().next().unwrap_or_default();
        Some(Self { name: schema.module, about, scenes, data: "", binding: Binding::Tables(Path::new("")) })
    }

    /// The scene of a name, or the default.
    ///
    /// # Errors
    /// No such scene.
    pub fn scene(&self, name: Option<&str>) -> Result<SceneRef, PrepareError> {
        let Some(name) = name else { return Ok(self.scenes[0]) };
        self.scenes.iter().find(|scene| scene.schema.name == name).copied().ok_or_else(|| {
            let have: Vec<_> = self.scenes.iter().map(|scene| scene.schema.name).collect();
            PrepareError::Scene { entry: self.name, scene: name.into(), hint: hint(name, &have), have: have.join(", ") }
        })
    }

    /// Reads what is asked for and binds a scene to it.
    ///
    /// # Errors
    /// A file, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, request: &Request) -> Result<Prepared, PrepareError> {
        if !matches!(self.binding, Binding::Cloud(_)) {
            self.refuse_clouds(request)?;
        }
        if let (Some(wanted), false) = (&request.wanted, matches!(self.binding, Binding::Tables(_))) {
            let option = if matches!(wanted, Wanted::At(_)) { "at" } else { "grid" };
            let instead = "its answer is written where it was measured, or over its own domain";
            return Err(PrepareError::Option { entry: self.name, option, instead });
        }
        match &self.binding {
            Binding::Series(series) => series.prepare(self, request),
            Binding::Tables(folder) => tables::prepare(self, folder, request),
            Binding::Own(prepare) | Binding::Cloud(prepare) => prepare(self, request),
        }
    }

    /// The time within which its answers are usually there.
    pub fn usual_budget(&self) -> Duration {
        Duration::from_secs(if matches!(self.binding, Binding::Cloud(_)) { 30 } else { 10 })
    }

    /// How its scenes over time are bound to tables, if that is what they are.
    pub fn series(&self) -> Option<&Series> {
        match &self.binding {
            Binding::Series(series) => Some(series),
            Binding::Tables(_) | Binding::Own(_) | Binding::Cloud(_) => None,
        }
    }

    /// True if one of its scenes is compared with a cloud.
    fn sees(&self) -> bool {
        let terms = self.scenes.iter().flat_map(|scene| scene.schema.groups).flat_map(|group| group.terms);
        terms.into_iter().any(|term| matches!(term.kind, TermKind::Chamfer { .. }))
    }

    /// Options that are about clouds.
    fn refuse_clouds(&self, request: &Request) -> Result<(), PrepareError> {
        let given = [
            ("sample", request.sample.is_some()),
            ("cloud", request.cloud.is_some()),
            ("unit", request.unit.is_some() && !self.sees()),
            ("calibration", request.calibration.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                let instead = "give its file with --data, and parameters with --set";
                Err(PrepareError::Option { entry: self.name, option, instead })
            }
            None => Ok(()),
        }
    }
}

/// What a user asks for.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Scene of the entry, or its default.
    pub scene: Option<String>,
    /// Tables or a cloud of measurements, or else the example's: each for a group or, without a name, for all that want data.
    pub data: Vec<(Option<String>, PathBuf)>,
    /// Where the answer is wanted, if not where it was measured.
    pub wanted: Option<Wanted>,
    /// File with a sample's parameters and the names of its clouds.
    pub sample: Option<PathBuf>,
    /// Which of the sample's clouds, counted from zero.
    pub cloud: Option<usize>,
    /// Calibration of the sensor that saw the cloud.
    pub calibration: Option<PathBuf>,
    /// Unit of the cloud's coordinates; metres if not given.
    pub unit: Option<LengthUnit>,
    /// Truth to score against.
    pub truth: Option<PathBuf>,
    /// A network even where local functions suit the scene better.
    pub network: bool,
    /// Names and the headers that hold them; the last word on a name counts.
    pub columns: Vec<(String, String)>,
    /// About how many points groups shall have that lie in domains; the last word on a name counts.
    pub points: Vec<(String, usize)>,
    /// Parameters in their declared units; the last word on a name counts.
    pub parameters: Vec<(String, f64)>,
}

impl Request {
    /// The only file of data, for entries that take one.
    ///
    /// # Errors
    /// Several files, or one for a group.
    pub(crate) fn file(&self, entry: &Entry) -> Result<Option<&Path>, PrepareError> {
        match self.data.as_slice() {
            [] => Ok(None),
            [(None, path)] => Ok(Some(path)),
            _ => {
                let instead = "it takes one file: --data FILE";
                Err(PrepareError::Option { entry: entry.name, option: "data GROUP=FILE", instead })
            }
        }
    }
}

/// A bound problem, what was measured, and what is true if that is known.
pub struct Prepared {
    /// The problem.
    pub problem: Problem,
    /// Where the answer is wanted, point by point, in declared units: times of measurements, places in a domain.
    pub points: Vec<f64>,
    /// The edge of a plane domain, for pictures; empty otherwise.
    pub outline: Vec<[f64; 2]>,
    /// Over three coordinates and more, the points of planes to draw, and what they are called; none otherwise.
    pub planes: Vec<(String, Vec<f64>)>,
    /// What was measured over one coordinate.
    pub measured: Vec<Measured>,
    /// Truth, for scoring only.
    pub truth: Option<Truth>,
    /// Where the data came from.
    pub source: String,
    /// What the user should know of the data. One line each.
    pub warnings: Vec<String>,
    /// What was taken as declared beside data of the user's own.
    pub assumed: Vec<Assumed>,
    /// What classical rivals solve, if they know this scene.
    pub rival: Option<Box<dyn System>>,
    /// Local functions, where they suit the scene better than a network.
    pub local: Option<Local>,
    /// The body whose surface was seen, where the data are a cloud.
    pub contact: Option<Contact>,
    /// What a calibration is made from, where the scene makes one.
    pub references: Option<References>,
}

/// A measured column.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its name.
    pub name: &'static str,
    /// The places of its rows.
    pub at: Vec<f64>,
    /// Its values, NaN where nothing was measured.
    pub values: Vec<f64>,
}

/// Where an answer is wanted.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// At the rows of a table with a column for each coordinate.
    At(PathBuf),
    /// On a grid over the domain, so many points along each coordinate.
    Grid(Vec<usize>),
}

/// A parameter or size that nobody gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumed {
    /// Its name.
    pub name: &'static str,
    /// Its declared value, in its declared unit.
    pub value: f64,
    /// The unit.
    pub unit: &'static str,
}

impl Prepared {
    /// Settings with what suits the scene.
    pub fn suited(&self, settings: Settings) -> Settings {
        match self.local {
            Some(local) if settings.carrier == Carrier::Auto => Settings { carrier: Carrier::Local(local), ..settings },
            _ => settings,
        }
    }

    /// What the classical rivals answer at times `at`, where `truth` is true; nothing where none knows this scene. They
    /// are given the noise that they find themselves.
    pub fn contest(&self, at: &[f64], truth: &[f64]) -> Vec<Answer> {
        let Some(system) = &self.rival else { return Vec::new() };
        let states: Vec<&[f64]> = self.measured.iter().map(|measured| measured.values.as_slice()).collect();
        let noise: Result<Vec<f64>, _> = states.iter().map(|values| noise_level(&self.points, values)).collect();
        let answers = noise.and_then(|noise| {
            contest(system.as_ref(), &Measurements { times: &self.points, states: &states, noise: &noise }, at, truth)
        });
        // Rivals that cannot answer have no row in a table.
        answers.unwrap_or_default()
    }
}

pub(crate) fn hint(name: &str, have: &[&str]) -> String {
    nearest_name(name, have.iter().copied()).map_or_else(String::new, |near| format!(", did you mean `{near}`?"))
}
