//! The fit of a network: its rows weighted for a method, and the method run.

use crate::engine::{Engine, Resampling, factors};
use crate::kernel::Precision;
use crate::memory;
use crate::network::initialise;
use crate::noise::{self, Noise};
use crate::problem::{BindError, Bound};
use crate::recover::course::Course;
use crate::recover::promotion::Promotion;
use crate::recover::settings::{Optimizer, Settings, Width};
use crate::recover::{BELIEF, RecoverError, weigh};
use crate::solve::adam::{Adam, AdamSettings};
use crate::solve::broyden::{Broyden, Update};
use crate::solve::driver::{Outcome, Status, WarningKind};
use crate::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use crate::solve::fault::Fault;
use crate::solve::gauss_newton::GaussNewton;
use crate::solve::lbfgs::{self, Lbfgs};
use crate::solve::marquardt::Marquardt;
use crate::solve::method::Method;
use crate::solve::prior::WeightPrior;
use crate::solve::projection::{Projection, linear_parameters};

/// Inner iterations of a Gauss-Newton step at most.
const INNER: usize = 100;

/// A problem and the network that is fitted to it.
pub(super) struct Fit<'a> {
    bound: &'a Bound,
    settings: &'a Settings,
    pub(super) engine: Engine<f64>,
    pub(super) noise: Noise,
    /// Initial weights.
    theta: Vec<f64>,
    pub(super) prior: WeightPrior,
}

impl<'a> Fit<'a> {
    pub(super) fn new(bound: &'a Bound, settings: &'a Settings) -> Result<Self, RecoverError> {
        let engine: Engine<f64> = engine(bound, settings)?;
        let theta = initialise(engine.layout(), settings.seed);
        let prior = engine.layout().prior(BELIEF.precision);
        Ok(Self { bound, settings, engine, noise: noise::estimate(bound), theta, prior })
    }

    /// The method: as asked for, or by sizes and noise, or by trial where these leave more than one.
    pub(super) fn choose(&mut self, course: &Course<'_, '_>) -> Result<Optimizer, RecoverError> {
        let (parameters, rows) = (self.engine.parameters(), self.engine.row_count());
        let single = self.settings.precision == Width::F32;
        let candidates = self.settings.optimizer.candidates(&self.noise, parameters, rows, single);
        // A run that goes on from a saved state has tried the methods before.
        let known = course.method().and_then(Optimizer::from_name).filter(|known| candidates.contains(known));
        let optimizer = match (&candidates[..], known) {
            ([only], _) => *only,
            (_, Some(known)) => known,
            _ => self.by_trial(&candidates)?,
        };
        if single && !optimizer.works_in_single() {
            return Err(RecoverError::Precision { optimizer: optimizer.name() });
        }
        if !optimizer.fits(parameters, rows) {
            return Err(RecoverError::Size { optimizer: optimizer.name(), parameters, rows });
        }
        let what = || format!("optimizer {} with {parameters} parameters and {rows} rows", optimizer.name());
        memory::require(optimizer.bytes(parameters, rows), what, "choose a smaller width, or optimizer adam")?;
        Ok(optimizer)
    }

    /// The method with the least loss after a few steps of each, which cost about the same.
    fn by_trial(&mut self, candidates: &[Optimizer]) -> Result<Optimizer, RecoverError> {
        let mut best = (f64::INFINITY, candidates[0]);
        for &candidate in candidates {
            self.weigh(candidate)?;
            let mut method = self.method(candidate);
            for _ in 0..candidate.steps_of_a_trial() {
                method.step(&mut self.engine)?;
            }
            factors::by_size(&mut self.engine);
            let loss = self.engine.loss(method.theta())?;
            if loss < best.0 {
                best = (loss, candidate);
            }
        }
        Ok(best.1)
    }

    /// Weights the rows as a method needs it.
    fn weigh(&mut self, optimizer: Optimizer) -> Result<(), Fault> {
        if optimizer.counts_noise() {
            weigh::by_noise(&mut self.engine, self.bound, &self.noise);
            weigh::begin_wide(&mut self.engine, self.bound, &self.noise);
            return Ok(());
        }
        factors::by_size(&mut self.engine);
        if optimizer == Optimizer::Adam {
            factors::regress_first(&mut self.engine, &self.theta, self.settings.data_first)?;
        }
        Ok(())
    }

    /// A method at the initial weights.
    fn method(&self, optimizer: Optimizer) -> Box<dyn Method<f64, Engine<f64>>> {
        let (theta, prior) = (self.theta.clone(), self.prior.clone());
        match optimizer {
            Optimizer::Evidence => {
                let settings = EmpiricalBayesSettings { belief: BELIEF, ..EmpiricalBayesSettings::default() };
                Box::new(EmpiricalBayes::new(theta, prior, settings))
            }
            Optimizer::Marquardt | Optimizer::Projection => Box::new(Marquardt::new(theta, prior)),
            Optimizer::GaussNewton => Box::new(GaussNewton::new(theta, prior, INNER)),
            Optimizer::Broyden => Box::new(Broyden::new(theta, Update::SelfScaledBroyden)),
            Optimizer::Lbfgs => Box::new(Lbfgs::new(theta, lbfgs::MEMORY)),
            Optimizer::Adam => Box::new(Adam::new(theta, AdamSettings::default())),
            Optimizer::Auto => unreachable!("`Optimizer::candidates` names what `Auto` stands for"),
        }
    }

    /// A method that goes on from a run in single precision: what it has learnt of the curvature is worth hundreds of steps.
    fn method_after(
        &mut self,
        optimizer: Optimizer,
        single: &Outcome<f64>,
    ) -> Result<Box<dyn Method<f64, Engine<f64>>>, Fault> {
        let mut method = self.method(optimizer);
        let state = single.state.without("loss");
        method.restore(&if optimizer == Optimizer::Lbfgs { lbfgs::recalled(state)? } else { state })?;
        Ok(method)
    }

    /// Runs in double precision, from the end of a run in single if there was one; gives the belief about parameters that
    /// the method ended with, too.
    pub(super) fn in_double(
        &mut self,
        optimizer: Optimizer,
        course: &mut Course<'_, '_>,
        single: Option<&Outcome<f64>>,
    ) -> Result<(Outcome<f64>, WeightPrior), RecoverError> {
        self.weigh(optimizer)?;
        if optimizer == Optimizer::Projection {
            return Ok((self.by_projection(course)?, self.prior.clone()));
        }
        let mut method = match single {
            None => self.method(optimizer),
            Some(single) => self.method_after(optimizer, single)?,
        };
        let outcome = course.run(&mut *method, &mut self.engine)?;
        let prior = method.prior().unwrap_or(&self.prior).clone();
        Ok((outcome, prior))
    }

    /// Solves for the weights of linear heads and searches the others.
    fn by_projection(&mut self, course: &mut Course<'_, '_>) -> Result<Outcome<f64>, RecoverError> {
        let layout = self.engine.layout();
        let heads: Vec<Vec<usize>> = (0..layout.heads).map(|head| layout.head_parameters(head).collect()).collect();
        let linear = linear_parameters(&mut self.engine, &self.theta, &heads)?;
        if linear.is_empty() {
            return Err(RecoverError::NotLinear);
        }
        let mut projection = Projection::new(&mut self.engine, &linear, BELIEF.precision);
        let phi = projection.searched(&self.theta);
        let prior = WeightPrior::uniform(BELIEF.precision, phi.len());
        let outcome = course.run(&mut Marquardt::new(phi, prior), &mut projection)?;
        let theta = projection.all(&outcome.theta)?;
        Ok(Outcome { theta, ..outcome })
    }

    /// Runs in single precision, until `promotion` says that it helps no more.
    pub(super) fn in_single(
        &mut self,
        optimizer: Optimizer,
        course: &mut Course<'_, '_>,
        promotion: Option<&mut Promotion>,
    ) -> Result<Outcome<f64>, RecoverError> {
        let mut engine: Engine<f32> = engine(self.bound, self.settings)?;
        self.weigh(optimizer)?;
        factors::alike(&mut engine, &self.engine);
        let theta: Vec<f32> = self.theta.iter().map(|&x| x as f32).collect();
        let mut method: Box<dyn Method<f32, Engine<f32>>> = match optimizer {
            Optimizer::Lbfgs => Box::new(Lbfgs::new(theta, lbfgs::MEMORY)),
            Optimizer::Adam => Box::new(Adam::new(theta, AdamSettings::default())),
            other => return Err(RecoverError::Precision { optimizer: other.name() }),
        };
        let outcome = match promotion {
            None => course.run(&mut *method, &mut engine)?,
            Some(promotion) => {
                course.run_until(&mut *method, &mut engine, &mut |steps, theta| promotion.is_due(steps, theta))?
            }
        };
        Ok(widened(outcome))
    }

    /// Runs in single precision as long as it helps, and then in double.
    pub(super) fn in_both(
        &mut self,
        optimizer: Optimizer,
        course: &mut Course<'_, '_>,
    ) -> Result<Outcome<f64>, RecoverError> {
        if course.is_promoted() {
            return Ok(self.in_double(optimizer, course, None)?.0);
        }
        self.weigh(optimizer)?;
        let mut promotion = Promotion::new(self.bound, self.settings.architecture, &self.engine)?;
        let single = self.in_single(optimizer, course, Some(&mut promotion))?;
        // What counts as a minimum in single precision may be none in double.
        let was_ended = matches!(single.status, Status::Budget | Status::Interrupted);
        if was_ended && !promotion.due {
            return Ok(single);
        }
        if !course.has_steps_after(&single) {
            return Ok(Outcome { status: Status::Budget, ..single });
        }
        course.promote(&single);
        let (double, _) = self.in_double(optimizer, course, Some(&single))?;
        let mut warnings = single.warnings;
        warnings.retain(|warning| warning.kind != WarningKind::SinglePrecision);
        warnings.extend(double.warnings);
        Ok(Outcome { evaluations: single.evaluations + double.evaluations, warnings, ..double })
    }
}

/// The engine that a network is trained with.
fn engine<E: Precision>(bound: &Bound, settings: &Settings) -> Result<Engine<E>, BindError> {
    let whole = bound.engine(settings.architecture)?;
    let Some(resampling) = settings.resampling else { return Ok(whole) };
    let mut part = bound.thinned(resampling.share).engine(settings.architecture)?;
    part.resample_from(whole, Resampling { every: resampling.every.max(1), ..resampling }, settings.seed);
    Ok(part)
}

fn widened(outcome: Outcome<f32>) -> Outcome<f64> {
    Outcome {
        theta: outcome.theta.iter().map(|&x| f64::from(x)).collect(),
        status: outcome.status,
        loss: outcome.loss,
        iterations: outcome.iterations,
        evaluations: outcome.evaluations,
        wall_s: outcome.wall_s,
        warnings: outcome.warnings,
        state: outcome.state,
    }
}
