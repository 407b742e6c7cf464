//! Which point of a cloud belongs to which point of a surface.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// A cloud of points of two to four coordinates, and where each was nearest to a surface when last looked at.
pub(super) trait Cloud: Send + Sync {
    /// Number of points.
    fn len(&self) -> usize;

    /// Coordinates of a point.
    fn point(&self, at: usize) -> &[f64];

    /// Finds the surface point nearest to each point of the cloud; `surface` is flat and point by point, and finite.
    /// Points for which it cannot have changed since they were last looked at are left alone.
    fn assign(&mut self, surface: &[f64]);

    /// The surface point nearest to each point of the cloud, as last assigned.
    fn nearest(&self) -> &[usize];

    /// For each surface point, the nearest point of the cloud.
    fn nearest_of(&self, surface: &[f64]) -> Vec<usize>;

    /// For each surface point, a unit vector across the surface: the direction in which its neighbours spread least.
    fn normals(&self, surface: &[f64]) -> Vec<f64>;
}

/// A cloud from flat coordinates; nothing unless there are two to four coordinates, and a point.
pub(super) fn cloud(points: &[f64], dimensions: usize) -> Option<Box<dyn Cloud>> {
    Some(match dimensions {
        2 => Box::new(Tracked::<2>::new(points)?),
        3 => Box::new(Tracked::<3>::new(points)?),
        4 => Box::new(Tracked::<4>::new(points)?),
        _ => return None,
    })
}

/// Neighbours that a surface's direction is taken from.
const NEIGHBOURS: usize = 10;

struct Tracked<const D: usize> {
    points: Vec<[f64; D]>,
    tree: ImmutableKdTree<f64, D>,
    nearest: Vec<usize>,
    /// How far the surface may move from `reference` before a point's nearest can change.
    reach: Vec<f64>,
    /// The surface that reaches are counted from.
    reference: Vec<[f64; D]>,
}

impl<const D: usize> Tracked<D> {
    fn new(points: &[f64]) -> Option<Self> {
        let points = arrays(points);
        let tree = tree(&points)?;
        Some(Self { nearest: Vec::new(), reach: Vec::new(), reference: Vec::new(), points, tree })
    }
}

fn arrays<const D: usize>(flat: &[f64]) -> Vec<[f64; D]> {
    flat.as_chunks().0.to_vec()
}

fn tree<const D: usize>(points: &[[f64; D]]) -> Option<ImmutableKdTree<f64, D>> {
    if points.is_empty() { None } else { ImmutableKdTree::new_from_slice(points).ok() }
}

fn squared_distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The nearest point of a tree, and half of how much nearer it is than the second.
fn look_up<const D: usize>(tree: &ImmutableKdTree<f64, D>, point: &[f64; D]) -> (usize, f64) {
    let two = const { NonZero::new(2usize).unwrap() };
    let found = tree.query(point).nearest_n::<SquaredEuclidean<f64>>(two).execute();
    match &found[..] {
        [first, second, ..] => (first.item as usize, (second.distance.sqrt() - first.distance.sqrt()) / 2.0),
        [only] => (only.item as usize, f64::INFINITY),
        [] => (0, 0.0),
    }
}

impl<const D: usize> Cloud for Tracked<D> {
    fn len(&self) -> usize {
        self.points.len()
    }

    fn point(&self, at: usize) -> &[f64] {
        &self.points[at]
    }

    fn assign(&mut self, surface: &[f64]) {
        let surface: Vec<[f64; D]> = arrays(surface);
        let moved = match self.reference.len() == surface.len() {
            true => surface.iter().zip(&self.reference).map(|(a, b)| squared_distance(a, b)).fold(0.0, f64::max).sqrt(),
            false => f64::INFINITY,
        };
        let stale = self.reach.iter().filter(|&&reach| reach <= moved).count();
        if stale == 0 && moved.is_finite() {
            return;
        }
        let Some(tree) = tree(&surface) else { return };
        // Most must be looked up anyway: begin anew, so that reaches are as long as they can be.
        let anew = moved.is_infinite() || 2 * stale > self.points.len();
        let (moved, count) = if anew { (0.0, self.points.len()) } else { (moved, self.nearest.len()) };
        if anew {
            self.reference = surface;
            self.nearest.resize(count, 0);
            self.reach = vec![f64::NEG_INFINITY; count];
        }
        let states = self.nearest.par_iter_mut().zip(&mut self.reach);
        states.zip(&self.points).for_each(|((nearest, reach), point)| {
            if *reach <= moved {
                let (found, margin) = look_up(&tree, point);
                (*nearest, *reach) = (found, margin - moved);
            }
        });
    }

    fn nearest(&self) -> &[usize] {
        &self.nearest
    }

    fn nearest_of(&self, surface: &[f64]) -> Vec<usize> {
        let (points, _) = surface.as_chunks::<D>();
        points.par_iter().map(|point| look_up(&self.tree, point).0).collect()
    }

    fn normals(&self, surface: &[f64]) -> Vec<f64> {
        let points: Vec<[f64; D]> = arrays(surface);
        let Some(tree) = tree(&points) else { return Vec::new() };
        let count = const { NonZero::new(NEIGHBOURS).unwrap() };
        let normal = |point: &[f64; D]| {
            let around = tree.query(point).nearest_n::<SquaredEuclidean<f64>>(count).execute();
            let around: Vec<&[f64; D]> = around.iter().map(|found| &points[found.item as usize]).collect();
            let count = around.len().max(1) as f64;
            let mean: [f64; D] = std::array::from_fn(|i| around.iter().map(|p| p[i]).sum::<f64>() / count);
            let spread =
                DMatrix::from_fn(D, D, |i, j| around.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum());
            let axes = spread.symmetric_eigen();
            let (least, _) = axes.eigenvalues.argmin();
            axes.eigenvectors.column(least).iter().copied().collect::<Vec<f64>>()
        };
        points.par_iter().flat_map_iter(normal).collect()
    }
}
