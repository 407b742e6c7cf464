//! A surface in space, or a curve in a plane, and directions along it at rest.

use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::group::Group;
use super::heads::Heads;
use crate::axes::Axes;
use crate::nearest::Nearest;

/// Places whose positions are computed together.
const TOGETHER: usize = 512;

/// A surface in space.
pub(super) struct Shape<'a> {
    pub(super) group: &'a Group,
    pub(super) heads: &'a Heads,
    /// [`Group::spread`] of the coefficients.
    pub(super) spread: &'a [Vec<f64>],
    pub(super) scalars: &'a [f64],
    /// Rows of the term: components of a position.
    pub(super) rows: Range<usize>,
}

impl Shape<'_> {
    /// Positions of places, given flat.
    pub(super) fn positions(&self, flat: &[f64], inputs: usize) -> Vec<Vector3<f64>> {
        let some = |flat: &[f64]| {
            let sites = self.group.sites_at(self.heads, flat);
            let rows = self.group.evaluate_at(&sites, self.heads, self.spread, self.scalars, false);
            let component = |c: usize, p: usize| self.rows.clone().nth(c).map_or(0.0, |row| rows.row(row, p));
            let position = |p: usize| Vector3::from_fn(|c, _| component(c, p));
            (0..sites.count).map(position).collect::<Vec<_>>()
        };
        flat.par_chunks(TOGETHER * inputs).flat_map_iter(some).collect()
    }
}

/// A place at rest in three numbers.
pub(super) fn padded(point: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0))
}

/// Directions along the surface at rest, flat: the axes of a plane domain or of a line, or two towards which the neighbours lie.
pub(super) fn tangents_at(tree: Option<&Nearest<3>>, samples: &[[f64; 3]], at: &[f64; 3], inputs: usize) -> Vec<f64> {
    const NEIGHBOURS: std::num::NonZero<usize> = std::num::NonZero::new(12).unwrap();
    match inputs {
        1 => return vec![1.0],
        2 => return vec![1.0, 0.0, 0.0, 1.0],
        _ => {}
    }
    let Some(tree) = tree else { return vec![0.0; 2 * inputs] };
    let around: Vec<[f64; 3]> = tree.some(at, NEIGHBOURS).iter().map(|found| samples[found.index]).collect();
    Axes::of(&around).map_or(vec![0.0; 2 * inputs], |axes| axes.directions[..2].concat())
}
