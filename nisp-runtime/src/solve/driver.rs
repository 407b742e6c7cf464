//! Repeats a method's steps until the answer is good enough, the budget is spent or nothing helps any more.

use super::fault::Fault;
use super::judge::{Judge, Judgement};
use super::method::{Method, Step, Verdict};
use super::state::State;
use crate::real::Real;
use std::time::{Duration, Instant};

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Wall time.
    pub budget: Option<Duration>,
    /// Steps.
    pub iterations: u64,
    /// Estimated distance of the loss from its minimum, relative to the loss, at which the answer counts as converged.
    pub tolerance: f64,
    /// Loss at which the answer counts as converged, however far the minimum is: for exact data, whose minimum is zero.
    pub floor: f64,
    /// Steps without an improvement of the best loss by more than `tolerance` after which the method is given up; ten
    /// times as many for methods without a model of curvature.
    pub patience: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { budget: None, iterations: u64::MAX, tolerance: 1e-6, floor: 0.0, patience: 100 }
    }
}

/// What a monitor sees after every step.
pub struct Progress<'a, E> {
    /// Steps so far.
    pub iteration: u64,
    /// Time since the start.
    pub elapsed: Duration,
    /// The step.
    pub step: &'a Step,
    /// Least loss so far.
    pub best_loss: f64,
    /// The present iterate.
    pub theta: &'a [E],
    /// Gives the method's state, for a checkpoint.
    pub checkpoint: &'a dyn Fn() -> State,
}

/// What a monitor answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Stop here, with the best iterate.
    Stop,
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The loss is as close to its minimum as was asked for.
    Converged,
    /// Time or steps are spent.
    Budget,
    /// The method cannot go on; the warnings say why.
    NotConverged,
    /// The monitor said so.
    Interrupted,
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<E> {
    /// Why it ended.
    pub status: Status,
    /// The iterate with the least loss.
    pub theta: Vec<E>,
    /// Its loss.
    pub loss: f64,
    /// Steps taken.
    pub iterations: u64,
    /// Evaluations of the objective.
    pub evaluations: u64,
    /// Seconds.
    pub wall_s: f64,
    /// What a user should know, each with a remedy.
    pub warnings: Vec<Warning>,
}

/// Something that a user should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// What it is about, for programs.
    pub kind: WarningKind,
    /// One sentence, and a remedy.
    pub message: String,
}

/// Kinds of [`Warning`].
#[derive(Debug, Clone, PartialEq)]
pub enum WarningKind {
    /// A step was refused because of a fault; the run went on unless it is the last.
    Fault(Fault),
    /// The loss no longer falls, though the method expects it to.
    Stagnation,
    /// The accuracy of single precision is reached.
    SinglePrecision,
    /// A direction of the answer that neither equations nor data determine.
    Undetermined,
    /// A condition that the answer rests on: the data alone would leave a direction open.
    Settled,
}

/// What a run remembers of its steps.
struct Record<E> {
    theta: Vec<E>,
    loss: f64,
    /// The function has changed since `loss` was computed.
    changed: bool,
    iterations: u64,
    evaluations: u64,
    warnings: Vec<Warning>,
}

impl<E: Real> Record<E> {
    fn add(&mut self, step: &Step, theta: &[E]) {
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
            warn_of(&mut self.warnings, fault.clone());
        }
    }

    fn finish(self, status: Status, wall: Duration) -> Outcome<E> {
        Outcome {
            status,
            theta: self.theta,
            loss: self.loss,
            iterations: self.iterations,
            evaluations: self.evaluations,
            wall_s: wall.as_secs_f64(),
            warnings: self.warnings,
        }
    }
}

/// Takes steps of `method` on `objective` within `limits`, and shows each to `monitor`.
pub fn run<E: Real, O: ?Sized, M: Method<E, O> + ?Sized>(
    method: &mut M,
    objective: &mut O,
    limits: Limits,
    monitor: &mut dyn FnMut(&Progress<'_, E>) -> Flow,
) -> Outcome<E> {
    let start = Instant::now();
    let mut record = Record {
        theta: method.theta().to_vec(),
        loss: f64::INFINITY,
        changed: false,
        iterations: 0,
        evaluations: 0,
        warnings: Vec::new(),
    };
    let mut judge = Judge::new(limits, E::NAME, E::EPSILON.to_f64());
    let mut clock = Clock::new(limits.budget);
    let status = loop {
        if record.iterations >= limits.iterations || clock.is_spent(start.elapsed()) {
            break Status::Budget;
        }
        let step = match method.step(objective) {
            Ok(step) => step,
            Err(fault) => {
                warn_of(&mut record.warnings, fault);
                break Status::NotConverged;
            }
        };
        record.add(&step, method.theta());
        let elapsed = start.elapsed();
        clock.tick(elapsed);
        let progress = Progress {
            iteration: record.iterations,
            elapsed,
            step: &step,
            best_loss: record.loss,
            theta: method.theta(),
            checkpoint: &|| method.save(),
        };
        if monitor(&progress) == Flow::Stop {
            break Status::Interrupted;
        }
        match judge.judge(&step) {
            Judgement::GoOn => {}
            Judgement::Converged => break Status::Converged,
            Judgement::GiveUp(warning) => {
                record.warnings.push(warning);
                break Status::NotConverged;
            }
        }
    };
    record.finish(status, start.elapsed())
}

/// Adds a warning of a fault, once for each term and kind.
fn warn_of(warnings: &mut Vec<Warning>, fault: Fault) {
    let known = warnings.iter().any(|warning| match &warning.kind {
        WarningKind::Fault(known) => known.term == fault.term && known.what == fault.what,
        _ => false,
    });
    if !known {
        warnings.push(Warning { message: fault.to_string(), kind: WarningKind::Fault(fault) });
    }
}

/// Foresees the end of the next step, so that a budget is kept.
struct Clock {
    budget: Option<Duration>,
    last: Duration,
    /// Longest of the last steps, forgotten slowly.
    longest: Duration,
}

impl Clock {
    fn new(budget: Option<Duration>) -> Self {
        Self { budget, last: Duration::ZERO, longest: Duration::ZERO }
    }

    fn tick(&mut self, elapsed: Duration) {
        let step = elapsed - self.last;
        self.longest = step.max(self.longest.mul_f64(0.9));
        self.last = elapsed;
    }

    /// True where the next step would probably end later than 3 % after the budget.
    fn is_spent(&self, elapsed: Duration) -> bool {
        self.budget.is_some_and(|budget| elapsed >= budget || elapsed + self.longest > budget.mul_f64(1.03))
    }
}
