//! Products and factorisations of dense matrices, through faer.
//!
//! Every product is cut into tasks whose number and shape depend on the matrix alone, each computed by one thread, so
//! that the number of threads does not change a bit. Matrices of rows (Jacobians) are row-major; square matrices are
//! column-major with only their lower triangle in use.

mod cholesky;

pub(crate) use cholesky::Cholesky;
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd;
use faer::linalg::matmul::{self, triangular};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;

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

/// The lower triangle of `j^T j`, for `j` row-major of `rows x n`, into `out` of `n x n`, column-major.
///
/// Read row by row, `out` is the upper triangle, and `j` the right factor as it lies: the products of the engine's layers
/// do this a third faster than [`gram`] on the transpose.
pub(crate) fn gram_of_columns(j: &[f64], rows: usize, n: usize, out: &mut [f64]) {
    // Whole blocks of the products; high, for every task reads all of `j`, yet enough tasks to share out.
    let height = 14 * (n / (8 * 14)).clamp(1, 14);
    let isa = Isa::detect();
    // Rows end at whole vectors; what is left over lies at their start.
    let rest = n % isa.lanes::<f64>();
    out[..n * n].par_chunks_mut(n * height).enumerate().for_each(|(task, block)| {
        let first = task * height;
        let start = (first - (first - rest.min(first)) % isa.lanes::<f64>()).max(rest);
        if start < n {
            let shape = Shape { rows: block.len() / n, columns: n - start, inner: rows };
            let left = Left::transposed(&j[first..], n);
            let right = Right::Rows { elements: &j[start..], stride: n };
            gemm(isa, shape, left, right, &mut block[start..], n, Write::Set);
        }
        for (a, row) in (first..rest).zip(block.chunks_exact_mut(n)) {
            for (b, out) in row[..rest].iter_mut().enumerate() {
                *out = j.chunks_exact(n).map(|j| j[a] * j[b]).sum();
            }
        }
    });
}

/// `out = j v`, for `j` row-major with `v.len()` columns.
pub(crate) fn times(j: &[f64], v: &[f64], out: &mut [f64]) {
    let rows = j.par_chunks_exact(v.len()).with_min_len(WIDTH);
    out.par_iter_mut().zip(rows).for_each(|(out, row)| *out = super::vector::dot(row, v));
}

/// `out = j^T u`, for `j` row-major with `out.len()` columns.
pub(crate) fn transpose_times(j: &[f64], u: &[f64], out: &mut [f64]) {
    let n = out.len();
    out.par_chunks_mut(4 * WIDTH).enumerate().for_each(|(task, out)| {
        out.fill(0.0);
        for (u, row) in u.iter().zip(j.chunks_exact(n)) {
            super::vector::add_scaled(out, *u, &row[4 * WIDTH * task..][..out.len()]);
        }
    });
}

/// Adds to every `out` the squared norm of `b a`, for the rows `a` of one matrix and the matrix `b`, both row-major with `n`
/// columns.
pub(crate) fn add_squares_of_products(a: &[f64], b: &[f64], n: usize, out: &mut [f64]) {
    if b.is_empty() {
        return;
    }
    let b = row_major(b, b.len() / n.max(1), n);
    a.par_chunks(n * WIDTH).zip(out.par_chunks_mut(WIDTH)).for_each(|(a, out)| {
        let a = row_major(a, out.len(), n);
        let mut products = vec![0.0; out.len() * b.nrows()];
        let all = MatMut::from_row_major_slice_mut(&mut products, out.len(), b.nrows());
        matmul::matmul(all, Accum::Replace, a, b.transpose(), 1.0, Par::Seq);
        for (out, products) in out.iter_mut().zip(products.chunks_exact(b.nrows())) {
            *out += super::vector::dot(products, products);
        }
    });
}

/// `j -= q q^T j`, for `q` of `rows x k` and `j` of `rows x n`, both row-major.
pub(crate) fn subtract_projection(q: &[f64], k: usize, j: &mut [f64], n: usize) {
    let rows = j.len() / n.max(1);
    let q = row_major(q, rows, k);
    let mut within = vec![0.0; k * n];
    let product = MatMut::from_row_major_slice_mut(&mut within, k, n);
    matmul::matmul(product, Accum::Replace, q.transpose(), row_major(j, rows, n), 1.0, Par::Seq);
    let within = row_major(&within, k, n);
    j.par_chunks_mut(n * WIDTH).enumerate().for_each(|(task, j)| {
        let count = j.len() / n;
        let j = MatMut::from_row_major_slice_mut(j, count, n);
        matmul::matmul(j, Accum::Add, q.subrows(task * WIDTH, count), within, -1.0, Par::Seq);
    });
}

/// Copies the lower triangle of an `n x n` matrix.
pub(crate) fn copy_lower(from: &[f64], to: &mut [f64], n: usize) {
    to.par_chunks_exact_mut(n)
        .with_min_len(WIDTH)
        .zip(from.par_chunks_exact(n))
        .enumerate()
        .for_each(|(column, (to, from))| to[column..].copy_from_slice(&from[column..]));
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(super) fn wavy(rows: usize, n: usize) -> Vec<f64> {
        (0..rows * n).map(|i| (i as f64 * 0.731 + (i % 7) as f64).sin()).collect()
    }

    /// `j^T j`, by definition.
    pub(super) fn plain(j: &[f64], n: usize) -> Vec<f64> {
        let entry = |at: usize| j.chunks_exact(n).map(|j| j[at % n] * j[at / n]).sum();
        (0..n * n).map(entry).collect()
    }

    #[test]
    fn gram_matrices_of_any_size_are_those_of_their_definition() {
        for (rows, n) in [(3, 1), (4, 5), (40, 8), (7, 13), (300, 97), (120, 203)] {
            let j = wavy(rows, n);
            let expected = plain(&j, n);
            let (mut own, mut general) = (vec![0.0; n * n], vec![0.0; n * n]);
            gram_of_columns(&j, rows, n, &mut own);
            gram(row_major(&j, rows, n).transpose(), &mut general);
            for at in (0..n * n).filter(|at| at % n >= at / n) {
                assert!((own[at] - expected[at]).abs() <= 1e-14 * rows as f64, "{rows} {n} {at}");
                assert!((general[at] - expected[at]).abs() <= 1e-14 * rows as f64, "{rows} {n} {at}");
            }
        }
    }

    #[test]
    fn squares_of_products_are_those_of_their_definition_and_none_without_rows() {
        let n = 3;
        for rows in [0, 1, 4] {
            let (a, b) = (wavy(WIDTH + 2, n), wavy(rows, n));
            let mut out = vec![1.0; WIDTH + 2];
            add_squares_of_products(&a, &b, n, &mut out);
            for (a, out) in a.chunks_exact(n).zip(out) {
                let product = |b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let expected: f64 = 1.0 + b.chunks_exact(n).map(|b| product(b).powi(2)).sum::<f64>();
                assert!((out - expected).abs() < 1e-13 * expected, "{rows}: {out} {expected}");
            }
        }
        add_squares_of_products(&[], &[], 0, &mut []);
    }
}
