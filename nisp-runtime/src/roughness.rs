//! How noisy the points of a cloud are, whatever surface they are of.

use std::num::NonZero;

use nalgebra::{DMatrix, DVector};

use crate::axes::Axes;
use crate::nearest::Nearest;

/// Neighbours that a smooth piece of surface is fitted to, at least, unless they were more than this share of all, and how many such pieces
/// are.
const AROUND: usize = 24;
const SHARE: usize = 4;
const PLACES: usize = 400;
/// Where a piece is thicker than this share of its width, its plane is not told from its noise: more neighbours are taken.
const THICK: f64 = 0.3;
/// So many times as many.
const WIDER: NonZero<usize> = NonZero::new(4).unwrap();

/// Directions along what a cloud of so many components shows over so many coordinates: a curve in a plane, or a surface in space. Nothing of others,
/// as of points that fill a plane.
pub(crate) fn directions(coordinates: usize, components: usize) -> Option<usize> {
    match (coordinates, components) {
        (1, 2) => Some(1),
        (_, 3) => Some(2),
        _ => None,
    }
}

/// Standard deviation of a cloud about smooth pieces of surface, or of a curve where it has one direction instead of two: least squares
/// of a quadratic through the neighbours of some points, across the plane, or the line, that they lie in.
pub(crate) fn roughness(points: &[[f64; 3]], places: &[[f64; 3]], directions: usize) -> Option<f64> {
    // A curve has no second direction, so that a quadratic has three unknowns instead of six.
    let powers = |[x, y, _]: [f64; 3]| [1.0, x, x * x, y, x * y, y * y];
    let unknowns = if directions == 1 { 3 } else { 6 };
    // As many neighbours as unknowns would say nothing.
    let around = (points.len() / SHARE).clamp(2 * unknowns, AROUND);
    if points.len() < 2 * around {
        return None;
    }
    let around = NonZero::new(around)?;
    let tree = Nearest::of(places)?;
    let step = points.len().div_ceil(PLACES);
    let left = places.iter().step_by(step).filter_map(|centre| {
        let Piece { local, widths } = std::iter::successors(Some(around), |around| around.checked_mul(WIDER))
            .map_while(|around| Piece::around(centre, around, points, &tree))
            .find(|piece| {
                piece.widths[directions] <= THICK * piece.widths[directions - 1]
                    || WIDER.get() * piece.local.len() > points.len()
            })?;
        let reach = widths[0].max(f64::MIN_POSITIVE);
        let rows = local.iter().flat_map(|point| powers(point.map(|x| x / reach)).into_iter().take(unknowns));
        let design = DMatrix::from_row_iterator(local.len(), unknowns, rows);
        let heights = DVector::from_iterator(local.len(), local.iter().map(|p| p[directions]));
        let fit = design.clone().svd(true, true).solve(&heights, 1e-10).ok()?;
        Some((heights - design * fit).norm_squared() / (local.len() - unknowns) as f64)
    });
    Some(middle(left.collect()).sqrt())
}

/// The neighbours of a place along the axes of their spread, from the longest axis to the shortest.
struct Piece {
    /// From the middle of the piece.
    local: Vec<[f64; 3]>,
    /// Roots of the sums of squares along the axes.
    widths: [f64; 3],
}

impl Piece {
    fn around(centre: &[f64; 3], around: NonZero<usize>, points: &[[f64; 3]], tree: &Nearest<3>) -> Option<Self> {
        let near: Vec<[f64; 3]> = tree.some(centre, around).iter().map(|found| points[found.index]).collect();
        let axes = Axes::of(&near)?;
        Some(Self { local: near.iter().map(|point| axes.along(point)).collect(), widths: axes.squares.map(f64::sqrt) })
    }
}

/// The value that half of all are below; zero of none.
pub(crate) fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Points of a sphere of radius 1 about (0, 0, -1), noisy along z, and their places.
    fn cap(noise: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let mut random = StdRng::seed_from_u64(5);
        let point = |_| {
            let (x, y): (f64, f64) = (random.random::<f64>() - 0.5, random.random::<f64>() - 0.5);
            let z = (1.0 - x * x - y * y).sqrt() - 1.0 + noise * normal(&mut random);
            ([x, y, z], [x, y, 0.0])
        };
        (0..3000).map(point).unzip()
    }

    #[test]
    fn roughness_is_the_noise_and_not_the_shape() {
        for noise in [0.0, 1e-2] {
            let (points, places) = cap(noise);
            let found = roughness(&points, &places, 2).unwrap();
            assert!((found - noise).abs() < 0.15 * noise + 1e-4, "{found} for {noise}");
        }
    }

    /// An arc in a plane: across the line that its pieces lie in, not across the plane.
    #[test]
    fn roughness_of_a_curve_is_in_its_plane() {
        let mut random = StdRng::seed_from_u64(5);
        for noise in [0.0, 1e-2] {
            let angles = (0..600).map(|at| f64::from(at) / 300.0);
            let points: Vec<[f64; 3]> = angles
                .map(|angle| {
                    let radius = 1.0 + noise * normal(&mut random);
                    [radius * angle.cos(), radius * angle.sin(), 0.0]
                })
                .collect();
            let found = roughness(&points, &points, 1).unwrap();
            assert!((found - noise).abs() < 0.15 * noise + 1e-4, "{found} for {noise}");
        }
    }

    /// Twenty-four of three thousand points are no wider than noise of a tenth is thick.
    #[test]
    fn roughness_of_a_dense_cloud_is_its_noise_too() {
        let (points, places) = cap(0.1);
        let found = roughness(&points, &places, 2).unwrap();
        assert!((found / 0.1 - 1.0).abs() < 0.15, "{found}");
    }
}
