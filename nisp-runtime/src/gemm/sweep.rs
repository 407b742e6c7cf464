//! The order of the blocks: a panel of B stays in the nearest cache while all rows of A pass by.

use super::block::{Block, block, most_rows};
use super::{Shape, Task, panel};
use crate::simd::{Element, Kernel, Simd};

/// Longest run of the inner index that is summed in registers. A panel of that many rows, 32 KB, leaves room in a cache
/// of 48 KB for the rows of A that meet it.
pub const RUN: usize = 256;

/// Sweeps over all blocks of a product.
pub(super) struct Sweep<E>(pub(super) Task<E>);

impl<E: Element> Kernel<E> for Sweep<E> {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let task = self.0;
        let Shape { columns, inner, .. } = task.shape;
        let runs = inner.div_ceil(RUN).max(1);
        for run in 0..runs {
            let (from, to) = (inner * run / runs, inner * (run + 1) / runs);
            for column in (0..columns).step_by(panel::<V>()) {
                // SAFETY: whoever made the task vouches for its elements.
                unsafe {
                    if columns - column >= panel::<V>() {
                        sweep_panel::<V, 2>(&task, column, from..to);
                    } else {
                        sweep_panel::<V, 1>(&task, column, from..to);
                    }
                }
            }
        }
    }
}

/// All rows by one panel, for one run of the inner index.
///
/// # Safety
/// The elements of the task must exist.
#[inline(always)]
unsafe fn sweep_panel<V: Simd, const VECTORS: usize>(task: &Task<V::Elem>, column: usize, run: std::ops::Range<usize>) {
    let Shape { rows, inner, .. } = task.shape;
    let (b, b_row) = match task.b_row {
        // SAFETY: inside B.
        Some(stride) => (unsafe { task.b.add(column) }, stride),
        // SAFETY: `column` columns of `inner` elements each lie before this panel.
        None => (unsafe { task.b.add(column * inner) }, VECTORS * V::LANES),
    };
    // Blocks of nearly equal height: no short one at the end that would wait for its own latency.
    let blocks = rows.div_ceil(most_rows::<V>());
    let mut row = 0;
    for i in 0..blocks {
        let height = rows / blocks + usize::from(i < rows % blocks);
        // SAFETY: inside the matrices.
        unsafe {
            let at = Block {
                inner: run.len(),
                a: task.a.add(row * task.a_row + run.start * task.a_column),
                a_row: task.a_row,
                a_column: task.a_column,
                b: b.add(run.start * b_row),
                b_row,
                c: task.c.add(row * task.c_row + column),
                c_row: task.c_row,
                write: if run.start > 0 { task.write.after() } else { task.write },
                summed: task.summed,
            };
            block::<V, VECTORS>(height, at);
        }
        row += height;
    }
}
