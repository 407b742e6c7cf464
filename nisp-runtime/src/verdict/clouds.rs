//! What an answer's surface leaves of a cloud: no more than the cloud's own roughness, and without a pattern.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::num::NonZero;

use super::patterns::BELOW;
use super::{Check, root_mean_square};
use crate::facts::CloudFacts;
use crate::problem::Bound;

/// Misfit over roughness.
const MISFIT: f64 = 1.35;
/// Share of points that may have no place on the surface: strays, and what is seen beside the body.
const LOST: f64 = 0.1;
/// Correlation of neighbouring misfits in its own standard deviations, and the share of the misfit's square below which it
/// does not matter.
const PATTERN: f64 = 5.0;
const SLIGHT: f64 = 0.02;
/// Neighbours whose misfits are compared.
const NEIGHBOURS: NonZero<usize> = NonZero::new(5).unwrap();
/// Neighbours that a smooth piece of surface is fitted to, at least, and how many such pieces are.
const AROUND: NonZero<usize> = NonZero::new(24).unwrap();
const PLACES: usize = 400;
/// Where a piece is thicker than this share of its width, its plane is not told from its noise: more neighbours are taken.
const THICK: f64 = 0.3;
/// So many times as many.
const WIDER: NonZero<usize> = NonZero::new(4).unwrap();

/// Checks of one cloud.
pub(super) fn checks(bound: &Bound, cloud: &CloudFacts) -> Vec<Check> {
    let schema = &bound.problem.scene().schema.groups[cloud.group];
    let Some(term) = schema.terms.iter().find(|term| term.name == cloud.term) else { return Vec::new() };
    let place = (schema.name, term.name);
    let outward = bound.system.outward(&term.unit);
    let unit = term.unit.behind();
    let all = cloud.points.iter().zip(&cloud.places).zip(&cloud.misfits);
    let found: Vec<_> = all.filter_map(|((point, place), misfit)| Some((*point, *place, (*misfit)?))).collect();
    let lost = cloud.points.len() - found.len();
    let share = lost as f64 / cloud.points.len().max(1) as f64;
    let said = format!(
        "{lost} of the {} points of `{}` have no place on the surface: is it a cloud of this body, in its frame and unit?",
        cloud.points.len(),
        term.name
    );
    let mut checks = vec![Check::new("seen", place, (share, LOST), said)];
    let points: Vec<[f64; 3]> = found.iter().map(|(point, ..)| *point).collect();
    let places: Vec<[f64; 3]> = found.iter().map(|(_, place, _)| *place).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return checks };
    // Strays count for nothing here: the share of the cloud that they may make up is checked above.
    let typical = middle(found.iter().map(|(.., misfit)| misfit.abs()).collect());
    let kept: Vec<f64> = found.iter().map(|(.., m)| if m.abs() > 5.0 * typical { 0.0 } else { *m }).collect();
    let rms = root_mean_square(kept.iter().copied());
    let tolerance = bound.tolerance(cloud.group, term).map(|tolerance| tolerance.size);
    let within = tolerance.or(term.within.map(|within| within / bound.system.size(&term.unit)));
    let rough = within.or_else(|| roughness(&points, &places, &tree)).unwrap_or(0.0).max(cloud.resolution);
    let said = format!(
        "the surface misses `{}` by {:.2e}{unit} (rms), while the cloud's own roughness is {:.2e}{unit}: check the pose, the \
         unit and the parameters; if they are right, the equations do not describe this body",
        term.name,
        rms * outward,
        rough * outward
    );
    checks.push(Check::new("distance", place, (rms / rough, MISFIT), said));
    if !cloud.signed {
        return checks;
    }
    let (correlation, z) = pattern(&places, &kept, &tree);
    let systematic = correlation.max(0.0).sqrt() * rms;
    // Far below the noise that is declared, it is what a fit that follows the cloud leaves.
    let least = tolerance.unwrap_or(cloud.resolution / 2.0);
    let matters = correlation > SLIGHT && systematic > least && within.is_none_or(|within| rms >= BELOW * within);
    let said = format!(
        "what is left of `{}` is no noise: neighbours correlate by {correlation:.2}, so the surface is off by some {:.2e}{unit} \
         over whole regions: wrong equations (large strains?), a wrong parameter or a wrong pose",
        term.name,
        systematic * outward
    );
    checks.push(Check::new("pattern", place, (if matters { z } else { z.min(PATTERN) }, PATTERN), said));
    checks
}

/// Correlation of neighbouring misfits, and the same in its standard deviation under noise.
fn pattern(places: &[[f64; 3]], misfits: &[f64], tree: &ImmutableKdTree<f64, 3>) -> (f64, f64) {
    let square = misfits.iter().map(|m| m * m).sum::<f64>() / misfits.len().max(1) as f64;
    let (mut sum, mut pairs) = (0.0, 0.0f64);
    for (i, place) in places.iter().enumerate() {
        for near in tree.query(place).nearest_n::<SquaredEuclidean<f64>>(NEIGHBOURS).execute() {
            let j = near.item as usize;
            if j != i {
                sum += misfits[i] * misfits[j];
                pairs += 1.0;
            }
        }
    }
    if square == 0.0 || pairs == 0.0 {
        return (0.0, 0.0);
    }
    let correlation = sum / pairs / square;
    // Most pairs are counted from both of their ends.
    (correlation, correlation * (pairs / 2.0).sqrt())
}

/// Standard deviation of a cloud about smooth pieces of surface: least squares of a quadratic through the neighbours of some
/// points, across the plane that they lie in.
fn roughness(points: &[[f64; 3]], places: &[[f64; 3]], tree: &ImmutableKdTree<f64, 3>) -> Option<f64> {
    const UNKNOWNS: usize = 6;
    if points.len() < 4 * AROUND.get() {
        return None;
    }
    let step = points.len().div_ceil(PLACES);
    let left = places.iter().step_by(step).filter_map(|centre| {
        let Piece { local, widths } = std::iter::successors(Some(AROUND), |around| around.checked_mul(WIDER))
            .map(|around| Piece::around(centre, around, points, tree))
            .find(|piece| {
                piece.widths[2] <= THICK * piece.widths[1] || WIDER.get() * piece.local.len() > points.len()
            })?;
        let reach = widths[0].max(f64::MIN_POSITIVE);
        let rows = local.iter().flat_map(|&[x, y, _]| {
            let (x, y) = (x / reach, y / reach);
            [1.0, x, y, x * x, x * y, y * y]
        });
        let design = DMatrix::from_row_iterator(local.len(), UNKNOWNS, rows);
        let heights = DVector::from_iterator(local.len(), local.iter().map(|p| p[2]));
        let fit = design.clone().svd(true, true).solve(&heights, 1e-10).ok()?;
        Some((heights - design * fit).norm_squared() / (local.len() - UNKNOWNS) as f64)
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
    fn around(centre: &[f64; 3], around: NonZero<usize>, points: &[[f64; 3]], tree: &ImmutableKdTree<f64, 3>) -> Self {
        let near = tree.query(centre).nearest_n::<SquaredEuclidean<f64>>(around).execute();
        let near: Vec<Vector3<f64>> = near.iter().map(|found| Vector3::from(points[found.item as usize])).collect();
        let middle = near.iter().sum::<Vector3<f64>>() / near.len() as f64;
        let spread: Matrix3<f64> = near.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
        let axes = spread.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| axes.eigenvalues[j].total_cmp(&axes.eigenvalues[i]));
        let along = |p: &Vector3<f64>| order.map(|i| (p - middle).dot(&axes.eigenvectors.column(i)));
        Self { local: near.iter().map(along).collect(), widths: order.map(|i| axes.eigenvalues[i].max(0.0).sqrt()) }
    }
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Points of a sphere of radius 1 about (0, 0, -1), noisy along z; their places; and the noise.
    fn cap(noise: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>, Vec<f64>) {
        let mut random = StdRng::seed_from_u64(5);
        let mut misfits = Vec::new();
        let mut places = Vec::new();
        let points = (0..3000).map(|_| {
            let (x, y): (f64, f64) = (random.random::<f64>() - 0.5, random.random::<f64>() - 0.5);
            let off = noise * normal(&mut random);
            misfits.push(off);
            places.push([x, y, 0.0]);
            [x, y, (1.0 - x * x - y * y).sqrt() - 1.0 + off]
        });
        (points.collect(), places, misfits)
    }

    #[test]
    fn roughness_is_the_noise_and_not_the_shape() {
        for noise in [0.0, 1e-2] {
            let (points, places, _) = cap(noise);
            let tree = ImmutableKdTree::new_from_slice(&places).unwrap();
            let found = roughness(&points, &places, &tree).unwrap();
            assert!((found - noise).abs() < 0.15 * noise + 1e-4, "{found} for {noise}");
        }
    }

    /// Twenty-four of three thousand points are no wider than noise of a tenth is thick.
    #[test]
    fn roughness_of_a_dense_cloud_is_its_noise_too() {
        let (points, places, _) = cap(0.1);
        let tree = ImmutableKdTree::new_from_slice(&places).unwrap();
        let found = roughness(&points, &places, &tree).unwrap();
        assert!((found / 0.1 - 1.0).abs() < 0.15, "{found}");
    }

    #[test]
    fn noise_has_no_pattern_and_a_tilt_has() {
        let (_, places, mut misfits) = cap(1e-2);
        let tree = ImmutableKdTree::new_from_slice(&places).unwrap();
        assert!(pattern(&places, &misfits, &tree).1.abs() < 4.0);
        places.iter().zip(&mut misfits).for_each(|(place, misfit)| *misfit += 1e-2 * place[0]);
        assert!(pattern(&places, &misfits, &tree).1 > PATTERN);
    }
}
