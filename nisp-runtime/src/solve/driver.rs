//! Repeats a method's steps until the answer is good enough, the budget is spent or nothing helps any more.

use super::fault::Fault;
use super::judge::{Judge, Judgement};
use super::method::{Method, Step};
use super::objective::Objective;
pub use super::outcome::{Limits, Outcome, Status, Warning, WarningKind};
use super::record::Record;
use super::state::State;
use crate::real::Real;
use std::time::{Duration, Instant};

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
