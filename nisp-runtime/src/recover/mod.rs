//! From a bound problem to its solution: one call.
//!
//! [`recover`] chooses how rows are weighted and which method minimises them, runs it within a budget, and reads the
//! answer back in the user's units.

mod bars;
mod carried;
mod checkpoint;
mod choice;
mod compared;
mod course;
mod edges;
mod layers;
mod misfits;
mod network;
mod noisiness;
mod on_lattice;
mod on_splines;
mod open;
mod over_domain;
mod promotion;
mod resolution;
mod session;
mod settings;
mod solution;
mod spread;
mod trained;
mod undetermined;
mod weigh;
mod words;

use std::time::Instant;

use thiserror::Error;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use choice::beyond_splines;
pub use misfits::Misfits;
pub use session::Session;
pub use settings::{Carrier, Optimizer, Settings, Width};
pub use solution::{LearnedValue, Solution, TermReport};

use course::Course;

use crate::local::LocalError;
use crate::memory::Exceeded;
use crate::problem::{BindError, Bound, Problem};
use crate::solve::driver::{Flow, Limits, Status};
use crate::solve::evidence::Belief;
use crate::solve::fault::Fault;
use crate::solve::state::State;
use crate::splines::SplineError;
use crate::verdict::settled;

/// What is believed of the precision of weights before any row is seen: a network whose heads change by a few times their
/// natural size. Worth so few parameters, it matters only where the data say next to nothing.
const BELIEF: Belief = Belief { precision: 0.3, count: 4.0 };

/// Why there is no solution.
#[derive(Debug, Error)]
pub enum RecoverError {
    /// The problem is not fully or not sensibly bound.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// A term cannot be evaluated where the solver starts.
    #[error("{0}")]
    Fault(#[from] Fault),
    /// A method that does not work in the precision asked for.
    #[error("optimizer {optimizer} works in f64 only; give --precision f64, or choose adam or lbfgs")]
    Precision {
        /// The method.
        optimizer: &'static str,
    },
    /// Matrices too large for the method.
    #[error(
        "optimizer {optimizer} is too costly for {parameters} parameters and {rows} rows; choose a smaller width, or \
         optimizer lbfgs or adam"
    )]
    Size {
        /// The method.
        optimizer: &'static str,
        /// Parameters of the network.
        parameters: usize,
        /// Residuals.
        rows: usize,
    },
    /// A checkpoint that this run cannot go on from.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Variable projection without anything to project.
    #[error("optimizer varpro needs a head that enters all terms linearly, and there is none; choose lm")]
    NotLinear,
    /// Local functions that cannot do it.
    #[error(transparent)]
    Local(#[from] LocalError),
    /// Splines over one coordinate that cannot do it.
    #[error("splines do not do {0}; choose a network")]
    Splines(&'static str),
    /// More memory than there is.
    #[error(transparent)]
    Memory(#[from] Exceeded),
    /// Threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

impl From<SplineError> for RecoverError {
    fn from(error: SplineError) -> Self {
        match error {
            SplineError::Fault(fault) => fault.into(),
            SplineError::Memory(exceeded) => exceeded.into(),
        }
    }
}

/// What the caller sees while the solver runs.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// Steps so far.
    pub iteration: u64,
    /// Seconds so far.
    pub elapsed_s: f64,
    /// Least loss so far.
    pub loss: f64,
    /// Gives what [`resume`] goes on from.
    pub checkpoint: &'a dyn Fn() -> Checkpoint,
}

/// Sees every step, and may end the run.
type Monitor<'a> = dyn FnMut(Report<'_>) -> Flow + Send + 'a;

/// Solves a problem. `monitor` sees every step and may stop the run; the best state is kept.
///
/// # Errors
/// A problem that is not fully bound, or that cannot be evaluated at all.
pub fn recover(problem: &Problem, settings: &Settings, monitor: &mut Monitor<'_>) -> Result<Solution, RecoverError> {
    solve(problem, settings, None, monitor)
}

/// Goes on from a checkpoint of the same problem with the same settings: on one kind of processor every later iterate has the
/// same bits as if that run had not stopped, on any number of threads. The limit of steps counts from its beginning, the
/// budget from now.
///
/// Iterates do not depend on time, with one exception: local functions turn from the coarse lattice to the fine one early
/// where the budget ends on the coarse one.
///
/// # Errors
/// As [`recover`]; a checkpoint of another problem, or with other settings.
pub fn resume(
    problem: &Problem,
    settings: &Settings,
    checkpoint: &Checkpoint,
    monitor: &mut Monitor<'_>,
) -> Result<Solution, RecoverError> {
    solve(problem, settings, Some(checkpoint), monitor)
}

fn solve(
    problem: &Problem,
    settings: &Settings,
    checkpoint: Option<&Checkpoint>,
    monitor: &mut Monitor<'_>,
) -> Result<Solution, RecoverError> {
    let start = Instant::now();
    let (mut bound, settings) = prepared(problem, settings)?;
    let fingerprint = checkpoint::fingerprint(problem, &settings);
    if checkpoint.is_some_and(|checkpoint| checkpoint.fingerprint != fingerprint) {
        return Err(CheckpointError::Other.into());
    }
    if checkpoint.is_some() && settings.resampling.is_some() {
        return Err(CheckpointError::Resampling.into());
    }
    let (pool, limits) = (threads(&settings)?, limits(&settings));
    let from = checkpoint.map(|checkpoint| &checkpoint.state);
    if let Some(state) = from {
        bound = noisiness::restored(bound, state).map_err(|_| CheckpointError::Damaged)?;
    }
    let (bound, settings) = (&bound, &settings);
    pool.install(|| {
        let (mut attempt, others) = choice::attempts(bound, settings, from);
        let mut attempts = others.into_iter();
        let mut first: Option<Solution> = None;
        loop {
            let settings = &Settings { seed: attempt.seed, ..settings.clone() };
            let limits = Limits { budget: limits.budget.map(|budget| budget.mul_f64(attempt.share)), ..limits };
            let is_witness = attempt.carrier.is_witness();
            let mut solve = |bound: &Bound, from: Option<&State>| {
                let monitor = &mut |report: Report<'_>| {
                    let marked = || {
                        let Checkpoint { fingerprint, state } = (report.checkpoint)();
                        Checkpoint { fingerprint, state: noisiness::save(bound, state) }
                    };
                    monitor(Report { checkpoint: &marked, ..report })
                };
                let course = Course::new(fingerprint, limits, start, from, monitor);
                let solved = attempt.carrier.solve(bound, settings, course)?;
                Ok::<_, RecoverError>(Solution::new(bound.clone(), solved, (settings, start), &attempt, fingerprint))
            };
            let mut solution = solve(bound, from)?;
            // Only carriers that count each measurement by itself.
            if is_witness
                && has_time_for_noise(settings, start)
                && let Some(bound) = solution.with_noisiness()
            {
                solution = with_noise(solution, solve(&bound, None)?);
            }
            if has_time_for_noise(settings, start)
                && let Some(bound) = solution.without_strays()
            {
                let other = solve(&bound, None)?;
                solution = if other.is_sound() || other.status == Status::Interrupted { other } else { solution };
            }
            let solution = solution.compared(first.as_ref());
            let contradicts = is_witness && solution.verdict.contradicts();
            let is_over = solution.is_clear() || contradicts || solution.status == Status::Interrupted;
            // Where nothing is measured, what is left of the equations tells all.
            let is_judged = !bound.problem.scene().schema.observed().is_empty();
            let is_unfinished = is_judged && first.is_some() && is_over && solution.status == Status::Budget;
            let is_worse = |before: &Solution| is_judged || before.verdict.worst() <= solution.verdict.worst();
            let mut solution = first.take_if(|before| !is_over && is_worse(before)).unwrap_or(solution);
            solution.verdict.checks.extend(is_unfinished.then(settled::unfinished));
            solution.wall_s = start.elapsed().as_secs_f64();
            match attempts.next().filter(|_| !is_over && has_time_again(settings, start)) {
                Some(next) => (attempt, first) = (next, Some(solution)),
                None => return Ok(solution),
            }
        }
    })
}

/// A problem in its units, and the settings with an architecture that suits it.
fn prepared(problem: &Problem, settings: &Settings) -> Result<(Bound, Settings), BindError> {
    let bound = problem.bound(settings.architecture.inputs)?;
    let architecture = layers::suited(&bound, settings.architecture);
    // Natural sizes depend on the inputs.
    let bound = if architecture == settings.architecture { bound } else { problem.bound(architecture.inputs)? };
    Ok((bound, Settings { architecture, ..settings.clone() }))
}

/// Threads of a run's own.
fn threads(settings: &Settings) -> Result<rayon::ThreadPool, RecoverError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build();
    pool.map_err(|error| RecoverError::Threads { threads: settings.threads, reason: error.to_string() })
}

/// Steps and time that a run may take.
fn limits(settings: &Settings) -> Limits {
    Limits { budget: settings.budget, iterations: settings.iterations.unwrap_or(u64::MAX), ..Limits::default() }
}

/// Of an answer and another one in which values count by their noise, the one that stands. A law of noise under which a sound answer
/// contradicts its data is none: a few large values may be off for other reasons. A run that is stopped goes on from where it was.
fn with_noise(before: Solution, after: Solution) -> Solution {
    let is_worse = !after.is_sound() && (before.is_sound() || before.verdict.worst() <= after.verdict.worst());
    match after.status {
        Status::Interrupted => after,
        Status::Budget => before,
        _ if is_worse => before,
        _ => after,
    }
}

/// True where what has been found of the noise may be used: steps are not counted, and twice the time so far is in the budget.
fn has_time_for_noise(settings: &Settings, start: Instant) -> bool {
    settings.iterations.is_none() && settings.budget.is_none_or(|budget| 2 * start.elapsed() < budget)
}

/// True where enough of the budget is left for another start: a third.
fn has_time_again(settings: &Settings, start: Instant) -> bool {
    let elapsed = start.elapsed();
    settings.iterations.is_none() && settings.budget.is_some_and(|budget| 3 * elapsed < 2 * budget)
}
