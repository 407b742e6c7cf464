//! Measures of a contact: which points are touched, how far two patches are apart.

use nisp::nearest::Nearest;

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
        (false, false) => Some(1e6 * (mean_square(a, b)? + mean_square(b, a)?)),
        _ => None,
    }
}

/// Mean squared distance from each point of `from` to its nearest of `to`.
fn mean_square(from: &[[f64; 3]], to: &[[f64; 3]]) -> Option<f64> {
    let tree = Nearest::of(to)?;
    Some(from.iter().map(|point| tree.one(point).distance.powi(2)).sum::<f64>() / from.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
