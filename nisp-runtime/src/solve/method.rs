//! What all methods have in common: one step at a time, refused rather than wrong.

use super::fault::Fault;
use super::prior::WeightPrior;
use super::state::State;
use crate::real::Real;

/// A method of minimisation. It owns the iterate and everything it has learnt about the function.
///
/// A method's step ends at an iterate whose loss and gradient it has computed; a trial point with a [`Fault`] or
/// without progress is refused, which leaves the iterate as it was, to the bit.
pub trait Method<E: Real, O: ?Sized> {
    /// Name as users write it.
    fn name(&self) -> &'static str;

    /// The present iterate.
    fn theta(&self) -> &[E];

    /// Takes one step.
    ///
    /// # Errors
    /// A fault that five refused steps in a row did not get around, or one at the starting point.
    fn step(&mut self, objective: &mut O) -> Result<Step, Fault>;

    /// What the method believes of the parameters, if anything, as of now.
    fn prior(&self) -> Option<&WeightPrior> {
        None
    }

    /// Steps after which a schedule has changed the method's steps, whatever they found; none without a schedule.
    fn period(&self) -> Option<u64> {
        None
    }

    /// The whole state, for a checkpoint.
    fn save(&self) -> State;

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// The state is of another method or size, or not finite; then `self` is as it was.
    fn restore(&mut self, state: &State) -> Result<(), Fault>;
}

/// Consecutive faults after which a method stops with an error.
pub(crate) const FAULTS_IN_A_ROW: u64 = 5;

/// What one step did.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Loss at the iterate after the step, with the terms that the method adds (weight prior).
    pub loss: f64,
    /// Euclidean norm of the last gradient: at the iterate after the step, or before it for methods that have no need
    /// of the gradient there yet.
    pub gradient_norm: f64,
    /// Estimate of how far the loss is above its minimum, from the method's quadratic model before the step (half
    /// the squared Newton decrement); methods without a model of curvature give none.
    pub decrement: Option<f64>,
    /// Euclidean length of the step.
    pub length: f64,
    /// Evaluations of the objective.
    pub evaluations: usize,
    /// How it went.
    pub verdict: Verdict,
}

/// How a step went.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The iterate has moved.
    Moved,
    /// The iterate has moved, but the objective has since changed (new assignments), so losses before and after are
    /// not comparable.
    Changed,
    /// The trial point was no better; the next step will be more careful.
    Refused,
    /// The trial point had a fault; the next step will be more careful.
    Faulty(Fault),
    /// No further progress is possible in this precision.
    Exhausted,
}
