//! When single precision helps no more.
//!
//! Far from a minimum the gradient in single precision is as good as that in double. Close to it the residuals are small
//! differences of large numbers, and the gradient drowns in their rounding, long before the loss stops falling for good.
//! So now and then both are computed and compared.

use crate::engine::{Engine, factors};
use crate::network::Architecture;
use crate::problem::{BindError, Bound};
use crate::solve::objective::Objective;

/// Steps before the first look, and the fewest between two; a look costs as much as three or four of them.
const EVERY: u64 = 128;

/// Error of the gradient in single precision, beside its length, that still lets a step descend well.
const SPENT: f64 = 0.1;

/// Watches a run in single precision.
pub(super) struct Promotion {
    single: Engine<f32>,
    double: Engine<f64>,
    narrow: Vec<f32>,
    wide: Vec<f64>,
    theta: Vec<f64>,
    /// True once double precision is to take over.
    pub(super) due: bool,
}

impl Promotion {
    /// For a run whose rows are weighted as those of `engine`.
    pub(super) fn new(bound: &Bound, architecture: Architecture, engine: &Engine<f64>) -> Result<Self, BindError> {
        let (mut single, mut double): (Engine<f32>, Engine<f64>) =
            (bound.engine(architecture)?, bound.engine(architecture)?);
        factors::alike(&mut single, engine);
        factors::alike(&mut double, engine);
        let len = engine.parameters();
        Ok(Self { single, double, narrow: vec![0.0; len], wide: vec![0.0; len], theta: vec![0.0; len], due: false })
    }

    /// Looks after so many steps, if it is time to: late in a run the gradient fades slowly, and from a sixteenth
    /// to an eighth of the steps may pass between looks. True from when on single precision helps no more.
    pub(super) fn is_due(&mut self, steps: u64, theta: &[f32]) -> bool {
        let apart = (steps / 16).next_power_of_two().max(EVERY);
        if steps > 0 && steps.is_multiple_of(apart) {
            self.theta.iter_mut().zip(theta).for_each(|(wide, narrow)| *wide = f64::from(*narrow));
            // Clouds are assigned anew, as they were for the step.
            self.single.accepted(theta);
            self.double.accepted(&self.theta);
            let known = self.single.loss_and_gradient(theta, &mut self.narrow).is_ok()
                && self.double.loss_and_gradient(&self.theta, &mut self.wide).is_ok();
            let square = |x: f64| x * x;
            let length: f64 = self.wide.iter().copied().map(square).sum();
            let error: f64 = self.wide.iter().zip(&self.narrow).map(|(a, b)| square(a - f64::from(*b))).sum();
            self.due = known && error > square(SPENT) * length;
        }
        self.due
    }
}
