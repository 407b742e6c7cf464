//! An experiment whose truth is known, and how its measurements become a problem.

use nisp::{Carrier, Points, Problem, SceneRef};

use super::corruption::Corruption;
use super::samples::Samples;

/// A value that a condition of the scene states.
#[derive(Clone, Debug)]
pub(super) struct Stated {
    pub(super) head: &'static str,
    pub(super) at: Vec<f64>,
    pub(super) value: f64,
    /// How large the quantity is elsewhere.
    pub(super) size: f64,
}

/// What is true of the unknowns.
#[derive(Clone, Default)]
pub(super) struct Truth {
    /// Points at which heads are compared, in declared units, point by point.
    pub(super) points: Vec<f64>,
    /// Unknown heads with their values there.
    pub(super) heads: Vec<(&'static str, Vec<f64>)>,
    /// Learned parameters.
    pub(super) scalars: Vec<(&'static str, f64)>,
    /// What an error is compared with where the true value is zero.
    pub(super) size: f64,
    /// Relative error without bars from which on an answer is wrong, if not that of unknown sources.
    pub(super) limit: Option<f64>,
}

/// A problem, ready to be solved, and what is true of it.
pub(super) struct Ready {
    pub(super) problem: Problem,
    pub(super) carrier: Carrier,
    pub(super) stated: Vec<Stated>,
    pub(super) truth: Truth,
}

/// Values of parameters that are told to the scene, over the declared ones.
pub(super) type Told<'a> = &'a [(&'static str, f64)];

/// How measurements are bound.
pub(super) type Bind = Box<dyn Fn(&Samples, Told<'_>) -> Result<Ready, String>>;

/// An experiment: exact measurements, the size of their noise, and how they are bound.
pub(super) struct Experiment {
    pub(super) samples: Samples,
    /// Standard deviation of the noise over the spread of a column.
    pub(super) noise: f64,
    pub(super) bind: Bind,
}

impl Experiment {
    /// With a parameter that has no declared value.
    pub(super) fn with(self, name: &'static str, value: f64) -> Self {
        let bind = move |samples: &Samples, told: Told<'_>| (self.bind)(samples, &[&[(name, value)], told].concat());
        Self { bind: Box::new(bind), samples: self.samples, noise: self.noise }
    }
}

/// Whether an experiment follows the equations of its scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Physics {
    Scene,
    Other,
    /// A scene that states something else.
    Stated(&'static str),
}

/// A corruption of an experiment.
pub(super) struct Case {
    pub(super) corruption: Corruption,
    /// False where another source explains the same data exactly, so that nobody can tell.
    pub(super) can_be_told: bool,
}

/// Cases that data can tell, and cases that they cannot.
pub(super) fn cases(told: &[Corruption], hidden: &[Corruption]) -> Vec<Case> {
    let of = |can_be_told| move |corruption: &Corruption| Case { corruption: *corruption, can_be_told };
    told.iter().map(of(true)).chain(hidden.iter().map(of(false))).collect()
}

/// An equation, its experiment and the cases to look at.
pub(super) struct Subject {
    pub(super) name: &'static str,
    pub(super) make: Box<dyn Fn(Physics) -> Result<Experiment, String>>,
    pub(super) cases: Vec<Case>,
    /// How many times longer than others it may take.
    pub(super) patience: f64,
}

/// An equation bound to points that measurements do not change.
#[derive(Clone)]
pub(super) struct Plain {
    pub(super) scene: SceneRef,
    /// Groups without measurements: name, points and columns.
    pub(super) groups: Vec<(&'static str, Points, Vec<Vec<f64>>)>,
    /// The group of the measurements.
    pub(super) observed: &'static str,
    pub(super) stated: Vec<Stated>,
    pub(super) truth: Truth,
}

impl Plain {
    /// The experiment with its measurements.
    pub(super) fn measured(self, samples: Samples, noise: f64) -> Experiment {
        let bind = move |samples: &Samples, told: Told<'_>| {
            let mut problem = Problem::new(self.scene);
            for &(name, value) in told {
                problem.set_parameter(name, value).map_err(|error| error.to_string())?;
            }
            for (name, points, columns) in self.groups.iter().cloned() {
                problem.set_group(name, points, columns).map_err(|error| error.to_string())?;
            }
            let own = problem.set_group(self.observed, samples.places().into(), samples.measured());
            own.map_err(|error| error.to_string())?;
            let Self { mut stated, truth, .. } = self.clone();
            for stated in &mut stated {
                // Of data in a wrong unit.
                let own = samples.columns.iter().filter(|column| column.name == stated.head);
                stated.size = own.flat_map(|column| &column.values).fold(stated.size, |size, x| size.max(x.abs()));
            }
            Ok(Ready { problem, carrier: Carrier::Auto, stated, truth }) as Result<Ready, String>
        };
        Experiment { samples, noise, bind: Box::new(bind) }
    }
}

/// Evenly spread numbers, ends included.
pub(super) fn line(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

/// A lattice in a rectangle, ends included: places along the first and the second axis, flat.
pub(super) fn lattice(first: &[f64], second: &[f64]) -> Vec<f64> {
    second.iter().flat_map(|y| first.iter().flat_map(move |x| [*x, *y])).collect()
}

/// Every second number, from the first or second on.
pub(super) fn axis(flat: &[f64], at: usize) -> Vec<f64> {
    flat.iter().skip(at).step_by(2).copied().collect()
}
