//! Cholesky factors.

use rayon::prelude::*;

use super::WIDTH;
use super::substitution::{solve_backward, solve_forward};
use super::triangle::factorise;
use crate::solve::vector;

/// Cholesky factors of positive definite matrices of one size, with the memory that they need.
pub(crate) struct Cholesky {
    n: usize,
    /// Lower, column after column.
    factor: Vec<f64>,
}

impl Cholesky {
    pub(crate) fn new(n: usize) -> Self {
        Self { n, factor: vec![0.0; n * n] }
    }

    /// Factorises the matrix that `fill` writes into the lower triangle of its argument; false where the matrix is
    /// not positive definite in this precision.
    pub(crate) fn factorise(&mut self, fill: impl FnOnce(&mut [f64])) -> bool {
        fill(&mut self.factor);
        let n = self.n;
        factorise(&mut self.factor, n, n) && (0..n).all(|i| self.factor[i * (n + 1)].is_finite())
    }

    /// Solves `L L^T x = b` in place, for one right-hand side.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b, 1);
        self.solve_upper(b, 1);
    }

    /// Solves `L x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_lower(&self, b: &mut [f64], count: usize) {
        if count == 1 {
            for i in 0..self.n {
                let row = &self.factor[i * self.n + i..][..self.n - i];
                let x = b[i] / row[0];
                b[i] = x;
                vector::add_scaled(&mut b[i + 1..self.n], -x, &row[1..]);
            }
        } else {
            self.by_strips(b, count, solve_forward);
        }
    }

    /// Solves `L^T x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_upper(&self, b: &mut [f64], count: usize) {
        if count == 1 {
            for i in (0..self.n).rev() {
                let row = &self.factor[i * self.n + i..][..self.n - i];
                b[i] = (b[i] - vector::dot(&row[1..], &b[i + 1..self.n])) / row[0];
            }
        } else {
            self.by_strips(b, count, solve_backward);
        }
    }

    /// Turns right-hand sides into columns, solves for them and turns them back.
    fn by_strips(
        &self,
        b: &mut [f64],
        count: usize,
        solve: impl Fn(&[f64], usize, std::ops::Range<usize>, &mut [f64], usize) + Sync,
    ) {
        let n = self.n;
        b[..n * count].par_chunks_mut((n * WIDTH).max(1)).for_each(|sides| {
            let width = (sides.len() / n).next_multiple_of(8);
            let mut strip = vec![0.0; n * width];
            for (at, side) in sides.chunks_exact(n).enumerate() {
                strip.iter_mut().skip(at).step_by(width).zip(side).for_each(|(x, b)| *x = *b);
            }
            solve(&self.factor, n, 0..n, &mut strip, width);
            for (at, side) in sides.chunks_exact_mut(n).enumerate() {
                side.iter_mut().zip(strip.iter().skip(at).step_by(width)).for_each(|(b, x)| *b = *x);
            }
        });
    }

    /// Logarithm of the determinant of `L L^T`.
    pub(crate) fn log_determinant(&self) -> f64 {
        2.0 * (0..self.n).map(|i| self.factor[i * (self.n + 1)].ln()).sum::<f64>()
    }

    /// Diagonal of the inverse of `L L^T`.
    pub(crate) fn inverse_diagonal(&self) -> Vec<f64> {
        let n = self.n;
        let mut inverse = vec![0.0; n * n];
        (0..n).for_each(|i| inverse[i * (n + 1)] = 1.0);
        self.solve_lower(&mut inverse, n);
        // (L L^T)^-1 = L^-T L^-1: its diagonal holds the squared norms of the columns of L^-1.
        inverse.chunks_exact(n).map(|column| vector::dot(column, column)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::dense::tests::{plain, wavy};
    use crate::solve::dense::triangle::PANEL;

    #[test]
    fn factors_of_any_size_multiply_to_the_matrix() {
        for n in [1, 50, PANEL, PANEL + 1, 500] {
            let mut matrix = plain(&wavy(n + 20, n), n);
            matrix.iter_mut().step_by(n + 1).for_each(|d| *d += 1.0);
            let mut cholesky = Cholesky::new(n);
            assert!(cholesky.factorise(|factor| factor.copy_from_slice(&matrix)));
            let l = |i: usize, k: usize| cholesky.factor[i + k * n];
            for i in 0..n {
                for k in 0..=i {
                    let product: f64 = (0..=k).map(|m| l(i, m) * l(k, m)).sum();
                    assert!((product - matrix[i + k * n]).abs() <= 1e-12 * n as f64, "{n}: {i} {k}");
                }
            }
            matrix[n * n - 1] = -1.0;
            assert!(!cholesky.factorise(|factor| factor.copy_from_slice(&matrix)));
        }
    }
}
