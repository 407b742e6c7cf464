//! How far a source may be from what few places of measurement say of it. How much it varies along a coordinate is itself found from
//! the places along it: two probes in a rod say next to nothing of what it does between them.

use crate::ends::ends;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::student;

/// Places along a coordinate that are closer than this share of the domain count as one.
const APART: f64 = 1e-2;

/// What deviations of a source are multiplied by: Student's quantiles are so much larger than the normal ones, for as many places as
/// its data have along the coordinate of its own along which they have fewest.
pub(super) fn widened(bound: &Bound, head: usize) -> f64 {
    let along = bound.problem.scene().schema.axes(head);
    let fewest = along.iter().map(|&axis| places(bound, axis)).min();
    fewest.map_or(1.0, |places| student::longer(places.max(1) as f64))
}

/// Places along a coordinate at which anything is measured.
fn places(bound: &Bound, axis: usize) -> usize {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let measures = |group: &schema::Group| {
        group.terms.iter().any(|term| matches!(term.kind, TermKind::Observation | TermKind::Chamfer { .. }))
    };
    let of = |points: &Vec<f64>| points.iter().skip(axis).step_by(inputs).copied().collect::<Vec<f64>>();
    let groups = || schema.groups.iter().zip(&bound.coordinates);
    let mut measured: Vec<f64> =
        groups().filter(|(group, _)| measures(group)).flat_map(|(_, points)| of(points)).collect();
    let all = groups().flat_map(|(_, points)| of(points));
    let (low, high) = ends(all);
    measured.sort_by(f64::total_cmp);
    let mut last = f64::NEG_INFINITY;
    let is_new = |x: &f64| {
        let is_new = x - last > APART * (high - low);
        last = if is_new { *x } else { last };
        is_new
    };
    measured.into_iter().filter(is_new).count()
}
