//! The membrane's pressure without solving for it: heights of the cloud smoothed by local parabolas, and the membrane's
//! operator with the tensions of its inflated state. Neither the displacement in the plane nor the tool's effect on the
//! tensions enters.

use nalgebra::{SMatrix, SVector};

/// Radii of a fit, in parts of the longer semi-axis; cross-validation chooses.
const RADII: [f64; 6] = [0.04, 0.06, 0.09, 0.14, 0.2, 0.3];
/// Points that a parabola of six coefficients needs to be more than a guess.
const LEAST: usize = 12;

/// An elliptical membrane's tensions along its axes in N/m, by Ritz with `w = w0 (1 - x^2/a^2 - y^2/b^2)` and mean
/// strains, from Young's modulus, Poisson's ratio, thickness, semi-axes and pressure in SI units.
pub fn inflated_tensions(young: f64, nu: f64, thickness: f64, [a, b]: [f64; 2], pressure: f64) -> [f64; 2] {
    let stiffness = young * thickness / (1.0 - nu * nu);
    let (x, y) = (1.0 / (a * a), 1.0 / (b * b));
    // Mean strains are w0^2 x / 2 and w0^2 y / 2; the balance 2 w0 (N_a x + N_b y) = p is a cubic in w0.
    let per_square = [0.5 * stiffness * (x + nu * y), 0.5 * stiffness * (y + nu * x)];
    let height = (pressure / (2.0 * (per_square[0] * x + per_square[1] * y))).cbrt();
    per_square.map(|tension| tension * height * height)
}

/// A cloud's heights as a smooth surface.
pub struct CloudFit {
    points: Vec<[f64; 3]>,
    radius: f64,
}

impl CloudFit {
    /// Chooses the radius of the fits by leaving one point out at a time.
    pub fn new(points: Vec<[f64; 3]>, size: f64) -> Self {
        let mut fit = Self { points, radius: size };
        let scored = RADII.map(|radius| {
            fit.radius = radius * size;
            (fit.cross_validation(), fit.radius)
        });
        let best = scored.into_iter().filter(|(score, _)| score.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0));
        fit.radius = best.map_or(size, |(_, radius)| radius);
        fit
    }

    /// The second derivatives of the height along both axes.
    pub fn curvatures(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let mut radius = self.radius;
        // Holes and edges take a wider look.
        for _ in 0..6 {
            if let Some((coefficients, _)) = self.parabola(x, y, radius) {
                let scale = 2.0 / (radius * radius);
                return Some([scale * coefficients[3], scale * coefficients[5]]);
            }
            radius *= 1.5;
        }
        None
    }

    /// Mean squared error at points that the fit has not seen.
    fn cross_validation(&self) -> f64 {
        let squares = self.points.iter().filter_map(|&[x, y, z]| {
            let (coefficients, influence) = self.parabola(x, y, self.radius)?;
            Some(((z - coefficients[0]) / (1.0 - influence)).powi(2))
        });
        let squares: Vec<f64> = squares.collect();
        // A radius that most points cannot use says nothing.
        if 2 * squares.len() < self.points.len() {
            return f64::NAN;
        }
        squares.iter().sum::<f64>() / squares.len() as f64
    }

    /// Coefficients of `1, x, y, x^2, x y, y^2` around a place, lengths in radii, and how much a point there would count.
    fn parabola(&self, x: f64, y: f64, radius: f64) -> Option<(SVector<f64, 6>, f64)> {
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        let mut count = 0;
        for point in &self.points {
            let (dx, dy) = ((point[0] - x) / radius, (point[1] - y) / radius);
            let near = 1.0 - dx * dx - dy * dy;
            if near <= 0.0 {
                continue;
            }
            let weight = near * near;
            let row = SVector::from([1.0, dx, dy, dx * dx, dx * dy, dy * dy]);
            normal += weight * row * row.transpose();
            right += weight * point[2] * row;
            count += 1;
        }
        let factor = normal.cholesky().filter(|_| count >= LEAST)?;
        let first = SVector::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        Some((factor.solve(&right), factor.solve(&first)[0]))
    }
}

/// Contact pressures at plane points: what the pressure from below leaves over of the tensions' pull, where positive.
pub fn pressure_by_operator(fit: &CloudFit, tensions: [f64; 2], pressure: f64, points: &[[f64; 2]]) -> Vec<f64> {
    let at = |&[x, y]: &[f64; 2]| {
        let curvatures = fit.curvatures(x, y).unwrap_or_default();
        (pressure + tensions[0] * curvatures[0] + tensions[1] * curvatures[1]).max(0.0)
    };
    points.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points spread evenly over a square.
    fn plane(count: usize) -> impl Iterator<Item = [f64; 2]> {
        (0..count).map(|i| [0.618_034 * i as f64, 0.754_878 * i as f64].map(|x| x.fract() - 0.5))
    }

    #[test]
    fn parabolas_give_their_curvature_back() {
        let height = |[x, y]: [f64; 2]| 0.3 - 0.2 * x + 0.5 * x * x + 0.7 * x * y - 1.5 * y * y;
        let fit = CloudFit::new(plane(900).map(|p| [p[0], p[1], height(p)]).collect(), 1.0);
        let [x, y] = fit.curvatures(0.1, -0.2).unwrap();
        assert!((x - 1.0).abs() < 1e-9 && (y + 3.0).abs() < 1e-9, "{x} {y}");
        assert!(fit.curvatures(100.0, 0.0).is_none());
    }

    /// A parabola under constant tensions carries a uniform pressure; half of it is pressed by as much again.
    #[test]
    fn the_operator_gives_the_pressure_that_bends_the_surface() {
        let tensions = [50.0, 80.0];
        let height = |[x, y]: [f64; 2]| -(7.0 * x * x + 5.0 * y * y);
        let fit = CloudFit::new(plane(900).map(|p| [p[0], p[1], height(p)]).collect(), 1.0);
        let carried = 2.0 * (50.0 * 7.0 + 80.0 * 5.0);
        let found = pressure_by_operator(&fit, tensions, carried + 20.0, &[[0.0, 0.0], [0.2, 0.1]]);
        assert!(found.iter().all(|f| (f - 20.0).abs() < 1e-6), "{found:?}");
        assert_eq!(pressure_by_operator(&fit, tensions, 100.0, &[[0.0, 0.0]]), [0.0]);
    }

    /// The balance that the tensions are made from, with the height eliminated by hand: a circle, nu = 0.
    #[test]
    fn a_circular_membrane_has_equal_tensions() {
        let [x, y] = inflated_tensions(3e5, 0.0, 4e-4, [0.05, 0.05], 5e3);
        assert_eq!(x, y);
        // N = E t w0^2 / (2 r^2) and 4 N w0 / r^2 = p give N^3 = p^2 r^2 E t / 32.
        let expected = (25e6 * 0.0025 * 120.0 / 32.0_f64).cbrt();
        assert!((x / expected - 1.0).abs() < 1e-12, "{x} {expected}");
    }
}
