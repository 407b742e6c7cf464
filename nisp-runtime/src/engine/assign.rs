//! Which point of a cloud belongs to which point of a surface.

use std::num::NonZero;

use rayon::prelude::*;

use crate::axes::Axes;
use crate::nearest::Nearest;

/// A cloud, and where each of its points was nearest to a surface when last looked at.
pub(super) struct Assignment<const D: usize> {
    points: Vec<[f64; D]>,
    tree: Nearest<D>,
    nearest: Vec<usize>,
    /// How far the surface may move from `reference` before a point's nearest can change.
    reach: Vec<f64>,
    /// The surface that reaches are counted from.
    reference: Vec<[f64; D]>,
}

impl<const D: usize> Assignment<D> {
    /// An assignment in which no point has a partner yet; nothing where there are no points.
    pub(super) fn new(points: Vec<[f64; D]>) -> Option<Self> {
        let tree = Nearest::of(&points)?;
        Some(Self { nearest: Vec::new(), reach: Vec::new(), reference: Vec::new(), points, tree })
    }

    /// The cloud.
    pub(super) fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// The surface point nearest to each point of the cloud, as last assigned; empty before the first time.
    pub(super) fn nearest(&self) -> &[usize] {
        &self.nearest
    }

    /// Finds the point of a surface, all finite, nearest to each point of the cloud, and returns true if any is another
    /// than before. Points for which it cannot be are left alone; where that is so of all, nothing is allocated.
    pub(super) fn assign(&mut self, surface: &[[f64; D]]) -> bool {
        let moved = match self.reference.len() == surface.len() {
            true => surface.iter().zip(&self.reference).map(|(a, b)| squared_distance(a, b)).fold(0.0, f64::max).sqrt(),
            false => f64::INFINITY,
        };
        let stale = self.reach.iter().filter(|&&reach| reach <= moved).count();
        if stale == 0 && moved.is_finite() {
            return false;
        }
        let Some(tree) = Nearest::of(surface) else { return false };
        // Most must be looked up anyway: begin anew, so that reaches are as long as they can be.
        let anew = moved.is_infinite() || 2 * stale > self.points.len();
        let moved = if anew { 0.0 } else { moved };
        if anew {
            surface.clone_into(&mut self.reference);
            self.nearest.resize(self.points.len(), usize::MAX);
            self.reach.clear();
            self.reach.resize(self.points.len(), f64::NEG_INFINITY);
        }
        let look = |((nearest, reach), point): ((&mut usize, &mut f64), &[f64; D])| {
            if *reach > moved {
                return false;
            }
            let (found, margin) = look_up(&tree, point);
            *reach = margin - moved;
            std::mem::replace(nearest, found) != found
        };
        let states = self.nearest.par_iter_mut().zip(&mut self.reach).zip(&self.points);
        states.map(look).reduce(|| false, |a, b| a | b)
    }

    /// For each surface point, the nearest point of the cloud.
    pub(super) fn nearest_of(&self, surface: &[[f64; D]], nearest: &mut Vec<usize>) {
        surface.par_iter().map(|point| look_up(&self.tree, point).0).collect_into_vec(nearest);
    }
}

fn squared_distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The nearest point of a tree, and half of how much nearer it is than the second.
fn look_up<const D: usize>(tree: &Nearest<D>, point: &[f64; D]) -> (usize, f64) {
    let two = const { NonZero::new(2usize).unwrap() };
    match &tree.some(point, two)[..] {
        [first, second, ..] => (first.index, (second.distance - first.distance) / 2.0),
        [only] => (only.index, f64::INFINITY),
        [] => (0, 0.0),
    }
}

/// Neighbours that a surface's direction is taken from.
const NEIGHBOURS: usize = 10;

/// For each surface point, a unit vector across the surface: the direction in which its neighbours spread least.
pub(super) fn normals<const D: usize>(surface: &[[f64; D]], normals: &mut Vec<[f64; D]>) {
    let Some(tree) = Nearest::of(surface) else { return };
    let count = const { NonZero::new(NEIGHBOURS).unwrap() };
    let normal = |point: &[f64; D]| {
        let around: Vec<[f64; D]> = tree.some(point, count).iter().map(|found| surface[found.index]).collect();
        Axes::of(&around).map_or([0.0; D], |axes| axes.directions[D - 1])
    };
    surface.par_iter().map(normal).collect_into_vec(normals);
}
