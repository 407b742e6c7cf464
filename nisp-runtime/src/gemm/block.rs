//! The innermost loops: a block of C held in registers while the inner index runs.

use super::Write;
use crate::simd::Simd;

/// Where a block lives and how to step through it. Distances are in elements.
pub(super) struct Block<E> {
    pub(super) inner: usize,
    pub(super) a: *const E,
    pub(super) a_row: usize,
    pub(super) a_column: usize,
    pub(super) b: *const E,
    pub(super) b_row: usize,
    pub(super) c: *mut E,
    pub(super) c_row: usize,
    pub(super) write: Write,
    /// Products that are summed before their sum goes to C.
    pub(super) summed: usize,
}

/// Most rows of a block: with two vectors a row, two for B and one for A, all registers are in use.
pub(super) const fn most_rows<V: Simd>() -> usize {
    if V::REGISTERS >= 32 { 14 } else { 6 }
}

/// Does a block of `rows` (1 to [`most_rows`]) rows and `VECTORS` vectors.
///
/// # Safety
/// All elements of the block must exist, those of C exclusively.
#[inline(always)]
pub(super) unsafe fn block<V: Simd, const VECTORS: usize>(rows: usize, at: Block<V::Elem>) {
    macro_rules! choose {
        ($($height:literal)*) => {
            match rows {
                // SAFETY: the caller vouches for the block.
                $($height if $height <= most_rows::<V>() => unsafe { with_rows::<V, $height, VECTORS>(at) },)*
                _ => unreachable!("a block has 1 to {} rows, not {rows}", most_rows::<V>()),
            }
        };
    }
    choose!(1 2 3 4 5 6 7 8 9 10 11 12 13 14);
}

/// Gives the compiler the stride that it can turn into constant offsets.
///
/// # Safety
/// As for [`block`].
#[inline(always)]
unsafe fn with_rows<V: Simd, const ROWS: usize, const VECTORS: usize>(at: Block<V::Elem>) {
    // SAFETY: the caller vouches for the block.
    unsafe {
        if at.a_row == 1 {
            accumulate::<V, ROWS, VECTORS>(Block { a_row: 1, ..at });
        } else {
            accumulate::<V, ROWS, VECTORS>(at);
        }
    }
}

/// # Safety
/// As for [`block`].
#[inline(always)]
unsafe fn accumulate<V: Simd, const ROWS: usize, const VECTORS: usize>(at: Block<V::Elem>) {
    let (mut a, mut b) = (at.a, at.b);
    let (mut left, mut write) = (at.inner, at.write);
    loop {
        let count = left.min(at.summed);
        let mut sums = [[V::lit(0.0); VECTORS]; ROWS];
        for _ in 0..count {
            // SAFETY: the caller vouches for `inner` columns of A and rows of B; the pointers may go one step past them,
            // but are not read there.
            unsafe {
                let mut right = [V::lit(0.0); VECTORS];
                for (v, right) in right.iter_mut().enumerate() {
                    *right = V::load(b.add(v * V::LANES));
                }
                for (i, sums) in sums.iter_mut().enumerate() {
                    let left = V::splat(*a.add(i * at.a_row));
                    for (sum, right) in sums.iter_mut().zip(right) {
                        *sum = left.mul_add(right, *sum);
                    }
                }
                a = a.wrapping_add(at.a_column);
                b = b.wrapping_add(at.b_row);
            }
        }
        // SAFETY: the caller vouches for these rows and vectors of C.
        unsafe {
            match write {
                Write::Set | Write::SetFromShortSums => put(&sums, at.c, at.c_row, |_, sum| sum),
                Write::Add => put(&sums, at.c, at.c_row, |c, sum| V::load(c).add(sum)),
                Write::Subtract => put(&sums, at.c, at.c_row, |c, sum| V::load(c).sub(sum)),
            }
        }
        (left, write) = (left - count, write.after());
        if left == 0 {
            break;
        }
    }
}

/// Joins sums to what stands in C. A choice inside of these loops keeps compilers from unrolling them, and then the sums stay in memory
/// instead of registers: products take twice as long.
///
/// # Safety
/// As for [`block`].
#[inline(always)]
unsafe fn put<V: Simd, const ROWS: usize, const VECTORS: usize>(
    sums: &[[V; VECTORS]; ROWS],
    c: *mut V::Elem,
    c_row: usize,
    join: impl Fn(*mut V::Elem, V) -> V,
) {
    for (i, sums) in sums.iter().enumerate() {
        for (v, &sum) in sums.iter().enumerate() {
            // SAFETY: the caller vouches for these rows and vectors of C.
            unsafe {
                let c = c.add(i * c_row + v * V::LANES);
                join(c, sum).store(c);
            }
        }
    }
}
