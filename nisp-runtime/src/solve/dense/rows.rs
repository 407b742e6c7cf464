//! Cholesky factors `A = U^T U` row by row: some rows of a matrix are eliminated, and what is left of the others follows.
//!
//! Rows lie one after the other, `stride` apart, and only what stands on and right of the diagonal counts. So the products of
//! the engine's layers do nearly all of the work, with `U` as both of their factors as it lies.

use std::ops::Range;

use rayon::prelude::*;

use super::blocks::{BLOCK, Diagonal, Substitution};
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::{Isa, dispatch};

/// Rows are as long as a multiple of this: whole vectors of any instruction set.
pub(crate) const ALIGN: usize = 8;
/// Rows that are eliminated before the rest of the matrix is updated.
const PANEL: usize = 4 * BLOCK;
/// Rows of a task: their number and shape depend on the matrix alone, so that the number of threads changes no bit.
const HEIGHT: usize = 96;
/// Rows on the diagonal whose products with each other are all taken, though nobody needs those below the diagonal.
const STEP: usize = 24;
/// Products of numbers for which waking a second thread pays.
const SHARED: usize = 1 << 17;

/// Rows that are eliminated together: `width` of them, whose columns are their own `width`, and from the next multiple of
/// [`ALIGN`] on those of others. What lies between is zero.
#[derive(Clone, Copy)]
pub(crate) struct Strip {
    pub(crate) width: usize,
    pub(crate) stride: usize,
}

impl Strip {
    /// Of so many rows, which so many others meet.
    pub(crate) fn new(width: usize, others: usize) -> Self {
        let lines = width.div_ceil(ALIGN) + others.div_ceil(ALIGN);
        // An odd number of cache lines: rows a power of two apart would fight for the same places of the cache.
        Self { width, stride: (lines | 1) * ALIGN }
    }

    /// Where the columns of others begin.
    pub(crate) fn others(self) -> usize {
        self.width.next_multiple_of(ALIGN)
    }

    /// Numbers in its rows.
    pub(crate) fn len(self) -> usize {
        self.width * self.stride
    }

    /// From rows of a matrix to those of its factor; false where it is not positive definite in this precision.
    pub(crate) fn eliminate(self, isa: Isa, rows: &mut [f64]) -> bool {
        let Self { width, stride } = self;
        for first in (0..width).step_by(PANEL) {
            let count = PANEL.min(width - first);
            let (own, below) = rows[first * stride..].split_at_mut(count * stride);
            if !eliminate(isa, own, (first, count, stride)) {
                return false;
            }
            if !below.is_empty() {
                let start = first + count;
                square(isa, (&own[start..], stride, count), below, (stride, start), Write::Subtract);
            }
        }
        true
    }

    /// Length of the rows of what is left to others.
    pub(crate) fn apart(self) -> usize {
        self.stride - self.others()
    }

    /// What the eliminated rows take from the matrix of the others, [`Strip::apart`] from row to row, on and right of its diagonal.
    pub(crate) fn taken(self, isa: Isa, rows: &[f64], from_others: &mut [f64]) {
        if !from_others.is_empty() {
            let own = (&rows[self.others()..], self.stride, self.width);
            square(isa, own, from_others, (self.apart(), 0), Write::Set);
        }
    }

    /// Solves `U^T x = b` in place, for its own columns and so many right-hand sides, a multiple of [`ALIGN`]; row by row.
    pub(crate) fn solve_transposed(self, isa: Isa, rows: &[f64], x: &mut [f64], sides: usize) {
        let Self { width, stride } = self;
        for first in (0..width).step_by(BLOCK) {
            let count = BLOCK.min(width - first);
            let (before, x) = x.split_at_mut(first * sides);
            let shape = Shape { rows: count, columns: sides, inner: first };
            if first > 0 {
                let right = Right::Rows { elements: before, stride: sides };
                gemm(isa, shape, Left::transposed(&rows[first..], stride), right, x, sides, Write::Subtract);
            }
            let rows = &rows[first * (stride + 1)..];
            dispatch(isa, Substitution { rows, stride, count, x, apart: sides, sides, transposed: true });
        }
    }

    /// Solves `U x = b` in place, as [`Strip::solve_transposed`] does.
    pub(crate) fn solve(self, isa: Isa, rows: &[f64], x: &mut [f64], sides: usize) {
        let Self { width, stride } = self;
        for first in (0..width).step_by(BLOCK).rev() {
            let count = BLOCK.min(width - first);
            let (x, after) = x[first * sides..].split_at_mut(count * sides);
            let rows = &rows[first * (stride + 1)..];
            let shape = Shape { rows: count, columns: sides, inner: width - first - count };
            if shape.inner > 0 {
                let right = Right::Rows { elements: after, stride: sides };
                gemm(isa, shape, Left::rows(&rows[count..], stride), right, x, sides, Write::Subtract);
            }
            dispatch(isa, Substitution { rows, stride, count, x, apart: sides, sides, transposed: false });
        }
    }
}

/// Eliminates so many rows, as far apart as given, of which the first one's diagonal stands in the given column.
fn eliminate(isa: Isa, rows: &mut [f64], (at, height, stride): (usize, usize, usize)) -> bool {
    let mut block = [0.0; BLOCK * BLOCK];
    for first in (0..height).step_by(BLOCK) {
        let count = BLOCK.min(height - first);
        let (own, below) = rows[first * stride..].split_at_mut(count * stride);
        if !dispatch(isa, Diagonal { rows: &mut own[at + first..], stride, count, block: &mut block }) {
            return false;
        }
        let start = (at + first + count).next_multiple_of(ALIGN);
        if start < stride {
            divide(isa, &block, own, (count, stride, start));
            square(isa, (&own[start..], stride, count), below, (stride, start), Write::Subtract);
        }
    }
    true
}

/// Replaces rows, as far apart as given, by `U^-T` times them from a column on; `U` is the block on the diagonal left of there. By
/// substitution: the inverse of a block loses the digits of small pivots.
fn divide(isa: Isa, block: &[f64], rows: &mut [f64], (count, stride, start): (usize, usize, usize)) {
    let sides = stride - start;
    for first in (0..count).step_by(ALIGN) {
        let height = ALIGN.min(count - first);
        let (before, own) = rows.split_at_mut(first * stride);
        if first > 0 {
            let shape = Shape { rows: height, columns: sides, inner: first };
            let right = Right::Rows { elements: &before[start..], stride };
            gemm(
                isa,
                shape,
                Left::transposed(&block[first..], BLOCK),
                right,
                &mut own[start..],
                stride,
                Write::Subtract,
            );
        }
        let (rows, x) = (&block[first * (BLOCK + 1)..], &mut own[start..]);
        dispatch(isa, Substitution { rows, stride: BLOCK, count: height, x, apart: stride, sides, transposed: true });
    }
}

/// Writes `u^T u` to rows, on and right of the diagonal: `u` has so many rows, as far apart as given; the rows are as far apart as
/// given, and the first one's diagonal stands in the given column.
fn square(
    isa: Isa,
    (u, apart, inner): (&[f64], usize, usize),
    rows: &mut [f64],
    (stride, start): (usize, usize),
    write: Write,
) {
    let product = |rows: &mut [f64], first: usize, columns: Range<usize>| {
        let shape = Shape { rows: rows.len() / stride, columns: columns.len(), inner };
        let right = Right::Rows { elements: &u[columns.start..], stride: apart };
        gemm(
            isa,
            shape,
            Left::transposed(&u[first..], apart),
            right,
            &mut rows[start + columns.start..],
            stride,
            write,
        );
    };
    let task = |(task, rows): (usize, &mut [f64])| {
        let (at, end) = (task * HEIGHT, stride - start);
        let beside = (at + rows.len() / stride).next_multiple_of(ALIGN);
        for (step, rows) in rows.chunks_mut(STEP * stride).enumerate() {
            let first = at + step * STEP;
            product(rows, first, first..beside);
        }
        if beside < end {
            product(rows, at, beside..end);
        }
    };
    if rows.len() * inner < SHARED {
        rows.chunks_mut(HEIGHT * stride).enumerate().for_each(task);
    } else {
        rows.par_chunks_mut(HEIGHT * stride).enumerate().for_each(task);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a positive definite matrix: sines beside a diagonal that outweighs them.
    fn matrix(size: usize) -> impl Fn(usize, usize) -> f64 {
        move |i, j| if i == j { 2.0 * size as f64 } else { ((i.min(j) * 7 + i.max(j) * 3) as f64).sin() }
    }

    /// The factor's product with itself is the matrix, and what is left of the others is their Schur complement, which the
    /// factor of the whole has as the product of its last rows.
    #[test]
    fn some_rows_are_eliminated_as_in_the_whole() {
        let isa = Isa::detect();
        for (width, others) in [(1, 0), (3, 2), (8, 8), (33, 5), (70, 150), (200, 1)] {
            let size = width + others;
            let entry = matrix(size);
            let whole = Strip::new(size, 0);
            let mut factor = vec![0.0; whole.len()];
            (0..size).for_each(|i| (i..size).for_each(|j| factor[i * whole.stride + j] = entry(i, j)));
            assert!(whole.eliminate(isa, &mut factor));
            let u = |i: usize, j: usize| factor[i * whole.stride + j];
            for i in 0..size {
                for j in i..size {
                    let product: f64 = (0..=i).map(|k| u(k, i) * u(k, j)).sum();
                    assert!((product - entry(i, j)).abs() < 1e-13 * size as f64, "{width} {others}: {i} {j}");
                }
            }
            let strip = Strip::new(width, others);
            let place = |j: usize| if j < width { j } else { strip.others() + j - width };
            let mut rows = vec![0.0; strip.len()];
            (0..width).for_each(|i| (i..size).for_each(|j| rows[i * strip.stride + place(j)] = entry(i, j)));
            let apart = strip.apart();
            let mut taken = vec![f64::NAN; others * apart];
            assert!(strip.eliminate(isa, &mut rows));
            strip.taken(isa, &rows, &mut taken);
            for i in 0..width {
                for j in i..size {
                    let found = rows[i * strip.stride + place(j)];
                    assert!((found - u(i, j)).abs() < 1e-13 * size as f64, "{width} {others}: {i} {j}");
                }
            }
            for i in 0..others {
                for j in i..others {
                    let left: f64 = (0..=i).map(|k| u(width + k, width + i) * u(width + k, width + j)).sum();
                    let rest = entry(width + i, width + j) - taken[i * apart + j];
                    assert!((rest - left).abs() < 1e-13 * size as f64, "{width} {others}: {i} {j}");
                }
            }
        }
    }

    #[test]
    fn solutions_of_both_triangles_are_those_that_were_multiplied() {
        let isa = Isa::detect();
        for (size, sides) in [(1, 8), (31, 8), (64, 16), (133, 24)] {
            let (entry, strip) = (matrix(size), Strip::new(size, 0));
            let mut factor = vec![0.0; strip.len()];
            (0..size).for_each(|i| (i..size).for_each(|j| factor[i * strip.stride + j] = entry(i, j)));
            assert!(strip.eliminate(isa, &mut factor));
            let solution: Vec<f64> = (0..size * sides).map(|at| (at as f64 * 0.37).cos()).collect();
            // A x = b by both triangles, one after the other.
            let mut x: Vec<f64> = (0..size * sides)
                .map(|at| (0..size).map(|k| entry(at / sides, k) * solution[k * sides + at % sides]).sum())
                .collect();
            strip.solve_transposed(isa, &factor, &mut x, sides);
            strip.solve(isa, &factor, &mut x, sides);
            assert!(x.iter().zip(&solution).all(|(x, y)| (x - y).abs() < 1e-12), "{size} {sides}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        for (size, at) in [(1, 0), (40, 39), (100, 50)] {
            let strip = Strip::new(size, 0);
            let mut rows = vec![0.0; strip.len()];
            (0..size).for_each(|i| rows[i * (strip.stride + 1)] = if i == at { -1.0 } else { 1.0 });
            assert!(!strip.eliminate(Isa::detect(), &mut rows), "{size}");
        }
    }
}
