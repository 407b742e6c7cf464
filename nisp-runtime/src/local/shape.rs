//! A surface in space, and directions along it at rest.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

use super::group::Group;
use super::heads::Heads;

/// Places whose positions are computed together.
const TOGETHER: usize = 512;

/// A surface in space.
pub(super) struct Shape<'a> {
    pub(super) group: &'a Group,
    pub(super) heads: &'a Heads,
    /// [`Group::spread`] of the coefficients.
    pub(super) spread: &'a [Vec<f64>],
    pub(super) scalars: &'a [f64],
    /// First row of the term.
    pub(super) first: usize,
}

impl Shape<'_> {
    /// Positions of places, given flat.
    pub(super) fn positions(&self, flat: &[f64], inputs: usize) -> Vec<Vector3<f64>> {
        let some = |flat: &[f64]| {
            let sites = self.group.sites_at(self.heads, flat);
            let rows = self.group.evaluate_at(&sites, self.heads, self.spread, self.scalars, false);
            let position = |p: usize| Vector3::from_fn(|c, _| rows.row(self.first + c, p));
            (0..sites.count).map(position).collect::<Vec<_>>()
        };
        flat.par_chunks(TOGETHER * inputs).flat_map_iter(some).collect()
    }
}

/// A place at rest in three numbers.
pub(super) fn padded(point: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0))
}

/// Two directions along the surface at rest, flat: the axes of a plane domain, or where the neighbours lie.
pub(super) fn tangents_at(
    tree: Option<&ImmutableKdTree<f64, 3>>,
    samples: &[[f64; 3]],
    at: &[f64; 3],
    inputs: usize,
) -> Vec<f64> {
    const NEIGHBOURS: std::num::NonZero<usize> = std::num::NonZero::new(12).unwrap();
    if inputs == 2 {
        return vec![1.0, 0.0, 0.0, 1.0];
    }
    let Some(tree) = tree else { return vec![0.0; 2 * inputs] };
    let around = tree.query(at).nearest_n::<SquaredEuclidean<f64>>(NEIGHBOURS).execute();
    let around: Vec<&[f64; 3]> = around.iter().map(|found| &samples[found.item as usize]).collect();
    let count = around.len().max(1) as f64;
    let mean: [f64; 3] = std::array::from_fn(|i| around.iter().map(|p| p[i]).sum::<f64>() / count);
    let spread: DMatrix<f64> =
        DMatrix::from_fn(3, 3, |i, j| around.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum());
    let axes = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| axes.eigenvalues[j].total_cmp(&axes.eigenvalues[i]));
    order[..2].iter().flat_map(|&i| axes.eigenvectors.column(i).iter().copied().collect::<Vec<_>>()).collect()
}
