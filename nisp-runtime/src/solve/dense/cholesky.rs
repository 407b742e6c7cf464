//! Cholesky factors.

use rayon::prelude::*;

use super::WIDTH;
use super::rows::{ALIGN, Strip};
use crate::aligned::AlignedVec;
use crate::simd::Isa;
use crate::solve::vector;

/// Cholesky factors of positive definite matrices of one size.
pub(crate) struct Cholesky {
    n: usize,
    isa: Isa,
    /// `A = L L^T`: the rows of `L^T`.
    factor: AlignedVec<f64>,
}

impl Cholesky {
    pub(crate) fn new(n: usize) -> Self {
        Self { n, isa: Isa::detect(), factor: AlignedVec::zeros(Strip::new(n, 0).len()) }
    }

    /// Factorises the matrix that `fill` writes into the lower triangle of its argument, column by column; false where the
    /// matrix is not positive definite in this precision.
    pub(crate) fn factorise(&mut self, fill: impl FnOnce(&mut [f64])) -> bool {
        let (n, strip) = (self.n, self.strip());
        fill(&mut self.factor[..n * n]);
        for row in (0..n).rev() {
            self.factor.copy_within(row * n..(row + 1) * n, row * strip.stride);
            self.factor[row * strip.stride + n..(row + 1) * strip.stride].fill(0.0);
        }
        strip.eliminate(self.isa, &mut self.factor, &mut []) && (0..n).all(|i| self.diagonal(i).is_finite())
    }

    fn strip(&self) -> Strip {
        Strip::new(self.n, 0)
    }

    fn diagonal(&self, at: usize) -> f64 {
        self.factor[at * (self.strip().stride + 1)]
    }

    /// Solves `L L^T x = b` in place, for one right-hand side.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b, 1);
        self.solve_upper(b, 1);
    }

    /// Solves `L x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_lower(&self, b: &mut [f64], count: usize) {
        self.solve_all(b, count, |x, sides| self.strip().solve_transposed(self.isa, &self.factor, x, (sides, sides)));
    }

    /// Solves `L^T x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_upper(&self, b: &mut [f64], count: usize) {
        self.solve_all(b, count, |x, sides| self.strip().solve(self.isa, &self.factor, x, sides));
    }

    /// Solves for right-hand sides, some of them at a time, side by side.
    fn solve_all(&self, b: &mut [f64], count: usize, solve: impl Fn(&mut [f64], usize) + Sync) {
        let n = self.n;
        b[..n * count].par_chunks_mut((n * WIDTH).max(1)).for_each(|b| {
            let sides = (b.len() / n).next_multiple_of(ALIGN);
            let mut x = vec![0.0; n * sides];
            for (side, b) in b.chunks_exact(n).enumerate() {
                b.iter().enumerate().for_each(|(at, b)| x[at * sides + side] = *b);
            }
            solve(&mut x, sides);
            for (side, b) in b.chunks_exact_mut(n).enumerate() {
                b.iter_mut().enumerate().for_each(|(at, b)| *b = x[at * sides + side]);
            }
        });
    }

    /// `L^T`, row by row.
    pub(crate) fn upper(&self) -> Vec<f64> {
        let (n, stride) = (self.n, self.strip().stride);
        let entry = |row: usize, column: usize| if column < row { 0.0 } else { self.factor[row * stride + column] };
        (0..n).flat_map(|row| (0..n).map(move |column| entry(row, column))).collect()
    }

    /// Logarithm of the determinant of `L L^T`.
    pub(crate) fn log_determinant(&self) -> f64 {
        2.0 * (0..self.n).map(|i| self.diagonal(i).ln()).sum::<f64>()
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

    #[test]
    fn solutions_solve_and_determinants_are_products() {
        for n in [1, 50, 193, 500] {
            let mut matrix = plain(&wavy(n + 20, n), n);
            matrix.iter_mut().step_by(n + 1).for_each(|d| *d += 1.0);
            let mut cholesky = Cholesky::new(n);
            // Leftovers of another matrix do not matter.
            cholesky.factor.fill(f64::NAN);
            assert!(cholesky.factorise(|factor| factor.copy_from_slice(&matrix)));
            let expected = wavy(1, n);
            let mut x: Vec<f64> = matrix.chunks_exact(n).map(|row| vector::dot(row, &expected)).collect();
            cholesky.solve(&mut x);
            assert!(x.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-9), "{n}");
            let other = nalgebra::DMatrix::from_row_slice(n, n, &matrix).cholesky().unwrap();
            let logarithm: f64 = (0..n).map(|i| 2.0 * other.l_dirty()[(i, i)].ln()).sum();
            assert!((cholesky.log_determinant() - logarithm).abs() < 1e-9 * n as f64, "{n}");
            let inverse = other.inverse();
            let found = cholesky.inverse_diagonal();
            assert!((0..n).all(|i| (found[i] / inverse[(i, i)] - 1.0).abs() < 1e-9), "{n}");
            matrix[n * n - 1] = -1.0;
            assert!(!cholesky.factorise(|factor| factor.copy_from_slice(&matrix)));
        }
    }
}
