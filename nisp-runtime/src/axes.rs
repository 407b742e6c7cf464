//! The axes along which points spread.

use crate::solve::dense;

/// Axes along which some points spread, from the longest to the shortest.
pub(crate) struct Axes<const D: usize> {
    /// The mean of the points.
    pub(crate) middle: [f64; D],
    /// Unit vectors along the axes.
    pub(crate) directions: [[f64; D]; D],
    /// Sums over the points of squared distances from the middle along each axis.
    pub(crate) squares: [f64; D],
}

impl<const D: usize> Axes<D> {
    /// The axes of some points; nothing where these are not finite.
    pub(crate) fn of(points: &[[f64; D]]) -> Option<Self> {
        let count = points.len().max(1) as f64;
        let middle: [f64; D] = std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / count);
        let spread = |i: usize, j: usize| points.iter().map(|p| (p[i] - middle[i]) * (p[j] - middle[j])).sum();
        let matrix: Vec<f64> = (0..D * D).map(|at| spread(at / D, at % D)).collect();
        let (values, vectors) = dense::eigen(&matrix, D).filter(|_| matrix.iter().all(|x| x.is_finite()))?;
        Some(Self {
            middle,
            directions: std::array::from_fn(|k| std::array::from_fn(|i| vectors[k * D + i])),
            squares: std::array::from_fn(|k| values[k].max(0.0)),
        })
    }

    /// A point's place along the axes, from the middle.
    pub(crate) fn along(&self, point: &[f64; D]) -> [f64; D] {
        self.directions.map(|direction| (0..D).map(|i| (point[i] - self.middle[i]) * direction[i]).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a box of sides 2, 4 and 6, turned by 30 degrees about z and moved.
    #[test]
    fn axes_of_a_box_are_its_sides() {
        let (sine, cosine) = (0.5, 0.75f64.sqrt());
        let corner = |at: usize| {
            let side = |axis: usize| (axis + 1) as f64 * if at >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let (x, y, z) = (side(0), side(1), side(2));
            [10.0 + cosine * x - sine * y, sine * x + cosine * y, z]
        };
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let axes = Axes::of(&corners).unwrap();
        for (found, exact) in axes.squares.iter().zip([72.0, 32.0, 8.0]) {
            assert!((found - exact).abs() < 1e-12);
        }
        for (found, exact) in axes.directions.iter().zip([[0.0, 0.0, 1.0], [-sine, cosine, 0.0], [cosine, sine, 0.0]]) {
            let dot: f64 = found.iter().zip(exact).map(|(a, b)| a * b).sum();
            assert!((dot.abs() - 1.0).abs() < 1e-12);
        }
        let sizes = axes.along(&corners[7]).map(f64::abs);
        assert!(sizes.iter().zip([3.0, 2.0, 1.0]).all(|(found, exact)| (found - exact).abs() < 1e-12));
        assert!(Axes::of(&[[f64::NAN, 0.0]]).is_none());
    }
}
