//! Cholesky factors.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor;
use faer::linalg::matmul::{self, triangular};
use faer::linalg::triangular_solve;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use super::WIDTH;
use crate::solve::vector;

/// Columns that are factorised before the rest of the matrix is updated.
const PANEL: usize = 2 * WIDTH;

/// Cholesky factors of positive definite matrices of one size, with the memory that they need.
pub(crate) struct Cholesky {
    n: usize,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl Cholesky {
    pub(crate) fn new(n: usize) -> Self {
        let scratch = factor::cholesky_in_place_scratch::<f64>(n.min(PANEL), Par::Seq, Default::default());
        Self { n, factor: vec![0.0; n * n], scratch: MemBuffer::new(scratch) }
    }

    /// Factorises the matrix that `fill` writes into the lower triangle of its argument; false where the matrix is
    /// not positive definite in this precision.
    pub(crate) fn factorise(&mut self, fill: impl FnOnce(&mut [f64])) -> bool {
        fill(&mut self.factor);
        let n = self.n;
        let mut done = true;
        for first in (0..n).step_by(PANEL) {
            let width = PANEL.min(n - first);
            let (panel, rest) = self.factor[first * n..].split_at_mut(width * n);
            let panel = MatMut::from_column_major_slice_mut(panel, n, width);
            let (mut diagonal, mut below) = panel.split_at_row_mut(first).1.split_at_row_mut(width);
            let stack = MemStack::new(&mut self.scratch);
            done &=
                factor::cholesky_in_place(diagonal.rb_mut(), Default::default(), Par::Seq, stack, Default::default())
                    .is_ok();
            strips(below.rb_mut()).into_par_iter().for_each(|strip| {
                // strip L^T = what stands there
                triangular_solve::solve_lower_triangular_in_place(diagonal.rb(), strip.transpose_mut(), Par::Seq);
            });
            update(below.rb(), rest, n, first + width);
        }
        done && (0..n).all(|i| self.factor[i * (n + 1)].is_finite())
    }

    fn lower(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.factor, self.n, self.n)
    }

    /// Solves `L L^T x = b` in place, for one right-hand side.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b, 1);
        self.solve_upper(b, 1);
    }

    /// Solves `L x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_lower(&self, b: &mut [f64], count: usize) {
        let n = self.n;
        b[..n * count].par_chunks_mut(n * WIDTH).for_each(|columns| {
            let width = columns.len() / n;
            let x = MatMut::from_column_major_slice_mut(columns, n, width);
            triangular_solve::solve_lower_triangular_in_place(self.lower(), x, Par::Seq);
        });
    }

    /// Solves `L^T x = b` in place for `count` right-hand sides, one after the other in memory.
    pub(crate) fn solve_upper(&self, b: &mut [f64], count: usize) {
        let n = self.n;
        b[..n * count].par_chunks_mut(n * WIDTH).for_each(|columns| {
            let width = columns.len() / n;
            let x = MatMut::from_column_major_slice_mut(columns, n, width);
            triangular_solve::solve_upper_triangular_in_place(self.lower().transpose(), x, Par::Seq);
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

/// Cuts a matrix into strips of [`WIDTH`] rows.
fn strips(matrix: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut strips = Vec::with_capacity(matrix.nrows().div_ceil(WIDTH));
    let mut rest = matrix;
    while rest.nrows() > 0 {
        let height = WIDTH.min(rest.nrows());
        let (strip, below) = rest.split_at_row_mut(height);
        strips.push(strip);
        rest = below;
    }
    strips
}

/// Subtracts the lower triangle of `l l^T` from columns `first` on, which are `columns`, `n` apart.
fn update(l: MatRef<'_, f64>, columns: &mut [f64], n: usize, first: usize) {
    columns.par_chunks_mut(n * WIDTH).enumerate().for_each(|(task, columns)| {
        let (at, width) = (task * WIDTH, columns.len() / n);
        let block = MatMut::from_column_major_slice_mut(columns, n, width);
        let (diagonal, below) = block.split_at_row_mut(first + at).1.split_at_row_mut(width);
        let (mine, others) = l.split_at_row(at).1.split_at_row(width);
        triangular::matmul(
            diagonal,
            triangular::BlockStructure::TriangularLower,
            Accum::Add,
            mine,
            triangular::BlockStructure::Rectangular,
            mine.transpose(),
            triangular::BlockStructure::Rectangular,
            -1.0,
            Par::Seq,
        );
        matmul::matmul(below, Accum::Add, others, mine.transpose(), -1.0, Par::Seq);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::dense::tests::{plain, wavy};

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
