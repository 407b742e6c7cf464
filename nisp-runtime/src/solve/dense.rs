//! Products and factorisations of dense matrices, through faer.
//!
//! Every product is cut into tasks whose number and shape depend on the matrix alone, each computed by one thread, so
//! that the number of threads does not change a bit. Matrices of rows (Jacobians) are row-major; square matrices are
//! column-major with only their lower triangle in use.

use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor;
use faer::linalg::evd;
use faer::linalg::matmul::{self, triangular};
use faer::linalg::triangular_solve;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a task: wide enough for the kernel, narrow enough to balance two threads at 400 columns.
const WIDTH: usize = 96;

/// Views `rows x cols` elements, row-major.
pub(crate) fn row_major(data: &[f64], rows: usize, cols: usize) -> MatRef<'_, f64> {
    MatRef::from_row_major_slice(&data[..rows * cols], rows, cols)
}

/// The lower triangle of `a a^T`, for `a` of `n x k`, into `out` of `n x n`.
pub(crate) fn gram(a: MatRef<'_, f64>, out: &mut [f64]) {
    let n = a.nrows();
    out[..n * n].par_chunks_mut(n * WIDTH).enumerate().for_each(|(task, columns)| {
        let (first, width) = (task * WIDTH, columns.len() / n);
        let block = MatMut::from_column_major_slice_mut(columns, n, width);
        let (diagonal, below) = block.split_at_row_mut(first).1.split_at_row_mut(width);
        let mine = a.subrows(first, width);
        triangular::matmul(
            diagonal,
            triangular::BlockStructure::TriangularLower,
            Accum::Replace,
            mine,
            triangular::BlockStructure::Rectangular,
            mine.transpose(),
            triangular::BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        let others = a.subrows(first + width, n - first - width);
        matmul::matmul(below, Accum::Replace, others, mine.transpose(), 1.0, Par::Seq);
    });
}

/// `out = j v`, for `j` row-major with `v.len()` columns.
pub(crate) fn times(j: &[f64], v: &[f64], out: &mut [f64]) {
    for (out, row) in out.iter_mut().zip(j.chunks_exact(v.len())) {
        *out = super::vector::dot(row, v);
    }
}

/// `out = j^T u`, for `j` row-major with `out.len()` columns.
pub(crate) fn transpose_times(j: &[f64], u: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (u, row) in u.iter().zip(j.chunks_exact(out.len())) {
        super::vector::add_scaled(out, *u, row);
    }
}

/// Cholesky factors of positive definite matrices of one size, with the memory that they need.
pub(crate) struct Cholesky {
    n: usize,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl Cholesky {
    pub(crate) fn new(n: usize) -> Self {
        let scratch = factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        Self { n, factor: vec![0.0; n * n], scratch: MemBuffer::new(scratch) }
    }

    /// Factorises the matrix that `fill` writes into the lower triangle of its argument; false where the matrix is
    /// not positive definite in this precision.
    pub(crate) fn factorise(&mut self, fill: impl FnOnce(&mut [f64])) -> bool {
        fill(&mut self.factor);
        let matrix = MatMut::from_column_major_slice_mut(&mut self.factor, self.n, self.n);
        let stack = MemStack::new(&mut self.scratch);
        let done = factor::cholesky_in_place(matrix, Default::default(), Par::Seq, stack, Default::default());
        done.is_ok() && (0..self.n).all(|i| self.factor[i * (self.n + 1)].is_finite())
    }

    fn lower(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.factor, self.n, self.n)
    }

    /// Solves `L L^T x = b` in place, for one right-hand side.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b, 1);
        let x = MatMut::from_column_major_slice_mut(b, self.n, 1);
        triangular_solve::solve_upper_triangular_in_place(self.lower().transpose(), x, Par::Seq);
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
        inverse.chunks_exact(n).map(|column| super::vector::dot(column, column)).collect()
    }
}

/// Eigenvalues in descending order, and eigenvectors one after the other in memory, of the symmetric `n x n` matrix
/// whose lower triangle is given; `None` where the iteration fails.
pub(crate) fn eigen(matrix: &[f64], n: usize) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut values = vec![0.0; n];
    let mut vectors = vec![0.0; n * n];
    let params = Default::default();
    let scratch = evd::self_adjoint_evd_scratch::<f64>(n, evd::ComputeEigenvectors::Yes, Par::Seq, params);
    evd::self_adjoint_evd(
        MatRef::from_column_major_slice(&matrix[..n * n], n, n),
        DiagMut::from_slice_mut(&mut values),
        Some(MatMut::from_column_major_slice_mut(&mut vectors, n, n)),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        params,
    )
    .ok()?;
    values.reverse();
    let vectors = vectors.chunks_exact(n).rev().flatten().copied().collect();
    Some((values, vectors))
}
