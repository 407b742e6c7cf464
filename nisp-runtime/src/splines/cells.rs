//! Which cells carry the heads, and where equations are asked to hold.

use super::basis::{Basis, HIGHEST_DEGREE};
use super::drives;
use super::jumps::{jumps, of_columns};
use super::prior;
use super::resolved;
use crate::ends::ends;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Cells at least: what a source may do between few measurements.
const FEWEST: f64 = 200.0;
/// Cells from a measurement to the next where they are exact. With one, as many unknowns as measurements would be left no choice:
/// a jump between two of them would be met by a source that goes to and fro all along the record.
pub(super) const EXACT: f64 = 2.0;
/// Cells from a measurement to the next where what is measured jumps in between.
const JUMP: f64 = 4.0;
/// Breakpoints closer to each other than this share of the record are one.
const ROUNDING: f64 = 1e-9;
/// Measurements closer to each other than this share of their mean distance have one breakpoint.
const CLOSE: f64 = 0.25;
/// Degree of the equations' residuals: cubic splines are good to the fourth power of a cell.
pub(super) const SMOOTH: usize = 5;
/// Longest gap between the points of an equation, beside the mean one, that still counts as part of an interval.
const GAP: f64 = 30.0;
/// Points of an equation at least that stand for an interval.
pub(super) const MANY: usize = 8;

/// Breakpoints of the cells: one at every place of a measurement, and more where those are far apart; fewer where a record is
/// long and says no more.
pub(super) fn breakpoints(bound: &Bound, noise: &Noise) -> Vec<f64> {
    let least = if noise.is_exact() { EXACT } else { 1.0 };
    let all = all_breakpoints(bound, stretches(bound), least, &jumps(bound, noise));
    // On wider cells equations that hold at their own points would be more than the unknowns.
    let is_told = all.len() <= LONG && asked(bound).is_some();
    if is_told || noise.observations.is_empty() {
        return all;
    }
    let groups: Vec<usize> = (0..bound.coordinates.len()).filter(|&at| stands_for_interval(bound, at)).collect();
    let degrees = degrees(bound.problem.scene().schema).unwrap_or_default();
    let drives = drives::drives(bound, &groups, &degrees, &all);
    resolved::breakpoints(bound, noise, drives, all)
}

/// True where a source may set in with the record, in a layer that its start is looked at more closely for. A long record is not
/// one answer to one start. Nor does a source set in whose value a condition states: a source that could leave this value at once would make
/// the condition say nothing.
pub(super) fn stretches(bound: &Bound) -> bool {
    let schema = bound.problem.scene().schema;
    let is_known = |(group, points): (&schema::Group, &Vec<f64>)| {
        let is_condition = |term: &schema::Term| term.kind == TermKind::Residual && group.is_of_values(term);
        let reads_source = group.jets.iter().any(|jet| schema.heads[jet.head].source);
        points.len() < MANY && reads_source && group.terms.iter().any(is_condition)
    };
    prior::may_stretch(schema)
        && bound.coordinates.iter().all(|points| points.len() <= LONG)
        && !schema.groups.iter().zip(&bound.coordinates).any(is_known)
}

/// Breakpoints at all measurements, with so many cells in between at `least`, and more at the start where it `stretches`; as many as equations can tell where those hold at
/// their own points.
fn all_breakpoints(bound: &Bound, stretches: bool, least: f64, jumps: &[[f64; 2]]) -> Vec<f64> {
    if let Some(points) = asked(bound) {
        return freed(told_by(bound, &points), of_columns(bound));
    }
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates);
    let mut measured: Vec<f64> = groups.filter(|(g, _)| !g.columns.is_empty()).flat_map(|(_, c)| c).copied().collect();
    let all = || bound.coordinates.iter().flatten().copied();
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    measured.sort_by(f64::total_cmp);
    let close = CLOSE * (high - low) / measured.len().max(1) as f64;
    measured.dedup_by(|next, before| *next - *before < close.min((high - low) / FEWEST));
    let inside =
        measured.into_iter().filter(|x| *x - low > ROUNDING * (high - low) && high - *x > ROUNDING * (high - low));
    let places: Vec<f64> = std::iter::once(low).chain(inside).chain([high]).collect();
    let mut breakpoints = vec![low];
    for gap in places.windows(2) {
        let share = |at: f64| (at - low) / (high - low);
        // The layer at the start is as wide as the rest along the stretched time.
        let pace = if stretches { (0.5 * prior::pace(share(0.5 * (gap[0] + gap[1])))).max(1.0) } else { 1.0 };
        let is_jump = jumps.iter().any(|jump| jump[0] < gap[1] && gap[0] < jump[1]);
        let least = if is_jump { JUMP.max(least) } else { least };
        let pieces = (FEWEST * pace * (share(gap[1]) - share(gap[0]))).ceil().max(least);
        let piece = |k: u32| gap[0] + (gap[1] - gap[0]) * f64::from(k) / pieces;
        breakpoints.extend((1..pieces as u32).map(piece));
        breakpoints.push(gap[1]);
    }
    breakpoints
}

/// The fewest points at which equations of an interval are asked for, rising, where those are their own: with known columns, or
/// among data.
fn asked(bound: &Bound) -> Option<Vec<f64>> {
    let groups = bound.problem.scene().schema.groups.iter().enumerate();
    let is_asked = |(at, group): &(usize, &schema::Group)| {
        let has_equations = group.terms.iter().any(|term| term.kind == TermKind::Residual);
        let is_free = group.columns.is_empty() && stands_for_interval(bound, *at);
        has_equations && !is_free && bound.coordinates[*at].len() >= MANY
    };
    let distinct = |(at, _): (usize, &schema::Group)| {
        let mut points = bound.coordinates[at].clone();
        points.sort_by(f64::total_cmp);
        points.dedup();
        points
    };
    groups.filter(is_asked).map(distinct).min_by_key(Vec::len)
}

/// Breakpoints for which a residual at these points determines a spline: means of as many neighbours as its degree (de Boor, *A
/// Practical Guide to Splines*, chapter XIII).
fn told_by(bound: &Bound, points: &[f64]) -> Vec<f64> {
    let all = || bound.coordinates.iter().flatten().copied();
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let count = points.len();
    let means = points[1..count - 1].windows(SMOOTH).map(|near| near.iter().sum::<f64>() / SMOOTH as f64);
    std::iter::once(low).chain(means).chain([high]).collect()
}

/// The same with cells of their own between some pairs of neighbouring points, which no equation settles.
fn freed(mut breakpoints: Vec<f64>, mut pairs: Vec<[f64; 2]>) -> Vec<f64> {
    pairs.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let is_between =
        |at: f64| pairs[pairs.partition_point(|pair| pair[1] <= at)..].first().is_some_and(|pair| pair[0] < at);
    breakpoints.retain(|at| !is_between(*at));
    let shares = (0..=JUMP as u32).map(|k| f64::from(k) / JUMP);
    breakpoints
        .extend(shares.flat_map(|share| pairs.iter().map(move |[before, after]| before + (after - before) * share)));
    breakpoints.sort_by(f64::total_cmp);
    let close = ROUNDING * (breakpoints[breakpoints.len() - 1] - breakpoints[0]);
    breakpoints.dedup_by(|next, before| *next - *before < close);
    breakpoints
}

/// Breakpoints from which on a record is asked how many of them it needs.
const LONG: usize = 4000;
/// Measurements, and cells, that say how smooth a source is.
const TELLING: usize = 2000;
const TELLING_CELLS: usize = 400;

/// The middle of a record that is much longer than it need be to say how smooth its sources are: its breakpoints.
pub(super) fn middle<'a>(bound: &Bound, breakpoints: &'a [f64]) -> Option<&'a [f64]> {
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates);
    let (_, longest) = groups.filter(|(g, _)| !g.columns.is_empty()).max_by_key(|(_, points)| points.len())?;
    let mut sorted = longest.clone();
    sorted.sort_by(f64::total_cmp);
    let cells = breakpoints.len() - 1;
    let share = (TELLING as f64 / sorted.len() as f64).max(TELLING_CELLS as f64 / cells as f64);
    if share >= 0.5 {
        return None;
    }
    let at = |part: f64| sorted[(part * (sorted.len() - 1) as f64) as usize];
    // Of the measurements, and of the cells, whichever takes more of the record.
    let by_rows = [0.5 - share / 2.0, 0.5 + share / 2.0].map(at);
    let by_cells = [cells - TELLING_CELLS, cells + TELLING_CELLS].map(|twice| breakpoints[twice.div_ceil(2)]);
    let (low, high) = (by_rows[0].min(by_cells[0]), by_rows[1].max(by_cells[1]));
    let first = breakpoints.partition_point(|&at| at < low);
    let last = breakpoints.partition_point(|&at| at <= high).min(cells);
    (last - first < cells / 2 + 1).then(|| &breakpoints[first..=last])
}

/// The problem between the first and the last of these breakpoints. Equations that stand for an interval hold all along the
/// part, however few of their points are in it.
pub(super) fn part(bound: &Bound, breakpoints: &[f64]) -> Bound {
    let mut part = bound.between(breakpoints[0], breakpoints[breakpoints.len() - 1]);
    for (group, points) in part.coordinates.iter_mut().enumerate() {
        if let Some(Moved { places, columns }) = moved(bound, group, breakpoints) {
            (*points, part.columns[group]) = (places, columns);
        }
    }
    part
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

/// True where a group is equations alone, whose points stand for an interval: it may be asked for at some of them, or elsewhere where
/// no columns are known at them.
pub(super) fn stands_for_interval(bound: &Bound, group: usize) -> bool {
    let schema = &bound.problem.scene().schema.groups[group];
    let only_equations = schema.terms.iter().all(|term| term.kind == TermKind::Residual);
    let mut sorted = bound.coordinates[group].clone();
    sorted.sort_by(f64::total_cmp);
    if !only_equations || sorted.len() < MANY {
        return false;
    }
    let longest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    longest * (sorted.len() - 1) as f64 <= GAP * (sorted[sorted.len() - 1] - sorted[0])
}

/// Places at which the rows of a group are asked for instead of at its points, and its columns there.
pub(super) struct Moved {
    pub(super) places: Vec<f64>,
    pub(super) columns: Vec<Vec<f64>>,
}

/// Where the rows of a group of equations are asked for instead of at its points: at as many places as their residual has freedom, on
/// the interval that the points stand for; at the nearest of the points where columns are known. Nothing where they are asked for at
/// all points, as data and conditions are.
pub(super) fn moved(bound: &Bound, group: usize, breakpoints: &[f64]) -> Option<Moved> {
    if !stands_for_interval(bound, group) {
        return None;
    }
    let own = &bound.coordinates[group];
    let (low, high) = ends(own.iter().copied());
    let residual = Basis::new(SMOOTH, breakpoints);
    let slack = 1e-9 * (high - low);
    let centres = (0..residual.len()).map(|i| residual.centre(i));
    let centres = centres.filter(|at| (low - slack..=high + slack).contains(at));
    if bound.problem.scene().schema.groups[group].columns.is_empty() {
        return Some(Moved { places: centres.collect(), columns: Vec::new() });
    }
    if residual.len() >= own.len() {
        return None;
    }
    let mut order: Vec<usize> = (0..own.len()).collect();
    order.sort_by(|&a, &b| own[a].total_cmp(&own[b]));
    let nearest = |at: f64| {
        let above = order.partition_point(|&point| own[point] < at).min(order.len() - 1);
        let below = above.saturating_sub(1);
        if at - own[order[below]] < own[order[above]] - at { order[below] } else { order[above] }
    };
    let mut chosen: Vec<usize> = centres.map(nearest).collect();
    chosen.dedup();
    let of = |values: &[f64]| chosen.iter().map(|&point| values[point]).collect();
    let columns = bound.filled_columns(group);
    Some(Moved { places: of(own), columns: columns.iter().map(|column| of(column)).collect() })
}
