//! Measures of a contact: which points are touched, how far two patches are apart, the net force.

use nisp_data::DataError;
use nisp_data::export::triangulate;
use nisp_data::nearest::chamfer;

/// How a touched point is told from one that is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Pressure that a touched point exceeds, in pascals.
    pub least: f64,
    /// Multiple of the mean pressure that it exceeds too.
    pub of_mean: f64,
}

impl Rule {
    /// The pressure above which a point counts as touched, given the pressures at evenly spread points.
    pub fn threshold(&self, pressures: &[f64]) -> f64 {
        let mean = pressures.iter().sum::<f64>() / pressures.len().max(1) as f64;
        self.least.max(self.of_mean * mean)
    }

    /// Which of evenly spread points are touched.
    pub fn mask(&self, pressures: &[f64]) -> Vec<bool> {
        let threshold = self.threshold(pressures);
        pressures.iter().map(|pressure| *pressure > threshold).collect()
    }
}

/// Squared distance of two patches in square millimetres: mean squared distance to the other's nearest point, both
/// directions added. Zero if both are empty, nothing if one is. Points are in metres.
pub fn patch_chamfer_mm2(a: &[[f64; 3]], b: &[[f64; 3]]) -> Option<f64> {
    match (a.is_empty(), b.is_empty()) {
        (true, true) => Some(0.0),
        (false, false) => chamfer(a, b).ok().map(|squares| 1e6 * squares),
        _ => None,
    }
}

/// The integral of a density over an area, from its values at points and the area that each stands for.
pub fn integral(density: &[f64], areas: &[f64]) -> f64 {
    density.iter().zip(areas).map(|(density, area)| density * area).sum()
}

/// The area that each of plane points stands for: a third of every triangle between it and its neighbours, which
/// integrates whatever is linear between points.
///
/// # Errors
/// Points that are not finite.
pub fn areas(points: &[[f64; 2]]) -> Result<Vec<f64>, DataError> {
    let mut areas = vec![0.0; points.len()];
    for corners in triangulate(points, None)? {
        let [p, q, r] = corners.map(|corner| points[corner]);
        let double = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        corners.into_iter().for_each(|corner| areas[corner] += double.abs() / 6.0);
    }
    Ok(areas)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const PAPER: Rule = Rule { least: 2500.0, of_mean: 2.0 };

    /// A grid of `n` by `n` nodes on the unit square.
    fn grid(n: i32) -> Vec<[f64; 2]> {
        let step = 1.0 / f64::from(n - 1);
        (0..n * n).map(|i| [f64::from(i % n) * step, f64::from(i / n) * step]).collect()
    }

    #[test]
    fn the_rule_takes_the_larger_of_its_two_thresholds() {
        // A mean of 1000 Pa: 2500 Pa count; a mean of 5000 Pa: 10000 Pa count.
        assert_eq!(PAPER.mask(&[0.0, 0.0, 2501.0, 1499.0]), [false, false, true, false]);
        assert_eq!(PAPER.threshold(&[0.0, 20_000.0, 0.0, 0.0]), 10_000.0);
        assert_eq!(PAPER.mask(&[10_000.0, 10_001.0, 0.0, -1.0]), [false, true, false, false]);
        assert!(PAPER.mask(&[]).is_empty());
    }

    #[test]
    fn patches_a_millimetre_apart_are_two_square_millimetres_apart() {
        let patch = |z: f64| -> Vec<[f64; 3]> { grid(11).iter().map(|p| [0.1 * p[0], 0.1 * p[1], z]).collect() };
        let apart = patch_chamfer_mm2(&patch(0.0), &patch(1e-3)).unwrap();
        assert!((apart - 2.0).abs() < 1e-9, "{apart}");
        assert_eq!(patch_chamfer_mm2(&patch(0.0), &[]), None);
        assert_eq!(patch_chamfer_mm2(&[], &patch(0.0)), None);
        assert_eq!(patch_chamfer_mm2(&[], &[]), Some(0.0));
    }

    #[test]
    fn linear_pressures_integrate_exactly_and_a_dome_nearly() {
        let points = grid(7);
        let areas_of = areas(&points).unwrap();
        let linear: Vec<f64> = points.iter().map(|p| 3.0 + 2.0 * p[0] - p[1]).collect();
        assert!((integral(&linear, &areas_of) - 3.5).abs() < 1e-12);
        // The integral of sin(pi x) sin(pi y) is 4 / pi^2; the error is of second order.
        let error = |n: i32| {
            let points = grid(n);
            let dome: Vec<f64> = points.iter().map(|p| (PI * p[0]).sin() * (PI * p[1]).sin()).collect();
            (integral(&dome, &areas(&points).unwrap()) - 4.0 / (PI * PI)).abs()
        };
        assert!(error(41) < 1e-3 && (3.5..4.5).contains(&(error(21) / error(41))), "{} {}", error(21), error(41));
    }
}
