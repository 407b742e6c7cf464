//! How much each term counts by its noise.

use crate::engine::Engine;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::evidence;
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
