//! Solutions with the factors of [`triangle`](super::triangle), by halves in the same way.

use std::ops::Range;

use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::{self, Isa, Kernel, Simd, dispatch};

/// Rows that are eliminated one by one; a multiple of the lanes of every instruction set.
pub(super) const LEAST: usize = 8;

/// Solves `U^T X = B` in place for the rows of `x`, whose number of columns is a multiple of [`LEAST`].
pub(crate) fn solve_forward(factor: &[f64], stride: usize, rows: Range<usize>, x: &mut [f64], columns: usize) {
    if rows.len() <= LEAST {
        return solve_few(factor, stride, rows, x, columns, false);
    }
    let middle = half(&rows);
    solve_forward(factor, stride, rows.start..middle, x, columns);
    let (done, rest) = x.split_at_mut(middle * columns);
    let shape = Shape { rows: rows.end - middle, columns, inner: middle - rows.start };
    let left = negated(&factor[rows.start * stride..], stride, middle, [shape.inner, shape.rows]);
    let right = Right::Rows { elements: &done[rows.start * columns..], stride: columns };
    gemm(Isa::detect(), shape, Left::transposed(&left, shape.rows), right, rest, columns, Write::Add);
    solve_forward(factor, stride, middle..rows.end, x, columns);
}

/// Solves `U X = B` in the same way.
pub(crate) fn solve_backward(factor: &[f64], stride: usize, rows: Range<usize>, x: &mut [f64], columns: usize) {
    if rows.len() <= LEAST {
        return solve_few(factor, stride, rows, x, columns, true);
    }
    let middle = half(&rows);
    solve_backward(factor, stride, middle..rows.end, x, columns);
    let (rest, done) = x.split_at_mut(middle * columns);
    let shape = Shape { rows: middle - rows.start, columns, inner: rows.end - middle };
    let left = negated(&factor[rows.start * stride..], stride, middle, [shape.rows, shape.inner]);
    let right = Right::Rows { elements: done, stride: columns };
    let rest = &mut rest[rows.start * columns..];
    gemm(Isa::detect(), shape, Left::rows(&left, shape.inner), right, rest, columns, Write::Add);
    solve_backward(factor, stride, rows.start..middle, x, columns);
}

fn solve_few(factor: &[f64], stride: usize, rows: Range<usize>, x: &mut [f64], columns: usize, backward: bool) {
    let mut corner = [[0.0; LEAST]; LEAST];
    for (corner, i) in corner.iter_mut().zip(rows.clone()) {
        corner[..rows.len()].copy_from_slice(&factor[i * stride + rows.start..][..rows.len()]);
    }
    let (count, x) = (rows.len(), &mut x[rows.start * columns..]);
    Few { corner, rows: count, x, stride: columns, columns: 0..columns, backward }.run_all();
}

/// Solves with at most [`LEAST`] rows of a factor, for rows of right-hand sides.
pub(super) struct Few<'a> {
    /// Rows of the factor, from their diagonal on.
    pub(super) corner: [[f64; LEAST]; LEAST],
    pub(super) rows: usize,
    pub(super) x: &'a mut [f64],
    pub(super) stride: usize,
    pub(super) columns: Range<usize>,
    /// Whether with `U`, and not with its transpose.
    pub(super) backward: bool,
}

impl Few<'_> {
    /// Whole vectors, then the columns that are left.
    pub(super) fn run_all(self) {
        let isa = Isa::detect();
        let Self { corner, rows, x, stride, columns, backward } = self;
        let middle = columns.end - columns.len() % isa.lanes::<f64>();
        dispatch(isa, Few { corner, rows, x, stride, columns: columns.start..middle, backward });
        if middle < columns.end {
            simd::plain(Few { corner, rows, x, stride, columns: middle..columns.end, backward });
        }
    }
}

impl Kernel<f64> for Few<'_> {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(self) {
        let Self { corner, rows, x, stride, columns, backward } = self;
        // Rows that are not there are those of the unit matrix.
        let mut full = [[0.0; LEAST]; LEAST];
        let mut inverse = [1.0; LEAST];
        for i in 0..rows {
            full[i] = corner[i];
            inverse[i] = 1.0 / corner[i][i];
        }
        for column in columns.step_by(V::LANES) {
            let mut all = [V::lit(0.0); LEAST];
            for (i, all) in all.iter_mut().enumerate().take(rows) {
                // SAFETY: the slice has LANES elements.
                *all = unsafe { V::load(x[i * stride + column..][..V::LANES].as_ptr()) };
            }
            if backward {
                for i in (0..LEAST).rev() {
                    for j in i + 1..LEAST {
                        all[i] = V::splat(full[i][j]).neg_mul_add(all[j], all[i]);
                    }
                    all[i] = all[i].mul(V::splat(inverse[i]));
                }
            } else {
                for i in 0..LEAST {
                    for j in 0..i {
                        all[i] = V::splat(full[j][i]).neg_mul_add(all[j], all[i]);
                    }
                    all[i] = all[i].mul(V::splat(inverse[i]));
                }
            }
            for (i, all) in all.iter().enumerate().take(rows) {
                // SAFETY: as above.
                unsafe { all.store(x[i * stride + column..][..V::LANES].as_mut_ptr()) };
            }
        }
    }
}

/// The middle of some rows, at whole steps of [`LEAST`] from their start.
pub(super) fn half(rows: &Range<usize>) -> usize {
    rows.start + (rows.len() / 2).next_multiple_of(LEAST)
}

/// A part of some rows, from a column on and negated.
pub(super) fn negated(rows: &[f64], stride: usize, column: usize, [count, width]: [usize; 2]) -> Vec<f64> {
    rows.chunks(stride).take(count).flat_map(|row| row[column..][..width].iter().map(|x| -x)).collect()
}
