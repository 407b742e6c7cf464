//! Blocks on the diagonal of a Cholesky factor, row by row: what is too small or too dependent for products of matrices.

use crate::simd::{Kernel, Simd};

/// Rows that are eliminated one by one, before those that are below them in a panel are.
pub(super) const BLOCK: usize = 32;

/// The factor of a block on the diagonal, in place, and a copy of it.
pub(super) struct Diagonal<'a> {
    pub(super) rows: &'a mut [f64],
    pub(super) stride: usize,
    pub(super) count: usize,
    pub(super) block: &'a mut [f64; BLOCK * BLOCK],
}

impl Kernel<f64> for Diagonal<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(self) -> bool {
        let Self { rows, stride, count, block } = self;
        for k in 0..count {
            let end = rows.len().min((k + 1) * stride);
            let (upper, below) = rows.split_at_mut(end);
            let row = &mut upper[k * stride..][..count];
            let pivot = row[k];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let root = pivot.sqrt();
            row[k..].iter_mut().for_each(|x| *x /= root);
            for (i, other) in below.chunks_mut(stride).take(count - k - 1).enumerate() {
                subtract(&mut other[k + 1 + i..count], row[k + 1 + i], &row[k + 1 + i..]);
            }
        }
        for (to, from) in block.chunks_exact_mut(BLOCK).zip(rows.chunks(stride)).take(count) {
            to[..count].copy_from_slice(&from[..count]);
        }
        true
    }
}

/// Solves with a block on the diagonal, or with its transpose, for right-hand sides in rows as far apart as given.
pub(super) struct Substitution<'a> {
    pub(super) rows: &'a [f64],
    pub(super) stride: usize,
    pub(super) count: usize,
    pub(super) x: &'a mut [f64],
    pub(super) apart: usize,
    pub(super) sides: usize,
    pub(super) transposed: bool,
}

/// Right-hand sides that stay in the nearest cache.
const NEAR: usize = 256;

impl Kernel<f64> for Substitution<'_> {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(self) {
        let Self { rows, stride, count, x, apart, sides, transposed } = self;
        for from in (0..sides).step_by(NEAR) {
            let near = NEAR.min(sides - from);
            for step in 0..count {
                let k = if transposed { step } else { count - 1 - step };
                let row = &rows[k * (stride + 1)..][..count - k];
                let (own, after) = x[k * apart + from..].split_at_mut(near);
                let others = row.iter().enumerate().skip(1);
                if transposed {
                    own.iter_mut().for_each(|x| *x /= row[0]);
                    others.for_each(|(i, factor)| subtract(&mut after[i * apart - near..][..near], *factor, own));
                } else {
                    others.for_each(|(i, factor)| subtract(own, *factor, &after[i * apart - near..][..near]));
                    own.iter_mut().for_each(|x| *x /= row[0]);
                }
            }
        }
    }
}

/// Subtracts a multiple.
#[inline(always)]
fn subtract(from: &mut [f64], factor: f64, what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(from, what)| *from -= factor * what);
}
