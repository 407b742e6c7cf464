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
    /// The method ended at a minimum, and what is left of the equations, conditions or data says that it is not the answer.
    Inconsistent,
}

impl Status {
    /// In files and for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Budget => "budget",
            Self::NotConverged => "not_converged",
            Self::Interrupted => "interrupted",
            Self::Inconsistent => "inconsistent",
        }
    }
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

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
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
    /// Something that was not looked at, because the budget was spent.
    OutOfTime,
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
    Run::new(method, limits).go(method, objective, monitor, &mut |_, _| false)
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
    Ok(Run::restored(method, objective, state, limits)?.go(method, objective, monitor, &mut |_, _| false))
}

/// A run between two steps.
pub(crate) struct Run<E> {
    limits: Limits,
    record: Record<E>,
    judge: Judge,
}

impl<E: Real> Run<E> {
    /// At the start of `method`.
    pub(crate) fn new<O: ?Sized, M: Method<E, O> + ?Sized>(method: &M, limits: Limits) -> Self {
        let judge = Judge::new(limits, method.period(), E::NAME, E::EPSILON.to_f64());
        Self { limits, record: Record::new(method.theta()), judge }
    }

    /// Where a saved run stopped.
    pub(crate) fn restored<O: Objective<E> + ?Sized, M: Method<E, O> + ?Sized>(
        method: &mut M,
        objective: &mut O,
        state: &State,
        limits: Limits,
    ) -> Result<Self, Fault> {
        let mut judge = Judge::new(limits, method.period(), E::NAME, E::EPSILON.to_f64());
        judge.restore(state)?;
        let record = Record::restore(state, method.theta().len())?;
        method.restore(state)?;
        // What is frozen during a step is that of the last accepted iterate.
        objective.accepted(method.theta());
        Ok(Self { limits, record, judge })
    }

    /// Takes steps until the end. `done` sees the number of steps and the iterate before each step, and may end the run too;
    /// what it answers must follow from them alone, so that it answers the same to whoever goes on from here.
    pub(crate) fn go<O: ?Sized, M: Method<E, O> + ?Sized>(
        self,
        method: &mut M,
        objective: &mut O,
        monitor: &mut dyn FnMut(&Progress<'_, E>) -> Flow,
        done: &mut dyn FnMut(u64, &[E]) -> bool,
    ) -> Outcome<E> {
        let Self { limits, mut record, mut judge } = self;
        let start = Instant::now();
        let mut clock = Clock::new(limits.budget);
        let mut moved = false;
        let status = loop {
            // The last step may have been the last of a run that stopped there before it could say so.
            match judge.judgement() {
                Judgement::GoOn => {}
                Judgement::Converged => break Status::Converged,
                Judgement::GiveUp => {
                    record.warnings.push(judge.warning());
                    break Status::NotConverged;
                }
            }
            // Without a step there would be nothing to say of the iterate, not even its loss.
            if record.iterations >= limits.iterations || moved && clock.is_spent(start.elapsed()) {
                break Status::Budget;
            }
            if done(record.iterations, method.theta()) {
                break Status::Interrupted;
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
            judge.judge(&step);
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
        };
        let state = judge.save(record.save(method.save()));
        record.finish(status, start.elapsed(), state)
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
