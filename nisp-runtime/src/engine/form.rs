//! Sums of squared distances from one point of a surface, with the square completed.

use crate::loss::Loss;

/// `x^T A x - 2 b^T x + c` for a point `x` of `D` coordinates, counted from an origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<const D: usize> {
    pub(super) a: [[f64; D]; D],
    pub(super) b: [f64; D],
    c: f64,
}

impl<const D: usize> Form<D> {
    pub(super) const ZERO: Self = Self { a: [[0.0; D]; D], b: [0.0; D], c: 0.0 };

    /// Adds a datum at `distance` from the origin, measured along `normal` if there is one; `size` is what distances are
    /// divided by before a robust loss judges them, at the origin.
    pub(super) fn add(
        &mut self,
        distance: &[f64; D],
        normal: Option<&[f64; D]>,
        weight: f64,
        (loss, size): (Loss, f64),
    ) {
        let across: Option<f64> = normal.map(|n| n.iter().zip(distance).map(|(n, r)| n * r).sum());
        let square = across.map_or_else(|| distance.iter().map(|r| r * r).sum(), |across| across * across);
        let (slope, rest) = loss.majorant(square.sqrt() / size);
        let weight_at = weight * slope;
        for i in 0..D {
            match (normal, across) {
                (Some(normal), Some(across)) => {
                    (0..D).for_each(|k| self.a[i][k] += weight_at * normal[i] * normal[k]);
                    self.b[i] += weight_at * normal[i] * across;
                }
                _ => {
                    self.a[i][i] += weight_at;
                    self.b[i] += weight_at * distance[i];
                }
            }
        }
        self.c += weight_at * square + weight * rest * size * size;
    }

    /// Replaces `a` by `R` and `b` by `t`, with `a = R^T R` and `b = R^T t`; returns what is left of `c`. Directions
    /// that nothing determines have rows of zeros.
    pub(super) fn complete_square(&mut self) -> f64 {
        let largest = (0..D).map(|i| self.a[i][i]).fold(0.0, f64::max);
        for i in 0..D {
            let pivot = self.a[i][i];
            let root = if pivot > 1e-12 * largest { pivot.sqrt() } else { 0.0 };
            let over = |x: f64| if root > 0.0 { x / root } else { 0.0 };
            self.b[i] = over(self.b[i]);
            self.c -= self.b[i] * self.b[i];
            for k in 0..D {
                self.a[i][k] = if k < i { 0.0 } else { over(self.a[i][k]) };
            }
            for j in i + 1..D {
                let factor = self.a[i][j];
                self.b[j] -= factor * self.b[i];
                (j..D).for_each(|k| self.a[j][k] -= factor * self.a[i][k]);
            }
        }
        self.c.max(0.0)
    }
}
