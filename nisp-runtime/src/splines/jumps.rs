//! Where measurements, or known columns of equations, jump from one row to the next.
//!
//! A source that is measured may step. When it did, between two rows, is what the fields know that it moves: with no cell to itself
//! the step takes place at one time alone, and the rows beside it make up for what is wrong with that.

use crate::noise::{Noise, deviation, of_given};
use crate::problem::Bound;
use crate::schema::{Group, TermKind};

/// A jump over the noise, and over the changes before and after it, at least. A wave of seven rows changes by less beside its steepest
/// place.
const FAR: f64 = 10.0;
const ALONE: f64 = 1.5;
/// A jump of a slope over the changes of the slopes before and behind it, at least. A wave of eleven rows changes by less beside its crest.
const TURNED: f64 = 3.0;
/// A jump of a column that equations know, over the changes before and after it. It is stricter, since no equation is asked for between
/// the two rows: a drive with three rows to a wave is no switch.
const SWITCHED: f64 = 4.0;
/// Noise that a column is looked at with at least, as a share of what it varies by: smaller jumps set little going.
const SLIGHT: f64 = 0.01;

/// Pairs of places between which something that is observed jumps.
pub(super) fn jumps(bound: &Bound, noise: &Noise) -> Vec<[f64; 2]> {
    let schema = bound.problem.scene().schema;
    let mut jumps = Vec::new();
    for found in &noise.observations {
        for &column in schema.groups[found.group].terms[found.term].columns {
            let all =
                bound.coordinates[found.group].iter().copied().zip(bound.columns[found.group][column].iter().copied());
            let mut rows: Vec<(f64, f64)> = all.filter(|(_, value)| !value.is_nan()).collect();
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
            jumps.extend(of_rows(&rows, found.deviation, ALONE));
            jumps.extend(of_slopes(&rows, found.deviation));
        }
    }
    jumps
}

/// Pairs of neighbouring places of equations with columns, between which fields may move faster than the equations say: where a
/// column jumps, and behind it. A switch may be thrown anywhere between two rows, and what it sets going may be over before the next.
pub(super) fn of_columns(bound: &Bound) -> Vec<[f64; 2]> {
    let groups = bound.problem.scene().schema.groups.iter().enumerate();
    let is_equation = |group: &Group| group.terms.iter().any(|term| term.kind == TermKind::Residual);
    let mut jumps = Vec::new();
    for (at, _) in groups.filter(|(_, group)| is_equation(group)) {
        for (column, noise) in bound.columns[at].iter().zip(of_given(bound, at)) {
            let mut rows: Vec<(f64, f64)> = bound.coordinates[at].iter().copied().zip(column.iter().copied()).collect();
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
            // Before its first row and behind its last one, a column is taken to stay as it is.
            let [before, after] = [rows.first(), rows.last()].map(|end| end.copied().into_iter());
            let rows: Vec<(f64, f64)> = before.chain(rows.iter().copied()).chain(after).collect();
            let found = of_rows(&rows, noise.max(SLIGHT * deviation(column)), SWITCHED);
            let behind =
                |jump: &[f64; 2]| rows.get(rows.partition_point(|row| row.0 <= jump[1])).map(|next| [jump[1], next.0]);
            jumps.extend(found.iter().filter_map(behind));
            jumps.extend(found);
        }
    }
    jumps
}

/// Pairs of neighbouring places between which values jump; the places rise.
fn of_rows(rows: &[(f64, f64)], noise: f64, alone: f64) -> Vec<[f64; 2]> {
    let is_jump = |near: &&[(f64, f64)]| {
        let change = |at: usize| (near[at + 1].1 - near[at].1).abs();
        change(1) > FAR * noise && change(1) > alone * change(0).max(change(2))
    };
    rows.windows(4).filter(is_jump).map(|near| [near[1].0, near[2].0]).collect()
}

/// Pairs of neighbouring places between which the slope of values jumps: something that moves them was switched. The slope between the two
/// is one of both. A switch close to a row may be found on both sides of it.
fn of_slopes(rows: &[(f64, f64)], noise: f64) -> Vec<[f64; 2]> {
    let is_jump = |near: &&[(f64, f64)]| {
        let gap = |at: usize| near[at + 1].0 - near[at].0;
        let slope = |at: usize| (near[at + 1].1 - near[at].1) / gap(at);
        let change = |from: usize, to: usize| (slope(to) - slope(from)).abs();
        change(1, 3) > FAR * noise * (1.0 / gap(1) + 1.0 / gap(3))
            && change(1, 3) > TURNED * change(0, 1).max(change(3, 4))
    };
    rows.windows(6).filter(is_jump).map(|near| [near[2].0, near[3].0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_a_jump_and_a_slope_is_none() {
        let rows = |value: &dyn Fn(f64) -> f64| (0..20).map(f64::from).map(|at| (at, value(at))).collect::<Vec<_>>();
        let step = |at: f64| if at < 7.5 { 1.0 } else { 3.0 };
        assert_eq!(of_rows(&rows(&step), 0.1, ALONE), [[7.0, 8.0]]);
        assert!(of_rows(&rows(&step), 0.3, ALONE).is_empty());
        assert!(of_rows(&rows(&|at| at), 0.01, ALONE).is_empty());
        assert!(of_rows(&[], 0.01, ALONE).is_empty());
    }

    #[test]
    fn a_slope_jumps_where_it_is_another_behind_and_not_where_it_turns() {
        let rows = |value: &dyn Fn(f64) -> f64| (0..20).map(f64::from).map(|at| (at, value(at))).collect::<Vec<_>>();
        let switched = |at: f64| if at < 7.4 { at } else { 14.8 - at };
        assert_eq!(of_slopes(&rows(&switched), 0.05), [[7.0, 8.0]]);
        assert!(of_slopes(&rows(&switched), 0.2).is_empty());
        // A wave of eleven rows, wherever it begins.
        for begin in 0..11 {
            assert!(of_slopes(&rows(&|at| (0.571 * at + 0.1 * f64::from(begin)).sin()), 1e-6).is_empty());
        }
        assert!(of_slopes(&rows(&|at| at * at), 1e-6).is_empty());
    }
}
