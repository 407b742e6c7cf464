//! Cholesky factors `A = U^T U` row by row: some rows of a matrix are eliminated, and what is left of the others follows.
//!
//! Rows lie one after the other, `stride` apart, and only what stands on and right of the diagonal counts. So the products of
//! the engine's layers do nearly all of the work, with `U` as both of their factors. They read it from copies of its columns, block
//! by block: rows of a large matrix lie pages apart.

use std::ops::Range;

use rayon::prelude::*;

use super::blocks::{BLOCK, Diagonal, Substitution};
use crate::aligned::AlignedVec;
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::{Isa, dispatch};

/// Rows are as long as a multiple of this: whole vectors of any instruction set.
pub(crate) const ALIGN: usize = 8;
/// Rows that are eliminated before the rest of the matrix is updated.
const PANEL: usize = 6 * BLOCK;
/// Rows of a task: their number and shape depend on the matrix alone, so that the number of threads changes no bit.
const HEIGHT: usize = 96;
/// Rows on the diagonal whose products with each other are all taken, though nobody needs those below the diagonal.
const STEP: usize = 24;
/// How far rows of a task's columns are apart: an odd number of cache lines.
const ACROSS: usize = HEIGHT + ALIGN;
/// Products of numbers for which waking a second thread pays.
const SHARED: usize = 1 << 23;

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

    /// From rows of a matrix to those of its factor; false where it is not positive definite in this precision. What the rows take from
    /// the matrix of the others goes to `taken`, [`Strip::apart`] from row to row, on and right of its diagonal.
    pub(crate) fn eliminate(self, isa: Isa, rows: &mut [f64], taken: &mut [f64]) -> bool {
        let Self { width, stride } = self;
        for first in (0..width).step_by(PANEL) {
            let count = PANEL.min(width - first);
            let (own, below) = rows[first * stride..].split_at_mut(count * stride);
            if !eliminate(isa, own, (first, count, stride)) {
                return false;
            }
            let blocks = self.blocks((first + count).next_multiple_of(ALIGN));
            let shared = own.len() * (below.len() / stride + taken.len() / self.apart().max(1)) >= SHARED;
            let columns = Columns::divided(isa, own, (first, stride), &blocks, shared);
            let write = if first == 0 { Write::Set } else { Write::Add };
            self.subtract(isa, &columns, (below, taken, write), shared);
        }
        true
    }

    /// Length of the rows of what is left to others.
    pub(crate) fn apart(self) -> usize {
        self.stride - self.others()
    }

    /// Its columns from one on, in blocks of a task each: first its own columns, then those of others.
    fn blocks(self, start: usize) -> Vec<Range<usize>> {
        let part = |from: usize, end: usize| (from..end).step_by(HEIGHT).map(move |at| at..end.min(at + HEIGHT));
        part(start, self.others()).chain(part(self.others().max(start), self.stride)).collect()
    }

    /// Subtracts the products of the eliminated columns with each other from the rows `below`; those of others with each other go to `taken`.
    fn subtract(
        self,
        isa: Isa,
        columns: &Columns,
        (below, taken, write): (&mut [f64], &mut [f64], Write),
        shared: bool,
    ) {
        let own = below.len().div_ceil(HEIGHT * self.stride);
        let task = |(task, rows): (usize, &mut [f64])| {
            let (stride, before, write) = match task < own {
                true => (self.stride, 0, Write::Subtract),
                false => (self.apart(), self.others(), write),
            };
            let left = columns.block(task);
            for (number, block) in columns.blocks.iter().enumerate().skip(task) {
                // Of a block on the diagonal, most of what is below it is left out.
                let step = if number == task { STEP } else { HEIGHT };
                for (step_at, rows) in rows.chunks_mut(step * stride).enumerate() {
                    let first = step_at * step;
                    let from = if number == task { first } else { 0 };
                    let shape = Shape { rows: rows.len() / stride, columns: block.len() - from, inner: columns.inner };
                    let right = Right::Rows { elements: &columns.block(number)[from..], stride: ACROSS };
                    let left = Left::transposed(&left[first..], ACROSS);
                    gemm(isa, shape, left, right, &mut rows[block.start - before + from..], stride, write);
                }
            }
        };
        let (tall, others) = (HEIGHT * self.stride, HEIGHT * self.apart().max(1));
        if shared {
            below.par_chunks_mut(tall).chain(taken.par_chunks_mut(others)).enumerate().for_each(task);
        } else {
            below.chunks_mut(tall).chain(taken.chunks_mut(others)).enumerate().for_each(task);
        }
    }

    /// Solves `U^T x = b` in place, for its own columns and so many right-hand sides, a multiple of [`ALIGN`]; row by row, as far apart as
    /// given. By substitution: the inverse of a block on the diagonal loses the digits of small pivots.
    pub(crate) fn solve_transposed(self, isa: Isa, rows: &[f64], x: &mut [f64], (sides, apart): (usize, usize)) {
        let Self { width, stride } = self;
        for first in (0..width).step_by(ALIGN) {
            let count = ALIGN.min(width - first);
            let (before, x) = x.split_at_mut(first * apart);
            let shape = Shape { rows: count, columns: sides, inner: first };
            if first > 0 {
                let right = Right::Rows { elements: before, stride: apart };
                gemm(isa, shape, Left::transposed(&rows[first..], stride), right, x, apart, Write::Subtract);
            }
            let rows = &rows[first * (stride + 1)..];
            dispatch(isa, Substitution { rows, stride, count, x, apart, sides, transposed: true });
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

/// Columns of eliminated rows, copied block by block: rows of a block are next to each other.
struct Columns<'a> {
    blocks: &'a [Range<usize>],
    /// Eliminated rows.
    inner: usize,
    elements: AlignedVec<f64>,
}

impl<'a> Columns<'a> {
    /// Replaces blocks of columns of some rows, as far apart as given, by `U^-T` times them; `U` begins in the given column.
    fn divided(
        isa: Isa,
        rows: &mut [f64],
        (at, stride): (usize, usize),
        blocks: &'a [Range<usize>],
        shared: bool,
    ) -> Self {
        let inner = rows.len() / stride;
        let mut elements = AlignedVec::zeros(blocks.len() * inner * ACROSS);
        let from = &*rows;
        let divide = |(block, x): (&Range<usize>, &mut [f64])| {
            for (x, row) in x.chunks_exact_mut(ACROSS).zip(from.chunks(stride)) {
                x[..block.len()].copy_from_slice(&row[block.clone()]);
            }
            Strip { width: inner, stride }.solve_transposed(isa, &from[at..], x, (block.len(), ACROSS));
        };
        if shared {
            blocks.par_iter().zip(elements.par_chunks_exact_mut(inner * ACROSS)).for_each(divide);
        } else {
            blocks.iter().zip(elements.chunks_exact_mut(inner * ACROSS)).for_each(divide);
        }
        let columns = Columns { blocks, inner, elements };
        for (number, block) in blocks.iter().enumerate() {
            for (x, row) in columns.block(number).chunks_exact(ACROSS).zip(rows.chunks_mut(stride)) {
                row[block.clone()].copy_from_slice(&x[..block.len()]);
            }
        }
        columns
    }

    fn block(&self, number: usize) -> &[f64] {
        &self.elements[number * self.inner * ACROSS..][..self.inner * ACROSS]
    }
}

/// Eliminates so many rows, as far apart as given, in as many columns, which begin at the given one; false where the matrix is not positive
/// definite.
fn eliminate(isa: Isa, rows: &mut [f64], (at, count, stride): (usize, usize, usize)) -> bool {
    let mut block = [0.0; BLOCK * BLOCK];
    let end = (at + count).next_multiple_of(ALIGN);
    for first in (0..count).step_by(BLOCK) {
        let height = BLOCK.min(count - first);
        let (own, below) = rows[first * stride..].split_at_mut(height * stride);
        if !dispatch(isa, Diagonal { rows: &mut own[at + first..], stride, count: height, block: &mut block }) {
            return false;
        }
        if below.is_empty() {
            break;
        }
        let start = at + first + height;
        let divisor = Strip { width: height, stride: BLOCK };
        divisor.solve_transposed(isa, &block, &mut own[start..], (end - start, stride));
        for (step, rows) in below.chunks_mut(STEP * stride).enumerate() {
            let from = start + step * STEP;
            let shape = Shape { rows: rows.len() / stride, columns: end - from, inner: height };
            let right = Right::Rows { elements: &own[from..], stride };
            gemm(isa, shape, Left::transposed(&own[from..], stride), right, &mut rows[from..], stride, Write::Subtract);
        }
    }
    true
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
        for (width, others) in [(1, 0), (3, 2), (8, 8), (33, 5), (70, 150), (200, 1), (301, 203)] {
            let size = width + others;
            let entry = matrix(size);
            let whole = Strip::new(size, 0);
            let mut factor = vec![0.0; whole.len()];
            (0..size).for_each(|i| (i..size).for_each(|j| factor[i * whole.stride + j] = entry(i, j)));
            assert!(whole.eliminate(isa, &mut factor, &mut []));
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
            assert!(strip.eliminate(isa, &mut rows, &mut taken));
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
            assert!(strip.eliminate(isa, &mut factor, &mut []));
            let solution: Vec<f64> = (0..size * sides).map(|at| (at as f64 * 0.37).cos()).collect();
            // A x = b by both triangles, one after the other.
            let mut x: Vec<f64> = (0..size * sides)
                .map(|at| (0..size).map(|k| entry(at / sides, k) * solution[k * sides + at % sides]).sum())
                .collect();
            strip.solve_transposed(isa, &factor, &mut x, (sides, sides));
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
            assert!(!strip.eliminate(Isa::detect(), &mut rows, &mut []), "{size}");
        }
    }
}
