//! From a bound problem to its solution: one call.
//!
//! [`recover`] chooses how rows are weighted and which method minimises them, runs it within a budget, and reads the
//! answer back in the user's units.

mod noise;
mod settings;
mod solution;
mod undetermined;
pub(crate) mod weigh;

use std::time::{Duration, Instant};

use thiserror::Error;

use undetermined::View;

pub use settings::{Optimizer, Settings, Width};
pub use solution::{Estimate, LearnedValue, Solution, TermReport};

use crate::engine::Engine;
use crate::local::{self, Local, LocalError};
use crate::network::initialise;
use crate::problem::{BindError, Bound, Problem};
use crate::solve::adam::{Adam, AdamSettings};
use crate::solve::broyden::{Broyden, Update};
use crate::solve::driver::{self, Flow, Limits, Outcome, Progress};
use crate::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use crate::solve::evidence::Belief;
use crate::solve::fault::Fault;
use crate::solve::lbfgs::Lbfgs;
use crate::solve::marquardt::Marquardt;

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
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Steps so far.
    pub iteration: u64,
    /// Seconds so far.
    pub elapsed_s: f64,
    /// Least loss so far.
    pub loss: f64,
}

/// Solves a problem. `monitor` sees every step and may stop the run; the best state is kept.
///
/// # Errors
/// A problem that is not fully bound, or that cannot be evaluated at all.
pub fn recover(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut (dyn FnMut(Report) -> Flow + Send),
) -> Result<Solution, RecoverError> {
    let start = Instant::now();
    let bound = problem.bound(settings.architecture.inputs)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build();
    let pool = pool.map_err(|error| RecoverError::Threads { threads: settings.threads, reason: error.to_string() })?;
    pool.install(|| match (&settings.local, settings.precision) {
        (Some(local), _) => solve_local(bound, local, settings, start, monitor),
        (None, Width::F64) => solve_double(bound, settings, start, monitor),
        (None, Width::F32) => solve_single(bound, settings, start, monitor),
    })
}

fn solve_local(
    bound: Bound,
    local: &Local,
    settings: &Settings,
    start: Instant,
    monitor: &mut (dyn FnMut(Report) -> Flow + Send),
) -> Result<Solution, RecoverError> {
    let limits = limits(settings, start);
    let budget = limits.budget.unwrap_or(Duration::MAX);
    let found = local::solve(&bound, local, budget, limits.iterations, &mut |iteration, elapsed_s, loss| {
        monitor(Report { iteration, elapsed_s, loss })
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

fn forward<'a, E>(monitor: &'a mut (dyn FnMut(Report) -> Flow + Send)) -> impl FnMut(&Progress<'_, E>) -> Flow + 'a {
    move |progress| {
        monitor(Report {
            iteration: progress.iteration,
            elapsed_s: progress.elapsed.as_secs_f64(),
            loss: progress.best_loss,
        })
    }
}

fn solve_double(
    bound: Bound,
    settings: &Settings,
    start: Instant,
    monitor: &mut (dyn FnMut(Report) -> Flow + Send),
) -> Result<Solution, RecoverError> {
    let mut engine: Engine<f64> = bound.engine(settings.architecture)?;
    let noise = noise::estimate(&bound);
    let (parameters, rows) = (engine.parameters(), engine.row_count());
    let optimizer = settings.optimizer.choose(&noise, parameters, rows);
    if !optimizer.fits(parameters, rows) {
        return Err(RecoverError::Size { optimizer: optimizer.name(), parameters, rows });
    }
    let theta = initialise(engine.layout(), settings.seed);
    let monitor = &mut forward(monitor);
    let limits = limits(settings, start);
    let mut prior = engine.layout().prior(BELIEF.precision);
    let mut outcome = match optimizer {
        Optimizer::Evidence | Optimizer::Marquardt => {
            weigh::by_noise(&mut engine, &bound, &noise);
            if optimizer == Optimizer::Evidence {
                let settings = EmpiricalBayesSettings { belief: BELIEF, ..EmpiricalBayesSettings::default() };
                let mut method = EmpiricalBayes::new(theta, prior, settings);
                let outcome = driver::run(&mut method, &mut engine, limits, monitor);
                prior = method.prior().clone();
                outcome
            } else {
                driver::run(&mut Marquardt::new(theta, prior.clone()), &mut engine, limits, monitor)
            }
        }
        Optimizer::Broyden => {
            weigh::by_size(&mut engine);
            driver::run(&mut Broyden::new(theta, Update::SelfScaledBroyden), &mut engine, limits, monitor)
        }
        Optimizer::Lbfgs => {
            weigh::by_size(&mut engine);
            driver::run(&mut Lbfgs::new(theta, 20), &mut engine, limits, monitor)
        }
        Optimizer::Auto | Optimizer::Adam => {
            weigh::by_size(&mut engine);
            weigh::regress_first(&mut engine, &theta)?;
            driver::run(&mut Adam::new(theta, AdamSettings::default()), &mut engine, limits, monitor)
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
    monitor: &mut (dyn FnMut(Report) -> Flow + Send),
) -> Result<Solution, RecoverError> {
    let mut engine: Engine<f32> = bound.engine(settings.architecture)?;
    let theta: Vec<f32> = initialise(engine.layout(), settings.seed).into_iter().map(|x| x as f32).collect();
    let monitor = &mut forward(monitor);
    let limits = limits(settings, start);
    weigh::by_size(&mut engine);
    let (optimizer, outcome) = match settings.optimizer {
        Optimizer::Lbfgs => (Optimizer::Lbfgs, driver::run(&mut Lbfgs::new(theta, 20), &mut engine, limits, monitor)),
        Optimizer::Auto | Optimizer::Adam => {
            weigh::regress_first(&mut engine, &theta)?;
            let mut method = Adam::new(theta, AdamSettings::default());
            (Optimizer::Adam, driver::run(&mut method, &mut engine, limits, monitor))
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
    };
    let mut double: Engine<f64> = bound.engine(settings.architecture)?;
    weigh::by_size(&mut double);
    Ok(Solution::new(bound, double, outcome, settings, optimizer, start, None))
}
