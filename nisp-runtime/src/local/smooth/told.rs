//! How much data tell of sources on a lattice.

use crate::facts::Told;
use crate::local::kept::KeptLattices;
use crate::problem::Bound;
use crate::solve::vector;

/// Points at which a source is compared with what is known of it, at most.
const MOST: usize = 2000;

/// How much is told of every source, at points of the equations that it is in; nothing without deviations, unless these are lacking.
pub(super) fn told(bound: &Bound, kept: &KeptLattices, is_untold: bool) -> Vec<Told> {
    let schema = bound.problem.scene().schema;
    let sources = (0..schema.heads.len()).filter(|&head| schema.heads[head].source);
    let unasked = |head| is_untold.then(|| Told::unasked(head));
    sources.filter_map(|head| of(head, &points(bound, head), kept).or_else(|| unasked(head))).collect()
}

/// Points of the largest group that reads a head.
fn points(bound: &Bound, head: usize) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let groups = schema.groups.iter().zip(&bound.coordinates);
    let reads = groups.filter(|(group, _)| group.jets.iter().any(|jet| jet.head == head));
    let all = reads.map(|(_, points)| points.as_slice()).max_by_key(|points| points.len()).unwrap_or_default();
    let inputs = schema.coordinates.len();
    let step = (all.len() / inputs).div_ceil(MOST).max(1);
    all.chunks_exact(inputs).step_by(step).flatten().copied().collect()
}

fn of(head: usize, points: &[f64], kept: &KeptLattices) -> Option<Told> {
    let (values, deviations) = (kept.evaluate(head, points), kept.deviations(head, points)?);
    let squares: f64 = values.iter().zip(&deviations).map(|(value, deviation)| (value / deviation).powi(2)).sum();
    // The truth `f` is nearer to the answer `a` than to none if `2 a (f - a) > -a a`.
    let along = kept.deviation_of_sum(&kept.weights_of_sum(head, points, &values))?;
    let nearer = vector::dot(&values, &values) / (2.0 * along);
    Some(Told { head, size: Some((squares / values.len().max(1) as f64).sqrt()), nearer, open: 0.0 })
}
