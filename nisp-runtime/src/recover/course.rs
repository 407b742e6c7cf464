//! How a run begins, who watches it and when it ends; in two stages where it changes its precision.

use super::checkpoint::{Checkpoint, CheckpointError};
use super::{Monitor, RecoverError, Report};
use crate::real::Real;
use crate::solve::driver::{self, Flow, Limits, Outcome, Progress};
use crate::solve::method::Method;
use crate::solve::objective::Objective;
use crate::solve::state::State;

/// Counter of a state that was reached in double precision after so many steps in single.
const SINGLE_STEPS: &str = "single steps";

/// The course of a run.
pub(super) struct Course<'a, 'm> {
    /// Of problem and settings.
    pub(super) fingerprint: u64,
    /// What is left.
    pub(super) limits: Limits,
    /// Where to go on from; else from the start.
    pub(super) from: Option<&'a State>,
    pub(super) monitor: &'a mut Monitor<'m>,
    /// Steps and seconds in single precision before those in double.
    steps: u64,
    seconds: f64,
}

impl<'a, 'm> Course<'a, 'm> {
    pub(super) fn new(fingerprint: u64, limits: Limits, from: Option<&'a State>, monitor: &'a mut Monitor<'m>) -> Self {
        let steps = from.and_then(|state| state.counter(SINGLE_STEPS).ok()).unwrap_or(0);
        let limits = Limits { iterations: limits.iterations.saturating_sub(steps), ..limits };
        Self { fingerprint, limits, from, monitor, steps, seconds: 0.0 }
    }

    /// The method whose state it goes on from.
    pub(super) fn method(&self) -> Option<&str> {
        self.from.map(|state| state.method.as_str())
    }

    /// True in double precision after single.
    pub(super) fn is_promoted(&self) -> bool {
        self.steps > 0
    }

    /// Turns to double precision after a run in single.
    pub(super) fn promote(&mut self, single: &Outcome<f64>) {
        (self.steps, self.seconds) = (single.iterations, single.wall_s);
        let spent = std::time::Duration::from_secs_f64(single.wall_s);
        self.limits.budget = self.limits.budget.map(|budget| budget.saturating_sub(spent));
        self.limits.iterations = self.limits.iterations.saturating_sub(single.iterations);
        self.from = None;
    }

    /// Runs a method.
    pub(super) fn run<E: Real, O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
        &mut self,
        method: &mut M,
        objective: &mut O,
    ) -> Result<Outcome<E>, RecoverError> {
        self.run_until(method, objective, &mut |_| false)
    }

    /// Runs a method, until `done` says so at the latest; such a run counts as interrupted.
    pub(super) fn run_until<E: Real, O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
        &mut self,
        method: &mut M,
        objective: &mut O,
        done: &mut dyn FnMut(&Progress<'_, E>) -> bool,
    ) -> Result<Outcome<E>, RecoverError> {
        let Self { fingerprint, limits, from, monitor, steps, seconds } = self;
        let marked = |state: State| if *steps > 0 { state.with_counter(SINGLE_STEPS, *steps) } else { state };
        let monitor = &mut |progress: &Progress<'_, E>| {
            let report = Report {
                iteration: *steps + progress.iteration,
                elapsed_s: *seconds + progress.elapsed.as_secs_f64(),
                loss: progress.best_loss,
                checkpoint: &|| Checkpoint { fingerprint: *fingerprint, state: marked((progress.checkpoint)()) },
            };
            if monitor(report) == Flow::Stop || done(progress) { Flow::Stop } else { Flow::Continue }
        };
        let outcome = match from {
            None => driver::run(method, objective, *limits, monitor),
            // What carries the right fingerprint and still does not fit was not written by us.
            Some(state) => driver::resume(method, objective, state, *limits, monitor)
                .map_err(|_| RecoverError::from(CheckpointError::Damaged))?,
        };
        let state = marked(outcome.state);
        let iterations = *steps + outcome.iterations;
        Ok(Outcome { state, iterations, wall_s: *seconds + outcome.wall_s, ..outcome })
    }
}
