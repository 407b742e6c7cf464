//! What a run remembers of its steps.

use std::time::Duration;

use super::fault::{Fault, Kind};
use super::method::{Step, Verdict};
use super::outcome::{Outcome, Status, Warning, WarningKind};
use super::state::State;
use crate::real::Real;

/// The best iterate so far, and what was met on the way.
pub(super) struct Record<E> {
    theta: Vec<E>,
    pub(super) loss: f64,
    /// The function has changed since `loss` was computed.
    changed: bool,
    pub(super) iterations: u64,
    evaluations: u64,
    pub(super) warnings: Vec<Warning>,
}

/// Begins the name of a counter that stands for a fault: its kind, a colon, its term.
const FAULT: &str = "fault ";

impl<E: Real> Record<E> {
    pub(super) fn new(theta: &[E]) -> Self {
        Self {
            theta: theta.to_vec(),
            loss: f64::INFINITY,
            changed: false,
            iterations: 0,
            evaluations: 0,
            warnings: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, step: &Step, theta: &[E]) {
        self.iterations += 1;
        self.evaluations += step.evaluations as u64;
        let now_changed = step.verdict == Verdict::Changed;
        // Losses before and after a change are those of different functions.
        if self.changed || now_changed || step.loss < self.loss {
            self.theta.copy_from_slice(theta);
            self.loss = step.loss;
        }
        self.changed = now_changed;
        if let Verdict::Faulty(fault) = &step.verdict {
            self.warn_of(fault.clone());
        }
    }

    /// Adds a warning of a fault, once for each term and kind.
    pub(super) fn warn_of(&mut self, fault: Fault) {
        let known = self.faults().any(|known| known.term == fault.term && known.what == fault.what);
        if !known {
            self.warnings.push(Warning { message: fault.to_string(), kind: WarningKind::Fault(fault) });
        }
    }

    fn faults(&self) -> impl Iterator<Item = &Fault> {
        self.warnings.iter().filter_map(|warning| match &warning.kind {
            WarningKind::Fault(fault) => Some(fault),
            _ => None,
        })
    }

    /// Adds itself to the state of the method.
    pub(super) fn save(&self, method: State) -> State {
        let loss = Some(self.loss).filter(|loss| loss.is_finite());
        let mut state = method
            .with("best theta", &self.theta)
            .with("best loss", loss.as_slice())
            .with_counter("changed", self.changed.into())
            .with_counter("iterations", self.iterations)
            .with_counter("evaluations", self.evaluations);
        for fault in self.faults() {
            let point = fault.point.map_or(0, |point| point as u64 + 1);
            state = state.with_counter(&format!("{FAULT}{}:{}", fault.what.code(), fault.term), point);
        }
        state
    }

    /// The record of a run over `len` parameters.
    pub(super) fn restore(state: &State, len: usize) -> Result<Self, Fault> {
        let mut record = Self {
            theta: state.sized("best theta", len)?,
            loss: state.vector("best loss")?.first().copied().unwrap_or(f64::INFINITY),
            changed: state.counter("changed")? != 0,
            iterations: state.counter("iterations")?,
            evaluations: state.counter("evaluations")?,
            warnings: Vec::new(),
        };
        for (name, point) in &state.counters {
            let Some((code, term)) = name.strip_prefix(FAULT).and_then(|name| name.split_once(':')) else { continue };
            let what = Kind::from_code(code).ok_or_else(|| Fault::state(name))?;
            record.warn_of(Fault { term: term.into(), point: point.checked_sub(1).map(|point| point as usize), what });
        }
        Ok(record)
    }

    pub(super) fn finish(self, status: Status, wall: Duration, state: State) -> Outcome<E> {
        Outcome {
            status,
            theta: self.theta,
            loss: self.loss,
            iterations: self.iterations,
            evaluations: self.evaluations,
            wall_s: wall.as_secs_f64(),
            warnings: self.warnings,
            state,
        }
    }
}
