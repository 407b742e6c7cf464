//! Cholesky factors by blocks, and what is solved with them.
//!
//! A factor is the upper triangle `U` of `H = U^T U`, row after row: the lower triangle `L = U^T`, column after column. All work runs
//! along its rows. It is halved until eight rows are left; the products between the halves are those of the engine's layers.

use std::ops::Range;

use rayon::prelude::*;

use super::WIDTH;
use super::substitution::{Few, LEAST, half, negated, solve_forward};
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;

/// Rows that are factorised before the rest of the matrix is updated.
pub(super) const PANEL: usize = 2 * WIDTH;

/// Factorises the first `rows` rows of a symmetric matrix of `n` columns, of which the upper triangle is given, `n` apart; false
/// where it is not positive definite in this precision. What is below the diagonal is overwritten with numbers of no meaning.
pub(crate) fn factorise(matrix: &mut [f64], rows: usize, n: usize) -> bool {
    for first in (0..rows).step_by(PANEL) {
        let (height, left) = (PANEL.min(rows - first), n - first);
        let panel = &mut matrix[first * (n + 1)..];
        if left - height < 2 * WIDTH {
            if !eliminate(panel, n, 0..height, left) {
                return false;
            }
        } else {
            if !eliminate(panel, n, 0..height, height) {
                return false;
            }
            solve_beside(panel, n, height, left);
        }
        if first + height < rows {
            let (panel, rest) = matrix.split_at_mut((first + height) * n);
            let panel = &panel[first * n + first + height..];
            subtract_gram(panel, n, height, &mut rest[first + height..], n, rows - first - height, left - height);
        }
    }
    true
}

/// From the upper triangle of the first `rows` rows of a symmetric matrix of `columns` columns, `stride` apart, subtracts `J^T J`
/// for the `inner` rows of `j`, `j_stride` apart.
pub(crate) fn subtract_gram(
    j: &[f64],
    j_stride: usize,
    inner: usize,
    out: &mut [f64],
    stride: usize,
    rows: usize,
    columns: usize,
) {
    let negated: Vec<f64> = (0..inner).flat_map(|k| j[k * j_stride..][..rows].iter().map(|x| -x)).collect();
    add_gram(Left::transposed(&negated, rows), (j, j_stride), inner, out, stride, [rows, columns], Write::Add);
}

/// Writes the upper triangle of the first rows of a product that is symmetric, or adds it. Tasks depend on its size alone.
pub(super) fn add_gram(
    left: Left<'_, f64>,
    (right, right_stride): (&[f64], usize),
    inner: usize,
    out: &mut [f64],
    stride: usize,
    [rows, columns]: [usize; 2],
    write: Write,
) {
    let isa = Isa::detect();
    // Whole blocks of the products; high, for every task reads all of the right factor, yet enough tasks to share out.
    let height = 14 * (columns / (8 * 14)).clamp(1, 14);
    // Rows end at whole vectors; what is left over lies at their start.
    let rest = columns % isa.lanes::<f64>();
    let task = |(task, block): (usize, &mut [f64])| {
        let first = task * height;
        let count = height.min(rows - first);
        let start = (first - (first - rest.min(first)) % isa.lanes::<f64>()).max(rest);
        let left = Left { elements: &left.elements[first * left.row..], ..left };
        if start < columns {
            let shape = Shape { rows: count, columns: columns - start, inner };
            let right = Right::Rows { elements: &right[start..], stride: right_stride };
            gemm(isa, shape, left, right, &mut block[start..], stride, write);
        }
        for (a, row) in (first..rest.min(first + count)).zip(block.chunks_mut(stride)) {
            for (b, out) in row[..rest].iter_mut().enumerate().skip(a) {
                let product =
                    |k: usize| left.elements[(a - first) * left.row + k * left.column] * right[k * right_stride + b];
                let sum: f64 = (0..inner).map(product).sum();
                *out = if write == Write::Add { *out + sum } else { sum };
            }
        }
    };
    let tasks = rows.div_ceil(height);
    if rows * columns * inner < SMALL {
        out.chunks_mut(stride * height).take(tasks).enumerate().for_each(task);
    } else {
        out.par_chunks_mut(stride * height).take(tasks).enumerate().for_each(task);
    }
}

/// Products of less work than this are not worth a second thread.
const SMALL: usize = 1 << 18;

/// Factorises some rows, up to so many columns; false where the matrix is not positive definite.
fn eliminate(matrix: &mut [f64], stride: usize, rows: Range<usize>, columns: usize) -> bool {
    if rows.len() <= LEAST {
        return eliminate_few(&mut matrix[rows.start * stride..], stride, rows.len(), rows.start, columns);
    }
    let middle = half(&rows);
    if !eliminate(matrix, stride, rows.start..middle, columns) {
        return false;
    }
    let isa = Isa::detect();
    let (done, rest) = matrix.split_at_mut(middle * stride);
    let done = &done[rows.start * stride..];
    let shape = [middle - rows.start, rows.end - middle];
    let left = negated(done, stride, middle, shape);
    // Some columns before the diagonal make whole vectors.
    let start = middle - (middle - columns % LEAST) % LEAST;
    let right = Right::Rows { elements: &done[start..], stride };
    let shape = Shape { rows: shape[1], columns: columns - start, inner: shape[0] };
    gemm(isa, shape, Left::transposed(&left, shape.rows), right, &mut rest[start..], stride, Write::Add);
    eliminate(matrix, stride, middle..rows.end, columns)
}

/// Factorises at most [`LEAST`] rows, whose diagonal begins at a column.
fn eliminate_few(matrix: &mut [f64], stride: usize, rows: usize, column: usize, columns: usize) -> bool {
    let mut corner = [[0.0; LEAST]; LEAST];
    for i in 0..rows {
        let (before, from) = corner.split_at_mut(i);
        let row = &mut from[0];
        row[i..rows].copy_from_slice(&matrix[i * stride + column + i..][..rows - i]);
        for before in before {
            (i..rows).for_each(|j| row[j] -= before[i] * before[j]);
        }
        if !(row[i] > 0.0 && row[i].is_finite()) {
            return false;
        }
        let root = row[i].sqrt();
        row[i] = root;
        row[i + 1..rows].iter_mut().for_each(|x| *x /= root);
        matrix[i * stride + column + i..][..rows - i].copy_from_slice(&row[i..rows]);
    }
    let first = column + rows;
    if first < columns {
        Few { corner, rows, x: matrix, stride, columns: first..columns, backward: false }.run_all();
    }
    true
}

/// Solves for the rows of a panel beside its diagonal, strip by strip.
fn solve_beside(panel: &mut [f64], stride: usize, height: usize, columns: usize) {
    let shared = &*panel;
    let strip = |first: usize| {
        let width = WIDTH.min(columns - first);
        let full = width.next_multiple_of(LEAST);
        let mut strip = vec![0.0; height * full];
        for (i, strip) in strip.chunks_exact_mut(full).enumerate() {
            strip[..width].copy_from_slice(&shared[i * stride + first..][..width]);
        }
        solve_forward(shared, stride, 0..height, &mut strip, full);
        (first, width, strip)
    };
    let starts: Vec<usize> = (height..columns).step_by(WIDTH).collect();
    let strips: Vec<(usize, usize, Vec<f64>)> = starts.into_par_iter().map(strip).collect();
    for (first, width, strip) in strips {
        for (i, strip) in strip.chunks_exact(strip.len() / height).enumerate() {
            panel[i * stride + first..][..width].copy_from_slice(&strip[..width]);
        }
    }
}
