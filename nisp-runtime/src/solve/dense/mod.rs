//! Products and factorisations of dense matrices, by the products of the engine's layers.
//!
//! Every product is cut into tasks whose number and shape depend on the matrix alone, each computed by one thread, so
//! that the number of threads does not change a bit. Matrices of rows (Jacobians) are row-major; square matrices are
//! column-major with only their lower triangle in use: row-major, with only their upper triangle.

mod blocks;
mod cholesky;
pub(crate) mod rows;

pub(crate) use cholesky::Cholesky;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;

/// Columns of a task: wide enough for the kernel, narrow enough to balance two threads at 400 columns.
const WIDTH: usize = 96;

/// The transpose of `rows x n` elements, with rows that end at whole vectors, and their length.
fn transposed(a: &[f64], rows: usize, n: usize) -> (Vec<f64>, usize) {
    let stride = rows.next_multiple_of(rows::ALIGN);
    let mut out = vec![0.0; n * stride];
    // Some rows at a time, which a cache holds together with what becomes of them.
    for (block, a) in a[..rows * n].chunks((n * rows::ALIGN).max(1)).enumerate() {
        for (column, out) in out.chunks_exact_mut(stride.max(1)).enumerate() {
            let out = &mut out[block * rows::ALIGN..];
            a.chunks_exact(n).zip(out).for_each(|(a, out)| *out = a[column]);
        }
    }
    (out, stride)
}

/// The lower triangle of `a a^T`, for `a` row-major of `rows x n`, into `out` of `rows x rows`.
pub(crate) fn gram(a: &[f64], rows: usize, n: usize, out: &mut [f64]) {
    let (turned, stride) = transposed(a, rows, n);
    let mut wide = vec![0.0; stride * stride];
    gram_of_columns(&turned, n, stride, &mut wide);
    out.chunks_exact_mut(rows.max(1))
        .zip(wide.chunks_exact(stride.max(1)))
        .for_each(|(out, wide)| out.copy_from_slice(&wide[..rows]));
}

/// The lower triangle of `j^T j`, for `j` row-major of `rows x n`, into `out` of `n x n`, column-major.
///
/// Read row by row, `out` is the upper triangle, and `j` the right factor as it lies.
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
    let (b, columns) = transposed(b, b.len() / n.max(1), n);
    let isa = Isa::detect();
    a.par_chunks(n * WIDTH).zip(out.par_chunks_mut(WIDTH)).for_each(|(a, out)| {
        let mut products = vec![0.0; out.len() * columns];
        let (shape, right) =
            (Shape { rows: out.len(), columns, inner: n }, Right::Rows { elements: &b, stride: columns });
        gemm(isa, shape, Left::rows(a, n), right, &mut products, columns, Write::Set);
        for (out, products) in out.iter_mut().zip(products.chunks_exact(columns)) {
            *out += super::vector::dot(products, products);
        }
    });
}

/// `j -= q q^T j`, for `q` of `rows x k` and `j` of `rows x n`, both row-major.
pub(crate) fn subtract_projection(q: &[f64], k: usize, j: &mut [f64], n: usize) {
    let (rows, isa) = (j.len() / n.max(1), Isa::detect());
    // Columns that whole vectors do not reach are done one by one.
    let whole = n - n % isa.lanes::<f64>();
    let mut within = vec![0.0; k * n];
    let shape = Shape { rows: k, columns: whole, inner: rows };
    gemm(isa, shape, Left::transposed(q, k), Right::Rows { elements: j, stride: n }, &mut within, n, Write::Set);
    for (q, j) in q.chunks_exact(k.max(1)).zip(j.chunks_exact(n.max(1))) {
        for (q, within) in q.iter().zip(within.chunks_exact_mut(n)) {
            within[whole..].iter_mut().zip(&j[whole..]).for_each(|(within, j)| *within += q * j);
        }
    }
    j.par_chunks_mut(n * WIDTH).zip(q.par_chunks(k * WIDTH)).for_each(|(j, q)| {
        let shape = Shape { rows: j.len() / n, columns: whole, inner: k };
        gemm(isa, shape, Left::rows(q, k), Right::Rows { elements: &within, stride: n }, j, n, Write::Subtract);
        for (j, q) in j.chunks_exact_mut(n).zip(q.chunks_exact(k)) {
            for (q, within) in q.iter().zip(within.chunks_exact(n)) {
                j[whole..].iter_mut().zip(&within[whole..]).for_each(|(j, within)| *j -= q * within);
            }
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
/// whose lower triangle is given; `None` where it is not finite.
pub(crate) fn eigen(matrix: &[f64], n: usize) -> Option<(Vec<f64>, Vec<f64>)> {
    let lower = |row: usize, column: usize| matrix[row.min(column) * n + row.max(column)];
    let matrix = DMatrix::from_fn(n, n, lower);
    let found = matrix.iter().all(|x| x.is_finite()).then(|| matrix.symmetric_eigen())?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
    let vectors = order.iter().flat_map(|&at| found.eigenvectors.column(at).iter().copied().collect::<Vec<f64>>());
    Some((order.iter().map(|&at| found.eigenvalues[at]).collect(), vectors.collect()))
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
            let (turned, stride) = transposed(&j, rows, n);
            let turned: Vec<f64> = turned.chunks_exact(stride).flat_map(|row| &row[..rows]).copied().collect();
            gram(&turned, n, rows, &mut general);
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

    /// Less its part along orthonormal columns, a matrix is orthogonal to them.
    #[test]
    fn projections_leave_nothing_along_the_columns() {
        for (rows, k, n) in [(5, 1, 1), (200, 9, 30)] {
            let basis = nalgebra::DMatrix::from_row_slice(rows, k, &wavy(rows, k)).qr().q();
            let q: Vec<f64> = (0..rows * k).map(|at| basis[(at / k, at % k)]).collect();
            let before = wavy(rows, n);
            let mut j = before.clone();
            subtract_projection(&q, k, &mut j, n);
            let expected = nalgebra::DMatrix::from_row_slice(rows, n, &before);
            let expected = &expected - &basis * (basis.transpose() * &expected);
            assert!((0..rows * n).all(|at| (j[at] - expected[(at / n, at % n)]).abs() < 1e-12), "{rows} {k} {n}");
        }
    }
}
