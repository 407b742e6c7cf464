//! How much each term counts.

use crate::engine::Engine;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::real::Real;
use crate::schema::TermKind;
use crate::solve::evidence;
use crate::solve::fault::Fault;
use crate::solve::objective::LeastSquares;

/// Tolerance of equations where data are noisy, as a share of the equation's natural size: so small that the equation
/// adds nothing to the error, so large that the problem stays well conditioned.
const EQUATION_TOLERANCE: f64 = 1e-2;

/// The same for conditions of a few rows, which cost no conditioning: an answer that rests on one inherits its error.
const CONDITION_TOLERANCE: f64 = 1e-4;

/// Rows of a condition at most: initial and boundary values, not equations.
pub(super) const FEW_ROWS: usize = 8;

/// Smallest noise that data are credited with, as a share of their natural size.
const LEAST_NOISE: f64 = 1e-6;

/// Noise that data count with beside beliefs where they are taken as exact, as a share of their natural size.
const ASSUMED_NOISE: f64 = 1e-3;

/// Mean squares of rows over their natural sizes, times the user's weights: for exact data.
pub(crate) fn by_size<E: Real>(engine: &mut Engine<E>) {
    let points = engine.groups.iter().map(|group| group.points).max().unwrap_or(1);
    for group in &mut engine.groups {
        if group.schema.is_beliefs() {
            // A row over its spread stands beside rows over their noise, not beside mean squares.
            group.terms.iter_mut().for_each(|term| term.factor = ASSUMED_NOISE / (points as f64).sqrt());
            continue;
        }
        for term in &mut group.terms {
            let count = match (&term.chamfer, term.schema.kind) {
                (Some(chamfer), _) => chamfer.cloud_points(),
                (None, TermKind::Integral) => 1,
                (None, _) => group.points,
            };
            term.factor = (term.schema.weight / count as f64).sqrt();
        }
    }
}

/// Rows over their standard deviations: noise for data, a tolerance for equations.
pub(super) fn by_noise(engine: &mut Engine<f64>, bound: &Bound, noise: &Noise) {
    let mut block = 0;
    for (at, group) in bound.problem.scene().schema.groups.iter().enumerate() {
        for (term, schema) in group.terms.iter().enumerate() {
            let size = bound.sizes[at][term];
            let sigma = match schema.kind {
                _ if schema.within.is_some() => size / schema.weight.sqrt(),
                TermKind::Observation => {
                    noise.of(at, term).map_or(size, |observed| observed.deviation).max(LEAST_NOISE * size)
                }
                _ if engine.blocks()[block].rows.len() <= FEW_ROWS => CONDITION_TOLERANCE * size / schema.weight.sqrt(),
                _ => EQUATION_TOLERANCE * size / schema.weight.sqrt(),
            };
            engine.set_sigma(block, sigma);
            block += 1;
        }
    }
}

/// Begins robust measurements with all of their spread as noise: a loss that leaves outliers out would leave out everything
/// that the first network is off from. The evidence narrows it as the network comes nearer.
pub(super) fn begin_wide(engine: &mut Engine<f64>, bound: &Bound, noise: &Noise) {
    let groups = bound.problem.scene().schema.groups.iter().enumerate();
    let terms = groups.flat_map(|(at, group)| (0..group.terms.len()).map(move |term| (at, term)));
    for (block, (at, term)) in terms.enumerate() {
        if bound.losses[at][term].is_robust() && evidence::is_free(&engine.blocks()[block]) {
            let sigma = engine.blocks()[block].sigma;
            let spread = noise.of(at, term).map_or(bound.sizes[at][term], |observed| observed.spread);
            engine.set_sigma(block, sigma.max(spread));
        }
    }
}

/// The paper's rule: residuals are weighted so that at the start `ratio` times their gradient is no longer than the
/// gradient of the regression terms. First the data are regressed, then the source is solved for (paper, section 3.2).
pub(super) fn regress_first<E: Real>(engine: &mut Engine<E>, theta: &[E], ratio: f64) -> Result<(), Fault> {
    let mut regression = 0.0;
    let mut residual = 0.0;
    for is_regression in [true, false] {
        let length = gradient_of(engine, theta, is_regression)?;
        *(if is_regression { &mut regression } else { &mut residual }) = length;
    }
    if regression > 0.0 && residual > 0.0 {
        let weight = (regression / (ratio * residual)).min(1.0);
        each_term(engine, |kind, factor| {
            if !regresses(kind) {
                *factor *= weight.sqrt();
            }
        });
    }
    Ok(())
}

/// Weights the rows of an engine as those of another of the same problem.
pub(super) fn alike<E: Real, F: Real>(engine: &mut Engine<E>, other: &Engine<F>) {
    let terms = engine.groups.iter_mut().flat_map(|group| &mut group.terms);
    for (term, other) in terms.zip(other.groups.iter().flat_map(|group| &group.terms)) {
        (term.size, term.factor) = (other.size, other.factor);
    }
}

fn regresses(kind: TermKind) -> bool {
    matches!(kind, TermKind::Observation | TermKind::Chamfer { .. })
}

fn each_term<E: Real>(engine: &mut Engine<E>, mut change: impl FnMut(TermKind, &mut f64)) {
    for term in engine.groups.iter_mut().flat_map(|group| &mut group.terms) {
        change(term.schema.kind, &mut term.factor);
    }
}

/// Length of the gradient of the regression terms alone, or of the others.
fn gradient_of<E: Real>(engine: &mut Engine<E>, theta: &[E], regression: bool) -> Result<f64, Fault> {
    let kept: Vec<f64> = engine.groups.iter().flat_map(|g| &g.terms).map(|t| t.factor).collect();
    each_term(engine, |kind, factor| {
        if regresses(kind) != regression {
            *factor = 0.0;
        }
    });
    let mut gradient = vec![E::ZERO; theta.len()];
    let result = engine.loss_and_gradient(theta, &mut gradient);
    let mut kept = kept.into_iter();
    each_term(engine, |_, factor| *factor = kept.next().unwrap_or(1.0));
    result?;
    Ok(gradient.iter().map(|g| g.to_f64() * g.to_f64()).sum::<f64>().sqrt())
}
