//! Where a group holds, of which points are all that is known.

use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// How far a neighbour may be, over the mean distance of the points; and how many points at most that distance is taken from.
const AROUND: f64 = 2.0;
const FEW: usize = 800;

/// A domain, by the points of a group in it and those of conditions on its sides. Lengths are over the largest range of those that share a scale:
/// points are even in these, however long and narrow the domain is.
pub(super) struct Domain {
    low: Vec<f64>,
    widths: Vec<f64>,
    points: Vec<f64>,
    around: f64,
}

impl Domain {
    /// The domain of a group.
    pub(super) fn new(bound: &Bound, group: usize) -> Self {
        let schema = bound.problem.scene().schema;
        let inputs = schema.coordinates.len();
        let own = &bound.coordinates[group];
        let range = |axis: usize| {
            let values = own.iter().skip(axis).step_by(inputs);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
        };
        let ranges: Vec<(f64, f64)> = (0..inputs).map(range).collect();
        let width = |axis: usize| (ranges[axis].1 - ranges[axis].0).max(f64::MIN_POSITIVE);
        let scale = |axis: usize| schema.coordinates[axis].scale_group;
        let tied = |axis: usize| (0..inputs).filter(move |&other| scale(other) == scale(axis));
        let widths: Vec<f64> = (0..inputs).map(|axis| tied(axis).map(width).fold(0.0, f64::max)).collect();
        let volume = (0..inputs).map(|axis| width(axis) / widths[axis]).product::<f64>();
        let around = AROUND * (volume / (own.len() / inputs).min(FEW) as f64).powf((inputs as f64).recip());
        let is_condition = |at: &usize| {
            let other = &schema.groups[*at];
            let is_residual = |term: &schema::Term| term.kind == TermKind::Residual;
            other.order < schema.groups[group].order && other.terms.iter().all(is_residual)
        };
        let conditions = (0..schema.groups.len()).filter(is_condition).flat_map(|at| &bound.coordinates[at]);
        let mut domain = Self { low: ranges.iter().map(|range| range.0).collect(), widths, points: Vec::new(), around };
        let all: Vec<f64> = own.iter().chain(conditions).copied().collect();
        domain.points = all.chunks_exact(inputs).flat_map(|point| domain.scaled(point)).collect();
        domain
    }

    fn scaled(&self, point: &[f64]) -> Vec<f64> {
        let along = point.iter().zip(self.low.iter().zip(&self.widths));
        along.map(|(x, (low, width))| (x - low) / width).collect()
    }

    /// Whether there are points on all sides of this one, none of them far: on either side along every coordinate. Where conditions are
    /// missing, points do not reach the sides.
    pub(super) fn is_inside(&self, point: &[f64]) -> bool {
        let inputs = self.low.len();
        let point = self.scaled(point);
        let mut is_seen = vec![[false; 2]; inputs];
        for other in self.points.chunks_exact(inputs) {
            let apart = point.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            if apart > self.around.powi(2) {
                continue;
            }
            for (sides, (a, b)) in is_seen.iter_mut().zip(point.iter().zip(other)) {
                sides[usize::from(b > a)] = true;
            }
            if is_seen.iter().all(|sides| *sides == [true; 2]) {
                return true;
            }
        }
        false
    }
}
