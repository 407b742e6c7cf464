//! From a bound problem to its solution: one call.
//!
//! [`recover`] chooses how rows are weighted and which method minimises them, runs it within a budget, and reads the
//! answer back in the user's units.

mod checkpoint;
mod noise;
mod settings;
mod solution;
mod undetermined;
pub(crate) mod weigh;

use std::time::Instant;

use thiserror::Error;

use undetermined::View;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use settings::{Optimizer, Settings, Width};
pub use solution::{Estimate, LearnedValue, Solution, TermReport};

use crate::engine::Engine;
use crate::local::{self, Local, LocalError};
use crate::network::initialise;
use crate::problem::{BindError, Bound, Problem};
use crate::real::Real;
use crate::solve::adam::{Adam, AdamSettings};
use crate::solve::broyden::{Broyden, Update};
use crate::solve::driver::{self, Flow, Limits, Outcome, Progress};
use crate::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use crate::solve::evidence::Belief;
use crate::solve::fault::Fault;
use crate::solve::lbfgs::Lbfgs;
use crate::solve::marquardt::Marquardt;
use crate::solve::method::Method;
use crate::solve::objective::Objective;
use crate::solve::state::State;

/// What is believed of the precision of weights before any row is seen: a network whose heads change by a few times their
/// natural size. Worth so few parameters, it matters only where the data say next to nothing.
const BELIEF: Belief = Belief { precision: 0.3, count: 4.0 };

/// Parameters up to which the curvature is factorised for error bars: a few seconds.
const MOST_FOR_CURVATURE: usize = 4000;

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
    /// Local functions that cannot do it.
    #[error(transparent)]
    Local(#[from] LocalError),
    /// Threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        reason: String,
    },
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
    let bound = problem.bound(settings.architecture.inputs)?;
    let fingerprint = checkpoint::fingerprint(problem, settings);
    if checkpoint.is_some_and(|checkpoint| checkpoint.fingerprint != fingerprint) {
        return Err(CheckpointError::Other.into());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build();
    let pool = pool.map_err(|error| RecoverError::Threads { threads: settings.threads, reason: error.to_string() })?;
    let course = Course { fingerprint, limits: limits(settings, start), from: checkpoint.map(|c| &c.state), monitor };
    pool.install(|| match (&settings.local, settings.precision) {
        (Some(local), _) => solve_local(bound, local, settings, start, course),
        (None, Width::F64) => solve_double(bound, settings, start, course),
        (None, Width::F32) => solve_single(bound, settings, start, course),
    })
}

/// How a run begins, who watches it and when it ends.
struct Course<'a, 'm> {
    /// Of problem and settings.
    fingerprint: u64,
    limits: Limits,
    /// Where to go on from; else from the start.
    from: Option<&'a State>,
    monitor: &'a mut Monitor<'m>,
}

impl Course<'_, '_> {
    /// Runs a method.
    fn run<E: Real, O: Objective<E>, M: Method<E, O>>(
        self,
        method: &mut M,
        objective: &mut O,
    ) -> Result<Outcome<E>, RecoverError> {
        let Self { fingerprint, limits, from, monitor } = self;
        let monitor = &mut |progress: &Progress<'_, E>| {
            monitor(Report {
                iteration: progress.iteration,
                elapsed_s: progress.elapsed.as_secs_f64(),
                loss: progress.best_loss,
                checkpoint: &|| Checkpoint { fingerprint, state: (progress.checkpoint)() },
            })
        };
        match from {
            None => Ok(driver::run(method, objective, limits, monitor)),
            Some(state) => {
                let outcome = driver::resume(method, objective, state, limits, monitor);
                // What carries the right fingerprint and still does not fit was not written by us.
                outcome.map_err(|_| CheckpointError::Damaged.into())
            }
        }
    }
}

fn solve_local(
    bound: Bound,
    local: &Local,
    settings: &Settings,
    start: Instant,
    course: Course<'_, '_>,
) -> Result<Solution, RecoverError> {
    let Course { fingerprint, limits, from, monitor } = course;
    let found = local::solve(&bound, local, limits, from, &mut |progress| {
        monitor(Report {
            iteration: progress.iteration,
            elapsed_s: progress.elapsed_s,
            loss: progress.loss,
            checkpoint: &|| Checkpoint { fingerprint, state: (progress.checkpoint)() },
        })
    })?;
    Ok(Solution::of_local(bound, found, settings, start))
}

fn limits(settings: &Settings, start: Instant) -> Limits {
    Limits {
        budget: settings.budget.map(|budget| budget.saturating_sub(start.elapsed())),
        iterations: settings.iterations.unwrap_or(u64::MAX),
        ..Limits::default()
    }
}

fn solve_double(
    bound: Bound,
    settings: &Settings,
    start: Instant,
    course: Course<'_, '_>,
) -> Result<Solution, RecoverError> {
    let mut engine: Engine<f64> = bound.engine(settings.architecture)?;
    let noise = noise::estimate(&bound);
    let (parameters, rows) = (engine.parameters(), engine.row_count());
    let optimizer = settings.optimizer.choose(&noise, parameters, rows);
    if !optimizer.fits(parameters, rows) {
        return Err(RecoverError::Size { optimizer: optimizer.name(), parameters, rows });
    }
    let theta = initialise(engine.layout(), settings.seed);
    let mut prior = engine.layout().prior(BELIEF.precision);
    let mut outcome = match optimizer {
        Optimizer::Evidence | Optimizer::Marquardt => {
            weigh::by_noise(&mut engine, &bound, &noise);
            if optimizer == Optimizer::Evidence {
                let settings = EmpiricalBayesSettings { belief: BELIEF, ..EmpiricalBayesSettings::default() };
                let mut method = EmpiricalBayes::new(theta, prior, settings);
                let outcome = course.run(&mut method, &mut engine)?;
                prior = method.prior().clone();
                outcome
            } else {
                course.run(&mut Marquardt::new(theta, prior.clone()), &mut engine)?
            }
        }
        Optimizer::Broyden => {
            weigh::by_size(&mut engine);
            course.run(&mut Broyden::new(theta, Update::SelfScaledBroyden), &mut engine)?
        }
        Optimizer::Lbfgs => {
            weigh::by_size(&mut engine);
            course.run(&mut Lbfgs::new(theta, 20), &mut engine)?
        }
        Optimizer::Auto | Optimizer::Adam => {
            weigh::by_size(&mut engine);
            weigh::regress_first(&mut engine, &theta)?;
            course.run(&mut Adam::new(theta, AdamSettings::default()), &mut engine)?
        }
    };
    let prior = (parameters <= MOST_FOR_CURVATURE && Optimizer::Evidence.fits(parameters, rows)).then_some(prior);
    if let Some(prior) = &prior {
        if !matches!(optimizer, Optimizer::Evidence | Optimizer::Marquardt) {
            weigh::by_noise(&mut engine, &bound, &noise);
        }
        let architecture = settings.architecture;
        let theta = &outcome.theta;
        let mut view = View { bound: &bound, engine: &mut engine, theta, prior, architecture };
        outcome.warnings.extend(view.warnings());
    }
    Ok(Solution::new(bound, engine, outcome, settings, optimizer, start, prior))
}

fn solve_single(
    bound: Bound,
    settings: &Settings,
    start: Instant,
    course: Course<'_, '_>,
) -> Result<Solution, RecoverError> {
    let mut engine: Engine<f32> = bound.engine(settings.architecture)?;
    let theta: Vec<f32> = initialise(engine.layout(), settings.seed).into_iter().map(|x| x as f32).collect();
    weigh::by_size(&mut engine);
    let (optimizer, outcome) = match settings.optimizer {
        Optimizer::Lbfgs => (Optimizer::Lbfgs, course.run(&mut Lbfgs::new(theta, 20), &mut engine)?),
        Optimizer::Auto | Optimizer::Adam => {
            weigh::regress_first(&mut engine, &theta)?;
            let mut method = Adam::new(theta, AdamSettings::default());
            (Optimizer::Adam, course.run(&mut method, &mut engine)?)
        }
        other => return Err(RecoverError::Precision { optimizer: other.name() }),
    };
    let outcome = Outcome {
        theta: outcome.theta.iter().map(|&x| f64::from(x)).collect(),
        status: outcome.status,
        loss: outcome.loss,
        iterations: outcome.iterations,
        evaluations: outcome.evaluations,
        wall_s: outcome.wall_s,
        warnings: outcome.warnings,
        state: outcome.state,
    };
    let mut double: Engine<f64> = bound.engine(settings.architecture)?;
    weigh::by_size(&mut double);
    Ok(Solution::new(bound, double, outcome, settings, optimizer, start, None))
}
