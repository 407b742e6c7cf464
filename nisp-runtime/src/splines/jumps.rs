//! Where measurements jump from one to the next.
//!
//! A source that is measured may step. When it did, between two rows, is what the fields know that it moves: with no cell to itself
//! the step takes place at one time alone, and the rows beside it make up for what is wrong with that.

use crate::noise::Noise;
use crate::problem::Bound;

/// A jump over the noise, and over the changes before and after it, at least. A wave of seven rows changes by less beside its steepest
/// place.
const FAR: f64 = 10.0;
const ALONE: f64 = 1.5;

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
            jumps.extend(of_rows(&rows, found.deviation));
        }
    }
    jumps
}

/// The same of values at places that rise.
fn of_rows(rows: &[(f64, f64)], noise: f64) -> Vec<[f64; 2]> {
    let is_jump = |near: &&[(f64, f64)]| {
        let change = |at: usize| (near[at + 1].1 - near[at].1).abs();
        change(1) > FAR * noise && change(1) > ALONE * change(0).max(change(2))
    };
    rows.windows(4).filter(is_jump).map(|near| [near[1].0, near[2].0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_a_jump_and_a_slope_is_none() {
        let rows = |value: &dyn Fn(f64) -> f64| (0..20).map(f64::from).map(|at| (at, value(at))).collect::<Vec<_>>();
        let step = |at: f64| if at < 7.5 { 1.0 } else { 3.0 };
        assert_eq!(of_rows(&rows(&step), 0.1), [[7.0, 8.0]]);
        assert!(of_rows(&rows(&step), 0.3).is_empty());
        assert!(of_rows(&rows(&|at| at), 0.01).is_empty());
        assert!(of_rows(&[], 0.01).is_empty());
    }
}
