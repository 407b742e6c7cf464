//! Which cells carry the heads, and where equations are asked to hold.

use super::basis::{Basis, HIGHEST_DEGREE};
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Cells at least: what a source may do between few measurements.
const FEWEST: f64 = 200.0;
/// Measurements closer to each other than this share of their mean distance have one breakpoint.
const CLOSE: f64 = 0.25;
/// Degree of the equations' residuals: cubic splines are good to the fourth power of a cell.
const SMOOTH: usize = 5;
/// Longest gap between the points of an equation, beside the mean one, that still counts as part of an interval.
const GAP: f64 = 30.0;
/// Points of an equation at least that stand for an interval.
const MANY: usize = 8;

/// Breakpoints of the cells: one at every place of a measurement, and more where those are far apart.
pub(super) fn breakpoints(bound: &Bound) -> Vec<f64> {
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates);
    let mut measured: Vec<f64> = groups.filter(|(g, _)| !g.columns.is_empty()).flat_map(|(_, c)| c).copied().collect();
    let all = || bound.coordinates.iter().flatten().copied();
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    measured.sort_by(f64::total_cmp);
    let close = CLOSE * (high - low) / measured.len().max(1) as f64;
    measured.dedup_by(|next, before| *next - *before < close.min((high - low) / FEWEST));
    let inside = measured.into_iter().filter(|x| *x - low > 1e-9 * (high - low) && high - *x > 1e-9 * (high - low));
    let places: Vec<f64> = std::iter::once(low).chain(inside).chain([high]).collect();
    let mut breakpoints = vec![low];
    for gap in places.windows(2) {
        let pieces = (FEWEST * (gap[1] - gap[0]) / (high - low)).ceil().max(1.0);
        let piece = |k: u32| gap[0] + (gap[1] - gap[0]) * f64::from(k) / pieces;
        breakpoints.extend((1..pieces as u32).map(piece));
        breakpoints.push(gap[1]);
    }
    breakpoints
}

/// Measurements that say how smooth a source is.
const TELLING: usize = 2000;

/// The middle of a record that is much longer than it need be to say how smooth its sources are.
pub(super) fn middle(bound: &Bound) -> Option<(f64, f64)> {
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates);
    let (_, longest) = groups.filter(|(g, _)| !g.columns.is_empty()).max_by_key(|(_, points)| points.len())?;
    let mut sorted = longest.clone();
    sorted.sort_by(f64::total_cmp);
    let first = sorted.len().checked_sub(TELLING)? / 2;
    (sorted.len() > 2 * TELLING).then(|| (sorted[first], sorted[first + TELLING - 1]))
}

/// Degrees of the heads' splines: so much above the order of their highest derivative that residuals are smooth. Nothing where
/// the degree would be too high.
pub(super) fn degrees(schema: &schema::Scene) -> Option<Vec<usize>> {
    let order = |head: usize| {
        let jets = schema.groups.iter().flat_map(|group| group.jets).filter(|jet| jet.head == head);
        jets.flat_map(|jet| jet.operator).map(|(order, _)| usize::from(order[0])).max().unwrap_or(0)
    };
    let degrees: Vec<usize> = (0..schema.heads.len()).map(|head| SMOOTH + order(head)).collect();
    degrees.iter().all(|&degree| degree <= HIGHEST_DEGREE).then_some(degrees)
}

/// Places where a group's rows are asked for: those of its data or conditions, or as many on the interval that an equation's
/// points stand for as its residual has freedom.
pub(super) fn places(bound: &Bound, group: usize, breakpoints: &[f64]) -> Vec<f64> {
    let own = &bound.coordinates[group];
    let schema = &bound.problem.scene().schema.groups[group];
    let only_equations = schema.columns.is_empty() && schema.terms.iter().all(|term| term.kind == TermKind::Residual);
    let mut sorted = own.clone();
    sorted.sort_by(f64::total_cmp);
    if !only_equations || sorted.len() < MANY {
        return own.clone();
    }
    let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
    let longest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    if longest * (sorted.len() - 1) as f64 > GAP * (high - low) {
        return own.clone();
    }
    let residual = Basis::new(SMOOTH, breakpoints);
    let slack = 1e-9 * (high - low);
    (0..residual.len()).map(|i| residual.centre(i)).filter(|at| (low - slack..=high + slack).contains(at)).collect()
}
