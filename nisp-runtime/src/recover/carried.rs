//! What every carrier does, whatever carries the heads: it solves a problem, and its answer is read.

use super::course::Course;
use super::{Optimizer, RecoverError, Settings, Width};
use crate::carrier::Kept;
use crate::facts::Answer;
use crate::problem::Bound;
use crate::solve::driver::{Status, Warning};
use crate::solve::state::State;

/// Something that can carry the heads of a scene.
pub(super) trait Carrier: Send {
    /// Its name for users.
    fn name(&self) -> &'static str;
    /// Whether data that its answer misses, while it holds the equations, contradict these. Training may be stuck instead.
    fn is_witness(&self) -> bool {
        false
    }
    /// Solves a problem within the limits of a course, from the start or from the state that the course goes on from.
    fn solve(&self, bound: &Bound, settings: &Settings, course: Course<'_, '_>) -> Result<Solved, RecoverError>;
}

/// A problem as its carrier has solved it.
pub(super) struct Solved {
    pub(super) status: Status,
    pub(super) loss: f64,
    pub(super) iterations: u64,
    pub(super) warnings: Vec<Warning>,
    /// Where the solver stopped.
    pub(super) state: State,
    /// The method that was used, and its name for users.
    pub(super) optimizer: Optimizer,
    pub(super) method: &'static str,
    /// Single precision and then double where it is [`Width::Auto`].
    pub(super) precision: Width,
    pub(super) carried: Box<dyn Carried>,
}

/// A head at some points, in the engine's units.
#[derive(Clone)]
pub(super) struct Values {
    pub(super) values: Vec<f64>,
    pub(super) deviations: Option<Vec<f64>>,
    /// The part of the deviations that only the prior speaks for.
    pub(super) by_prior: Option<Vec<f64>>,
}

impl Values {
    pub(super) fn plain(values: Vec<f64>) -> Self {
        Self { values, deviations: None, by_prior: None }
    }
}

/// An answer on its carrier. All numbers are in the engine's units; points are flat.
pub(super) trait Carried: Send {
    /// Every head at points, without error bars.
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values>;
    /// Every head at points, with error bars where there are any.
    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values>;
    /// Standard deviation of a weighted sum of a head's values at points; none where they are not known jointly.
    fn deviation_of_sum(&self, _head: usize, _points: &[f64], _weights: &[f64]) -> Option<f64> {
        None
    }
    /// Learned scalars and their standard deviations.
    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)>;
    /// By how much some learned scalars may be off together, in the engine's units, as [`super::Solution::learned_together`] has it.
    fn together(&self, _bound: &Bound, _learned: &[usize]) -> Option<Vec<Vec<f64>>> {
        None
    }
    /// How far the rows of a term are off, and what they count as known to.
    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>);
    /// What the verdict is made from.
    fn answer(&mut self, bound: &Bound) -> Answer;
    /// What is kept of it in a file, with what deviations follow from if `bars`.
    fn kept(&mut self, bars: bool) -> Box<dyn Kept>;
}

/// How many heads there are.
pub(super) fn heads(bound: &Bound) -> usize {
    bound.problem.scene().schema.heads.len()
}

/// Values of learned scalars from their parameters, with deviations.
pub(super) fn learned(bound: &Bound, parameters: impl Iterator<Item = (f64, Option<f64>)>) -> Vec<(f64, Option<f64>)> {
    let of = |(learned, (parameter, deviation)): (&crate::engine::Learned, (f64, Option<f64>))| {
        let (value, slope) = learned.map.at(parameter);
        (value, deviation.map(|deviation| deviation * slope.abs()))
    };
    bound.learned.iter().zip(parameters).map(of).collect()
}
