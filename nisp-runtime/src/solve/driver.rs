//! Repeats a method's steps until the answer is good enough, the budget is spent or nothing helps any more.

use super::fault::Fault;
use super::judge::{Judge, Judgement};
use super::method::{Method, Step};
use super::objective::Objective;
use super::record::Record;
use super::state::State;
use crate::real::Real;
use std::time::{Duration, Instant};

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Wall time; one step is taken even where it is spent.
    pub budget: Option<Duration>,
    /// Steps.
    pub iterations: u64,
    /// Estimated distance of the loss from its minimum, relative to the loss, at which the answer counts as converged.
    pub tolerance: f64,
    /// Loss at which the answer counts as converged, however far the minimum is: for exact data, whose minimum is zero.
    pub floor: f64,
    /// Steps without an improvement of the best loss by more than `tolerance` after which the method is given up; ten
    /// times as many for methods without a model of curvature, and two periods of a schedule at least.
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
    /// Gives the state of the run, for [`resume`].
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
    /// Where the run stopped, for [`resume`].
    pub state: State,
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
    /// Data or an equation that the network does not follow, or data that it follows into their noise.
    Unresolved,
    /// A direction of the answer that neither equations nor data determine.
    Undetermined,
    /// A condition that the answer rests on: the data alone would leave a direction open.
    Settled,
}

/// Takes steps of `method` on `objective` within `limits`, and shows each to `monitor`.
pub fn run<E: Real, O: ?Sized, M: Method<E, O> + ?Sized>(
    method: &mut M,
    objective: &mut O,
    limits: Limits,
    monitor: &mut dyn FnMut(&Progress<'_, E>) -> Flow,
) -> Outcome<E> {
    let judge = Judge::new(limits, method.period(), E::NAME, E::EPSILON.to_f64());
    let record = Record::new(method.theta());
    go(method, objective, limits, monitor, record, judge)
}

/// Goes on from a state that a run with the same method, objective and settings has left: every later iterate has the same
/// bits as if that run had not stopped. Steps count from its beginning, time from now.
///
/// # Errors
/// The state is of another method or size, or not finite.
pub fn resume<E: Real, O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
    method: &mut M,
    objective: &mut O,
    state: &State,
    limits: Limits,
    monitor: &mut dyn FnMut(&Progress<'_, E>) -> Flow,
) -> Result<Outcome<E>, Fault> {
    let mut judge = Judge::new(limits, method.period(), E::NAME, E::EPSILON.to_f64());
    judge.restore(state)?;
    let record = Record::restore(state, method.theta().len())?;
    method.restore(state)?;
    // What is frozen during a step is that of the last accepted iterate.
    objective.accepted(method.theta());
    Ok(go(method, objective, limits, monitor, record, judge))
}

fn go<E: Real, O: ?Sized, M: Method<E, O> + ?Sized>(
    method: &mut M,
    objective: &mut O,
    limits: Limits,
    monitor: &mut dyn FnMut(&Progress<'_, E>) -> Flow,
    mut record: Record<E>,
    mut judge: Judge,
) -> Outcome<E> {
    let start = Instant::now();
    let mut clock = Clock::new(limits.budget);
    let mut moved = false;
    let status = loop {
        // Without a step there would be nothing to say of the iterate, not even its loss.
        if record.iterations >= limits.iterations || moved && clock.is_spent(start.elapsed()) {
            break Status::Budget;
        }
        moved = true;
        let step = match method.step(objective) {
            Ok(step) => step,
            Err(fault) => {
                record.warn_of(fault);
                break Status::NotConverged;
            }
        };
        record.add(&step, method.theta());
        let elapsed = start.elapsed();
        clock.tick(elapsed);
        let judgement = judge.judge(&step);
        let progress = Progress {
            iteration: record.iterations,
            elapsed,
            step: &step,
            best_loss: record.loss,
            theta: method.theta(),
            checkpoint: &|| judge.save(record.save(method.save())),
        };
        if monitor(&progress) == Flow::Stop {
            break Status::Interrupted;
        }
        match judgement {
            Judgement::GoOn => {}
            Judgement::Converged => break Status::Converged,
            Judgement::GiveUp(warning) => {
                record.warnings.push(warning);
                break Status::NotConverged;
            }
        }
    };
    let state = judge.save(record.save(method.save()));
    record.finish(status, start.elapsed(), state)
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
