//! What is known of an answer: the posterior of heads at a few points and of learned scalars, as a square root.

use crate::local::LocalSolution;
use crate::network::Architecture;
use crate::problem::Bound;
use crate::solve::curvature::Curvature;
use crate::solve::posterior;
use crate::splines::{Root, SplineSolution};
use crate::units::Number;

/// Points that an answer is looked at, at most.
const SAMPLE: usize = 64;

/// A square root `X` of the covariance `X X^T` of quantities, with a row for each and the same columns for all, so that rows
/// tell which quantities move together.
pub(super) struct Spread {
    /// Points, flat, in declared units.
    pub(super) points: Vec<f64>,
    /// By head: values at the points and rows, in the engine's units.
    pub(super) heads: Vec<(Vec<f64>, Vec<f64>)>,
    /// Rows of the learned scalars' parameters, which are of the order of one.
    pub(super) learned: Vec<f64>,
    /// How many learned scalars there are.
    pub(super) scalars: usize,
}

impl Spread {
    /// The spread of a network; nothing where its curvature cannot be factorised.
    pub(super) fn of_network(
        bound: &Bound,
        architecture: Architecture,
        curvature: &Curvature,
        theta: &[f64],
    ) -> Option<Self> {
        let points = sample(bound);
        let (values, derivatives) = bound.frame().sensitivities(architecture, theta, &bound.inward(&points))?;
        let spread = posterior::spread(curvature, &derivatives);
        let len = theta.len();
        let count = (values.len() / bound.problem.scene().schema.heads.len().max(1)).max(1);
        let heads = values.chunks_exact(count).zip(spread.chunks_exact(count * len));
        let heads = heads.map(|(values, rows)| (values.to_vec(), rows.to_vec())).collect();
        let scalars = bound.learned.len();
        let mut unit = vec![0.0; scalars * len];
        // Learned scalars are the last parameters.
        (0..scalars).for_each(|row| unit[row * len + len - scalars + row] = 1.0);
        Some(Self { points, heads, learned: posterior::spread(curvature, &unit), scalars })
    }

    /// The spread of local functions; it has no columns where there was no time for draws.
    pub(super) fn of_local(bound: &Bound, found: &LocalSolution) -> Self {
        let points = sample(bound);
        let inward = bound.inward(&points);
        let heads = 0..bound.problem.scene().schema.heads.len();
        let heads = heads.map(|head| (found.kept.evaluate(head, &inward), found.kept.spread(head, &inward))).collect();
        Self { points, heads, learned: found.kept.spread_of_learned(), scalars: found.kept.learned.len() }
    }

    /// The spread of splines, from one of their roots.
    pub(super) fn of_splines(bound: &Bound, found: &SplineSolution, root: &Root) -> Self {
        let points = sample(bound);
        let inward = bound.inward(&points);
        let kept = &found.kept;
        let head = |head| (kept.evaluate(head, &inward), kept.spread(&root.triangle, head, &inward));
        let heads = (0..bound.problem.scene().schema.heads.len()).map(head).collect();
        Self { points, heads, learned: kept.spread_of_learned(&root.triangle), scalars: bound.learned.len() }
    }
}

/// Points of the largest group, in declared units.
fn sample(bound: &Bound) -> Vec<f64> {
    let coordinates = bound.problem.scene().schema.coordinates;
    let largest = bound.coordinates.iter().max_by_key(|points| points.len());
    let points: Vec<&[f64]> = largest.map_or(Vec::new(), |points| points.chunks_exact(coordinates.len()).collect());
    let step = points.len().div_ceil(SAMPLE).max(1);
    let outward = |point: &&[f64]| -> Vec<f64> {
        let along = point.iter().zip(coordinates).map(|(&x, c)| bound.system.outward(&c.unit).of(Number::engine(x)));
        along.map(Number::as_declared).collect()
    };
    points.iter().step_by(step).flat_map(outward).collect()
}
