//! What each point of a condition stands for. Means are as good as this is known: of a curve, from the points beside it.

use std::num::NonZero;

use crate::ends::ends;
use crate::local::lattice::MOST_COORDINATES;
use crate::nearest::{Nearest, Neighbour};
use crate::problem::Bound;

/// Neighbours of a point among which the next ones along the curve are.
const NEAR: NonZero<usize> = NonZero::new(8).unwrap();

type Place = [f64; MOST_COORDINATES];

/// What the points of a condition stand for where it is on curves; of those on surfaces all count alike.
pub(super) fn shares(bound: &Bound, group: usize) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let groups = schema.conditions();
    let widths: Vec<f64> = (0..inputs).map(|axis| width(bound, &groups, axis)).collect();
    let places = |at: usize| {
        let place = |point: &[f64]| {
            let mut place = Place::default();
            place.iter_mut().zip(point.iter().zip(&widths)).for_each(|(own, (x, width))| *own = x / width);
            place
        };
        bound.coordinates[at].chunks_exact(inputs).map(place).collect::<Vec<Place>>()
    };
    let own = places(group);
    if inputs > 2 {
        return vec![1.0; own.len()];
    }
    let others: Vec<Place> = groups.into_iter().filter(|&at| at != group).flat_map(places).collect();
    along_curves(&own, &others)
}

/// Width of the points of groups along a coordinate.
pub(super) fn width(bound: &Bound, groups: &[usize], axis: usize) -> f64 {
    let inputs = bound.problem.scene().schema.coordinates.len();
    let values = groups.iter().flat_map(|&at| bound.coordinates[at].iter().skip(axis).step_by(inputs));
    let (low, high) = ends(values.copied());
    (high - low).max(f64::MIN_POSITIVE)
}

/// Half of the way to the next point on either side. A curve goes on to the nearest point of others where its own points end, though no
/// farther than to its next one.
fn along_curves(own: &[Place], others: &[Place]) -> Vec<f64> {
    let Some(tree) = Nearest::of(own) else { return Vec::new() };
    let other = Nearest::of(others);
    let share = |place: &Place| {
        let near = tree.some(place, NEAR);
        let mut near = near.iter().filter(|next| next.distance > 0.0);
        let Some(next) = near.next() else { return 1.0 };
        let towards = |at: &Neighbour| own[at.index].iter().zip(place).map(|(x, from)| x - from).collect::<Vec<f64>>();
        let ahead = towards(next);
        let is_behind = |at: &&Neighbour| towards(at).iter().zip(&ahead).map(|(a, b)| a * b).sum::<f64>() < 0.0;
        let behind = near.find(is_behind).map(|at| 0.5 * at.distance);
        let end = || other.as_ref().map_or(0.0, |other| other.one(place).distance).min(next.distance);
        0.5 * next.distance + behind.unwrap_or_else(end)
    };
    own.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Two sides of a square with points at random, and a third one where they begin.
    #[test]
    fn means_along_curves_are_integrals() {
        let mut random = StdRng::seed_from_u64(1);
        let own: Vec<Place> = (0..400).map(|i| [f64::from(i % 2), random.random(), 0.0, 0.0]).collect();
        let others: Vec<Place> = (0..400).map(|i| [f64::from(i) / 399.0, 0.0, 0.0, 0.0]).collect();
        let shares = along_curves(&own, &others);
        let mean =
            |of: &dyn Fn(f64) -> f64| own.iter().zip(&shares).map(|(place, share)| share * of(place[1])).sum::<f64>();
        assert!((mean(&|_| 1.0) - 2.0).abs() < 0.02);
        assert!((mean(&|t| (1.0 - 10.0 * t).max(0.0)) - 0.1).abs() < 2e-3);
    }

    #[test]
    fn ends_of_even_points_count_half() {
        let own: Vec<Place> = (0..5).map(|i| [0.0, f64::from(i), 0.0, 0.0]).collect();
        assert_eq!(along_curves(&own, &[own[0], own[4]]), [0.5, 1.0, 1.0, 1.0, 0.5]);
    }
}
