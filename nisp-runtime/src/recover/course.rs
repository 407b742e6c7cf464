//! How a run begins, who watches it and when it ends; in two stages where it changes its precision.

use super::checkpoint::{Checkpoint, CheckpointError};
use super::{Monitor, RecoverError, Report};
use crate::carrier;
use crate::real::Real;
use crate::solve::driver::{Flow, Limits, Outcome, Progress, Run};
use crate::solve::method::Method;
use crate::solve::objective::Objective;
use crate::solve::state::State;
use std::time::Instant;

/// Counter of a state that was reached in double precision after so many steps in single.
const SINGLE_STEPS: &str = "single steps";

/// The course of a run.
pub(super) struct Course<'a, 'm> {
    /// Fingerprint of problem and settings.
    pub(super) fingerprint: u64,
    /// Steps that are left, and the budget from the start on.
    pub(super) limits: Limits,
    /// Preparations and trials of methods count.
    pub(super) start: Instant,
    /// Where to go on from; else from the start.
    pub(super) from: Option<&'a State>,
    pub(super) monitor: &'a mut Monitor<'m>,
    /// Steps in single precision before those in double.
    single: Option<u64>,
}

impl<'a, 'm> Course<'a, 'm> {
    pub(super) fn new(
        fingerprint: u64,
        limits: Limits,
        start: Instant,
        from: Option<&'a State>,
        monitor: &'a mut Monitor<'m>,
    ) -> Self {
        let single = from.and_then(|state| state.counter(SINGLE_STEPS).ok());
        let limits = Limits { iterations: limits.iterations.saturating_sub(single.unwrap_or(0)), ..limits };
        Self { fingerprint, limits, start, from, monitor, single }
    }

    /// Steps and time that are left.
    pub(super) fn left(&self) -> Limits {
        let budget = self.limits.budget.map(|budget| budget.saturating_sub(self.start.elapsed()));
        Limits { budget, ..self.limits }
    }

    /// Shows a carrier's steps to the monitor.
    pub(super) fn watch(&mut self, progress: carrier::Progress<'_>) -> Flow {
        let fingerprint = self.fingerprint;
        (self.monitor)(Report {
            iteration: progress.iteration,
            elapsed_s: progress.elapsed_s,
            loss: progress.loss,
            checkpoint: &|| Checkpoint { fingerprint, state: (progress.checkpoint)() },
        })
    }

    /// The method whose state it goes on from.
    pub(super) fn method(&self) -> Option<&str> {
        self.from.map(|state| state.method.as_str())
    }

    /// True in double precision after single.
    pub(super) fn is_promoted(&self) -> bool {
        self.single.is_some()
    }

    /// True if a run in single precision has not taken all steps.
    pub(super) fn has_steps_after(&self, single: &Outcome<f64>) -> bool {
        single.iterations < self.limits.iterations
    }

    /// Turns to double precision after a run in single.
    pub(super) fn promote(&mut self, single: &Outcome<f64>) {
        self.single = Some(single.iterations);
        self.limits.iterations = self.limits.iterations.saturating_sub(single.iterations);
        self.from = None;
    }

    /// Runs a method.
    pub(super) fn run<E: Real, O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
        &mut self,
        method: &mut M,
        objective: &mut O,
    ) -> Result<Outcome<E>, RecoverError> {
        self.run_until(method, objective, &mut |_, _| false)
    }

    /// Runs a method, until `done` says so of steps and iterate at the latest; such a run counts as interrupted.
    pub(super) fn run_until<E: Real, O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
        &mut self,
        method: &mut M,
        objective: &mut O,
        done: &mut dyn FnMut(u64, &[E]) -> bool,
    ) -> Result<Outcome<E>, RecoverError> {
        let limits = self.left();
        let Self { fingerprint, start, from, monitor, single, .. } = self;
        let marked = |state: State| match *single {
            Some(steps) => state.with_counter(SINGLE_STEPS, steps),
            None => state,
        };
        let steps = single.unwrap_or(0);
        let monitor = &mut |progress: &Progress<'_, E>| {
            let report = Report {
                iteration: steps + progress.iteration,
                elapsed_s: start.elapsed().as_secs_f64(),
                loss: progress.best_loss,
                checkpoint: &|| Checkpoint { fingerprint: *fingerprint, state: marked((progress.checkpoint)()) },
            };
            monitor(report)
        };
        let run = match from {
            None => Run::new(method, limits),
            // What carries the right fingerprint and still does not fit was not written by us.
            Some(state) => Run::restored(method, objective, state, limits).map_err(|_| CheckpointError::Damaged)?,
        };
        let outcome = run.go(method, objective, monitor, done);
        let state = marked(outcome.state);
        let iterations = steps + outcome.iterations;
        Ok(Outcome { state, iterations, ..outcome })
    }
}
