//! What a wrench alone says of the pressure under a square face: the linear pressure, cut off at zero, that carries it.

use nalgebra::{Matrix3, Vector3};

/// Points of the quadrature along an edge.
const NODES: usize = 92;
/// Newton's steps; each is halved until it helps.
const STEPS: usize = 60;
const HALVINGS: usize = 40;
/// Share of the wrench up to which it must be carried; what is left of the minimum is its square, above rounding.
const ACCURACY: f64 = 1e-7;

/// A pressure `max(0, a + b x + c y)` on a square around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPressure {
    coefficients: Vector3<f64>,
    half: f64,
}

impl LinearPressure {
    /// The pressure that carries a force across a square face of side `side`, and its first moments `[int x p, int y p]`.
    /// Nothing if no pressure does: the force pulls, or it acts beside the face.
    pub fn carrying(side: f64, force: f64, moments: [f64; 2]) -> Option<Self> {
        let half = 0.5 * side;
        let wanted = Vector3::new(force, moments[0] / half, moments[1] / half) / (side * side);
        if wanted[0] <= 0.0 || wanted.iter().any(|x| !x.is_finite()) {
            return None;
        }
        // The coefficients minimise mean(max(0, pressure)^2) / 2 - wanted . coefficients, which is convex.
        let mut at = Vector3::new(wanted[0], 0.0, 0.0);
        for _ in 0..STEPS {
            let (value, gradient, curvature) = moments_of(&at, &wanted);
            if gradient.norm() <= ACCURACY * wanted[0] {
                return Some(Self { coefficients: at, half });
            }
            let step = curvature.cholesky()?.solve(&gradient);
            let tries = (0..HALVINGS).map(|k| at - step * 0.5f64.powi(k as i32));
            at = tries.into_iter().find(|next| moments_of(next, &wanted).0 < value)?;
        }
        None
    }

    /// The pressure at a place.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        self.coefficients.dot(&Vector3::new(1.0, x / self.half, y / self.half)).max(0.0)
    }
}

/// Value, gradient and curvature of what is minimised, over the square from -1 to 1.
fn moments_of(at: &Vector3<f64>, wanted: &Vector3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let (mut value, mut gradient, mut curvature) = (-at.dot(wanted), -wanted, Matrix3::zeros());
    let weight = 1.0 / (NODES * NODES) as f64;
    let place = |index: usize| (2 * index + 1) as f64 / NODES as f64 - 1.0;
    for index in 0..NODES * NODES {
        let row = Vector3::new(1.0, place(index % NODES), place(index / NODES));
        let pressure = at.dot(&row);
        if pressure > 0.0 {
            value += 0.5 * weight * pressure * pressure;
            gradient += weight * pressure * row;
            curvature += weight * row * row.transpose();
        }
    }
    (value, gradient, curvature)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a square of side 2: p = 3 + x - y / 2 has the force 12 and the moments 4/3 and -2/3.
    #[test]
    fn a_pressure_that_is_positive_everywhere_comes_back() {
        let found = LinearPressure::carrying(2.0, 12.0, [4.0 / 3.0, -2.0 / 3.0]).unwrap();
        // The midpoint rule has the second moment of a line to a part in NODES^2.
        assert!((found.at(0.5, 0.5) - 3.25).abs() < 1e-3, "{}", found.at(0.5, 0.5));
        assert!((found.at(0.0, 0.0) - 3.0).abs() < 1e-9);
    }

    /// p = max(0, x) on a square of side 2 has the force 1 and the moment 2/3.
    #[test]
    fn a_pressure_on_half_the_face_comes_back() {
        let found = LinearPressure::carrying(2.0, 1.0, [2.0 / 3.0, 0.0]).unwrap();
        assert!((found.at(0.75, 0.3) - 0.75).abs() < 2e-3, "{}", found.at(0.75, 0.3));
        assert!(found.at(-0.5, 0.0) == 0.0 && found.at(-0.1, 0.9) < 1e-3);
    }

    /// Contact of every width along an edge: the resultant runs from the middle towards the edge.
    #[test]
    fn every_resultant_within_the_face_is_carried() {
        for k in 0..95 {
            let place = 0.01 * f64::from(k);
            for moments in [[7.0 * place, 0.0], [-7.0 * place, 2.1 * place]] {
                let found = LinearPressure::carrying(2.0, 7.0, moments).unwrap();
                let cells =
                    (0..NODES * NODES).map(|i| [i % NODES, i / NODES].map(|k| (2 * k + 1) as f64 / NODES as f64 - 1.0));
                let area = 4.0 / (NODES * NODES) as f64;
                let sums = cells.fold([0.0; 3], |[f, x, y], at| {
                    let p = area * found.at(at[0], at[1]);
                    [f + p, x + p * at[0], y + p * at[1]]
                });
                let close = |a: f64, b: f64| (a - b).abs() < 1e-5;
                assert!(
                    close(sums[0], 7.0) && close(sums[1], moments[0]) && close(sums[2], moments[1]),
                    "{k}: {sums:?}"
                );
            }
        }
    }

    #[test]
    fn what_no_pressure_can_carry_has_no_answer() {
        assert_eq!(LinearPressure::carrying(2.0, -1.0, [0.0, 0.0]), None);
        assert_eq!(LinearPressure::carrying(2.0, 1.0, [1.2, 0.0]), None);
        assert_eq!(LinearPressure::carrying(2.0, f64::NAN, [0.0, 0.0]), None);
    }
}
