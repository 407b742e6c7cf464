//! A network fitted to a problem: rows weighted, a method chosen and run, in one precision or in two.

mod fit;

use std::time::Instant;

use fit::Fit;

use super::bars::Distrust;
use super::carried::{Carrier, Solved};
use super::course::Course;
use super::settings::{Optimizer, Settings, Width};
use super::trained::Trained;
use super::undetermined::View;
use super::{RecoverError, resolution, weigh};
use crate::problem::Bound;
use crate::saved;
use crate::solve::driver::{Status, Warning, WarningKind};

/// Parameters up to which the curvature is factorised for error bars: a few seconds.
const MOST_FOR_CURVATURE: usize = 4000;

/// Estimated distance of the loss from its minimum, relative to the loss, at which noisy data count as
/// fitted: some hundredths of a logarithm of probability, which move the answer by a tenth of an error bar.
const NOISE_TOLERANCE: f64 = 1e-4;

/// A network of the settings' shape.
pub(super) struct Network;

impl Carrier for Network {
    fn name(&self) -> &'static str {
        saved::NETWORK
    }

    fn solve(&self, bound: &Bound, settings: &Settings, course: Course<'_, '_>) -> Result<Solved, RecoverError> {
        fitted(bound, settings, course)
    }
}

fn fitted(bound: &Bound, settings: &Settings, mut course: Course<'_, '_>) -> Result<Solved, RecoverError> {
    let mut fit = Fit::new(bound, settings)?;
    let optimizer = fit.choose(&course)?;
    if optimizer == Optimizer::Evidence {
        course.limits.tolerance = NOISE_TOLERANCE;
    }
    let precision = match settings.precision {
        Width::Auto if !(optimizer.works_in_single() && bound.problem.scene().has_single()) => Width::F64,
        chosen => chosen,
    };
    let (mut outcome, prior) = match precision {
        Width::F32 => (fit.in_single(optimizer, &mut course, None)?, fit.prior.clone()),
        Width::Auto => (fit.in_both(optimizer, &mut course)?, fit.prior.clone()),
        Width::F64 => fit.in_double(optimizer, &mut course, None)?,
    };
    let Fit { mut engine, noise, .. } = fit;
    let (parameters, rows) = (engine.parameters(), engine.row_count());
    outcome.warnings.extend(resolution::warnings(bound, &mut engine, &outcome.theta, &noise));
    let has_bars = settings.precision != Width::F32
        && parameters <= MOST_FOR_CURVATURE
        && Optimizer::Evidence.fits(parameters, rows);
    let prior = has_bars.then_some(prior);
    if let Some(prior) = &prior {
        if !optimizer.counts_noise() {
            weigh::by_noise(&mut engine, bound, &noise);
        }
        let architecture = settings.architecture;
        let mut view = View { bound, engine: &mut engine, theta: &outcome.theta, prior, architecture };
        if has_time_for_curvatures(view.curvatures(), settings, course.start, parameters, rows) {
            outcome.warnings.extend(view.warnings());
        } else {
            let message = "no time was left to look for what the data do not determine; give a larger budget".into();
            outcome.warnings.push(Warning { kind: WarningKind::OutOfTime, message });
        }
    }
    let precision = match precision {
        // The run may have ended before double precision took over.
        Width::Auto if !course.is_promoted() => Width::F32,
        chosen => chosen,
    };
    // A prior that no evidence has weighed says nothing of what exact data leave open: the error is that of the solver.
    let is_noisy = noise.is_there(bound.problem.scene().schema);
    let prior = prior.filter(|_| optimizer == Optimizer::Evidence || is_noisy);
    let is_seen = bound.clouds.iter().flatten().any(|cloud| !cloud.is_empty());
    if prior.is_none() && is_seen && matches!(outcome.status, Status::Converged | Status::Budget) {
        let message = "there are no error bars: networks do not tell how noisy a cloud is".into();
        outcome.warnings.push(Warning { kind: WarningKind::NoBars, message });
    }
    let (architecture, theta, distrust) = (settings.architecture, outcome.theta, Distrust::under(&noise));
    Ok(Solved {
        status: outcome.status,
        loss: outcome.loss,
        iterations: outcome.iterations,
        warnings: outcome.warnings,
        state: outcome.state,
        optimizer,
        method: optimizer.name(),
        precision,
        carried: Box::new(Trained { architecture, engine, theta, prior, distrust }),
    })
}

/// True where so many curvatures should keep the run within a twentieth of its budget.
fn has_time_for_curvatures(count: usize, settings: &Settings, start: Instant, parameters: usize, rows: usize) -> bool {
    /// Products a second on two cores with vectors of 256 bits, about; fewer cores may be late.
    const RATE: f64 = 2e10;
    let (parameters, rows) = (parameters as f64, rows as f64);
    let seconds = count as f64 * (rows + parameters / 3.0) * parameters * parameters / RATE;
    settings.budget.is_none_or(|budget| start.elapsed().as_secs_f64() + seconds <= 1.05 * budget.as_secs_f64())
}
