//! Products and factorisations of dense matrices, through the products of the engine's layers.
//!
//! Every product is cut into tasks whose number and shape depend on the matrix alone, each computed by one thread, so
//! that the number of threads does not change a bit. Matrices of rows (Jacobians) are row-major; square matrices are
//! column-major with only their lower triangle in use.

mod cholesky;
mod orthogonal;
mod substitution;
mod triangle;

pub(crate) use cholesky::Cholesky;
use nalgebra::{DMatrix, SymmetricEigen};
pub(crate) use orthogonal::triangle_of;
use rayon::prelude::*;
pub(crate) use substitution::{solve_backward, solve_forward};
pub(crate) use triangle::{factorise, subtract_gram};

use crate::gemm::{Left, Packed, Right, Shape, Write, gemm};
use crate::simd::Isa;

/// Columns of a task: wide enough for the kernel, narrow enough to balance two threads at 400 columns.
const WIDTH: usize = 96;

/// Columns of a right factor that are turned at once: more than a run of the products, and little beside the whole.
const TURNED: usize = 1024;

/// The lower triangle of `a a^T`, for `a` row-major of `rows x n`, into `out` of `rows x rows`, column-major.
pub(crate) fn gram_of_rows(a: &[f64], rows: usize, n: usize, out: &mut [f64]) {
    out[..rows * rows].fill(0.0);
    let mut turned = Vec::new();
    for first in (0..n).step_by(TURNED) {
        let width = TURNED.min(n - first);
        turned.clear();
        turned.resize(width * rows, 0.0);
        turn(&a[first..], n, rows, &mut turned);
        triangle::add_gram(Left::transposed(&turned, rows), (&turned, rows), width, out, rows, [rows; 2], Write::Add);
    }
}

/// Columns of rows that are `stride` apart, as rows of `out`.
fn turn(a: &[f64], stride: usize, rows: usize, out: &mut [f64]) {
    let columns = out.len() / rows.max(1);
    out.par_chunks_mut((rows * WIDTH).max(1)).enumerate().for_each(|(task, out)| {
        let first = task * WIDTH;
        for row in 0..rows {
            let row_of = &a[row * stride + first..row * stride + columns.min(first + WIDTH)];
            out.iter_mut().skip(row).step_by(rows).zip(row_of).for_each(|(out, x)| *out = *x);
        }
    });
}

/// The lower triangle of `j^T j`, for `j` row-major of `rows x n`, into `out` of `n x n`, column-major.
///
/// Read row by row, `out` is the upper triangle, and `j` the right factor as it lies.
pub(crate) fn gram_of_columns(j: &[f64], rows: usize, n: usize, out: &mut [f64]) {
    triangle::add_gram(Left::transposed(j, n), (j, n), rows, out, n, [n; 2], Write::Set);
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
    let count = b.len() / n.max(1);
    if count == 0 {
        return;
    }
    let isa = Isa::detect();
    let mut right = Packed::zeros(isa, n, count);
    right.pack(Left::transposed(b, n), count);
    a.par_chunks(n * WIDTH).zip(out.par_chunks_mut(WIDTH)).for_each(|(a, out)| {
        let width = right.columns();
        let mut products = vec![0.0; out.len() * width];
        let shape = Shape { rows: out.len(), columns: width, inner: n };
        gemm(isa, shape, Left::rows(a, n), Right::Packed(&right), &mut products, width, Write::Set);
        for (out, products) in out.iter_mut().zip(products.chunks_exact(width)) {
            *out += super::vector::dot(products, products);
        }
    });
}

/// `j -= q q^T j`, for `q` of `rows x k` and `j` of `rows x n`, both row-major.
pub(crate) fn subtract_projection(q: &[f64], k: usize, j: &mut [f64], n: usize) {
    let isa = Isa::detect();
    let rows = j.len() / n.max(1);
    let mut right = Packed::zeros(isa, rows, n);
    right.pack(Left::rows(j, n), n);
    let width = right.columns();
    let mut within = vec![0.0; k * width];
    let shape = Shape { rows: k, columns: width, inner: rows };
    gemm(isa, shape, Left::transposed(q, k), Right::Packed(&right), &mut within, width, Write::Set);
    j.par_chunks_mut((n * WIDTH).max(1)).zip(q.par_chunks(k * WIDTH)).for_each(|(j, q)| {
        let count = j.len() / n;
        let mut projected = vec![0.0; count * width];
        let shape = Shape { rows: count, columns: width, inner: k };
        let right = Right::Rows { elements: &within, stride: width };
        gemm(isa, shape, Left::rows(q, k), right, &mut projected, width, Write::Set);
        for (j, projected) in j.chunks_exact_mut(n).zip(projected.chunks_exact(width)) {
            j.iter_mut().zip(projected).for_each(|(j, projected)| *j -= projected);
        }
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
    let matrix = DMatrix::from_column_slice(n, n, &matrix[..n * n]);
    let found = SymmetricEigen::try_new(matrix, f64::EPSILON, ITERATIONS * n.max(1))?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
    let values = order.iter().map(|&at| found.eigenvalues[at]).collect();
    let vectors = order.iter().flat_map(|&at| found.eigenvectors.column(at).iter().copied().collect::<Vec<f64>>());
    Some((values, vectors.collect()))
}

/// Iterations for an eigenvalue at most; two or three are usual.
const ITERATIONS: usize = 64;

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
            let turned: Vec<f64> = (0..n).flat_map(|at| j.iter().skip(at).step_by(n).copied()).collect();
            gram_of_rows(&turned, n, rows, &mut general);
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
