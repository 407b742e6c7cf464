//! Symmetric positive definite matrices that are zero far from the diagonal: what least squares with splines gives.

use super::RivalError;

/// Relative size of a diagonal term added before factorising, against directions that no row touches.
const RIDGE: f64 = 1e-14;

/// The lower half, row by row: `rows[i * (width + 1) + (i - j)]`.
#[derive(Clone)]
pub(super) struct Band {
    size: usize,
    width: usize,
    rows: Vec<f64>,
}

impl Band {
    pub(super) fn zero(size: usize, width: usize) -> Band {
        Band { size, width, rows: vec![0.0; size * (width + 1)] }
    }

    /// Adds the outer product of a sparse row, given as places and values.
    pub(super) fn add_row(&mut self, row: &[(usize, f64)]) {
        for &(i, a) in row {
            for &(j, b) in row.iter().filter(|(j, _)| *j <= i) {
                self.rows[i * (self.width + 1) + (i - j)] += a * b;
            }
        }
    }

    /// Adds `factor` times another matrix of the same shape.
    pub(super) fn add(&mut self, factor: f64, other: &Band) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(a, b)| *a += factor * b);
    }

    /// The product with a vector.
    pub(super) fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.size];
        for i in 0..self.size {
            for j in i.saturating_sub(self.width)..=i {
                let value = self.rows[i * (self.width + 1) + (i - j)];
                out[i] += value * x[j];
                if i != j {
                    out[j] += value * x[i];
                }
            }
        }
        out
    }

    /// Cholesky factor in place.
    pub(super) fn factor(mut self) -> Result<Factor, RivalError> {
        let stride = self.width + 1;
        for i in 0..self.size {
            let first = i.saturating_sub(self.width);
            for j in first..=i {
                let from = first.max(j.saturating_sub(self.width));
                let mut value = self.rows[i * stride + (i - j)];
                for k in from..j {
                    value -= self.rows[i * stride + (i - k)] * self.rows[j * stride + (j - k)];
                }
                self.rows[i * stride + (i - j)] = if i == j {
                    value += RIDGE * self.rows[i * stride];
                    if !(value.is_finite() && value > 0.0) {
                        return Err(RivalError::Singular);
                    }
                    value.sqrt()
                } else {
                    value / self.rows[j * stride]
                };
            }
        }
        Ok(Factor { band: self })
    }
}

/// The Cholesky factor of a [`Band`].
pub(super) struct Factor {
    band: Band,
}

impl Factor {
    /// Solves in place.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let Band { size, width, ref rows } = self.band;
        let at = |i: usize, j: usize| rows[i * (width + 1) + (i - j)];
        for i in 0..size {
            let sum: f64 = (i.saturating_sub(width)..i).map(|j| at(i, j) * x[j]).sum();
            x[i] = (x[i] - sum) / at(i, i);
        }
        for i in (0..size).rev() {
            let sum: f64 = (i + 1..(i + width + 1).min(size)).map(|j| at(j, i) * x[j]).sum();
            x[i] = (x[i] - sum) / at(i, i);
        }
    }

    /// Logarithm of the determinant of the matrix.
    pub(super) fn log_det(&self) -> f64 {
        let stride = self.band.width + 1;
        2.0 * (0..self.band.size).map(|i| self.band.rows[i * stride].ln()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second differences on the identity: a matrix whose solution and determinant are easy to check.
    #[test]
    fn solves_and_measures() {
        let mut band = Band::zero(6, 2);
        (0..6).for_each(|i| band.add_row(&[(i, 1.0)]));
        let mut product = Band::zero(6, 2);
        (1..5).for_each(|i| product.add_row(&[(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)]));
        band.add(3.0, &product);
        let x = [1.0, -2.0, 0.5, 3.0, 0.0, 4.0];
        let second = |v: &[f64; 6], i: usize| v[i - 1] - 2.0 * v[i] + v[i + 1];
        let mut right = x;
        for i in 1..5 {
            let bend = 3.0 * second(&x, i);
            right[i - 1] += bend;
            right[i] -= 2.0 * bend;
            right[i + 1] += bend;
        }
        let factor = band.factor().unwrap();
        factor.solve(&mut right);
        assert!(right.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-12));
        let mut diagonal = Band::zero(2, 0);
        diagonal.add_row(&[(0, 2.0)]);
        diagonal.add_row(&[(1, 3.0)]);
        assert!((diagonal.factor().unwrap().log_det() - 36f64.ln()).abs() < 1e-12);
        assert!(Band::zero(2, 1).factor().is_err());
    }
}
