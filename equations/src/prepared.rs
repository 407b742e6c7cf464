//! An equation bound to data, with what scores and draws its answer.

use std::time::SystemTime;

use nisp::local::Local;
use nisp::{Carrier, Problem, Settings};

use crate::contact::{Contact, References};
use crate::frames::Frames;
use crate::rivals::{Answer, Measurements, RivalError, System, contest, noise_level};
use crate::truth::Truth;

/// Rivals have no way to be quick on more measurements than this.
const MOST_ROWS: usize = 2000;

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
    /// What was measured.
    pub measured: Vec<Measured>,
    /// Truth, for scoring only.
    pub truth: Option<Truth>,
    /// Where the data came from.
    pub source: String,
    /// From when the dates of the data are counted; none where they hold none.
    pub begin: Option<SystemTime>,
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
    /// How further clouds of the same body are bound, where they can come one after the other.
    pub frames: Option<Frames>,
}

/// A measured column.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its name.
    pub name: &'static str,
    /// The places of its rows, point by point.
    pub at: Vec<f64>,
    /// Its values, NaN where nothing was measured.
    pub values: Vec<f64>,
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

    /// What the classical rivals answer at times `at`, where `truth` is true. They are given the noise that they find
    /// themselves.
    ///
    /// # Errors
    /// None knows this scene, or can read these measurements.
    pub fn contest(&self, at: &[f64], truth: &[f64]) -> Result<Vec<Answer>, RivalError> {
        let system = self.rival.as_ref().ok_or(RivalError::Unknown)?;
        if self.points.len() > MOST_ROWS {
            return Err(RivalError::Input(format!("more than {MOST_ROWS} rows take them too long")));
        }
        let states: Vec<&[f64]> = self.measured.iter().map(|measured| measured.values.as_slice()).collect();
        if states.iter().any(|values| values.iter().any(|value| value.is_nan())) {
            return Err(RivalError::Input("they know no gaps, and the record has some".into()));
        }
        let noise: Vec<f64> =
            states.iter().map(|values| noise_level(&self.points, values)).collect::<Result<_, RivalError>>()?;
        contest(system.as_ref(), &Measurements { times: &self.points, states: &states, noise: &noise }, at, truth)
    }
}
