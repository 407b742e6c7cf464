//! Products of rows' slopes, summed up.

use rayon::prelude::*;

use super::Normal;
use crate::local::block::Block;
use crate::local::sorted::{Products, Sorted};
use crate::simd::Isa;

/// Pieces that the matrix is summed up in, at the same time: a fixed number, many enough for all threads.
const PIECES: usize = 32;

impl Normal {
    /// Adds the products of the rows' slopes with each other, and with what is on the right and in the border, piece by piece of the
    /// matrix: every entry is summed up in the order of the blocks.
    pub(super) fn add_products(&mut self, blocks: &[Sorted]) {
        let (starts, indices) = (self.pattern.starts(), self.pattern.rows());
        let columns = self.gradient.len();
        let mut pieces = Vec::new();
        let (mut rest, mut first) = (self.values.as_mut_slice(), 0);
        let mut beside: Vec<&mut [f64]> = vec![&mut self.gradient];
        beside.extend(self.border.iter_mut().take(self.learned).map(Vec::as_mut_slice));
        for piece in 1..=PIECES {
            let end = starts.partition_point(|&start| start < indices.len() * piece / PIECES).min(columns);
            let (own, others) = rest.split_at_mut(starts[end] - starts[first]);
            let sums: Vec<&mut [f64]> =
                beside.iter_mut().map(|rest| rest.split_off_mut(..end - first).unwrap_or_default()).collect();
            pieces.push((first..end, own, sums));
            (rest, first) = (others, end);
        }
        let isa = Isa::detect();
        pieces.into_par_iter().for_each(|(columns, values, mut sums)| {
            let origin = starts[columns.start];
            let mut products = Products::default();
            for block in blocks {
                let first_from = |column: usize| block.dofs.partition_point(|&dof| (dof as usize) < column);
                let own = first_from(columns.start)..first_from(columns.end);
                if own.is_empty() {
                    continue;
                }
                block.products(isa, own.clone(), &mut products);
                for at in own {
                    let column = block.dofs[at] as usize;
                    let sums = sums.iter_mut().map(|sum| &mut sum[column - columns.start]);
                    block.add_beside(at, &products, sums);
                    let range = starts[column]..starts[column + 1];
                    let values = &mut values[range.start - origin..range.end - origin];
                    block.scatter(at, &mut products, &indices[range], values);
                }
            }
        });
    }

    /// Adds what rows say of the learned scalars alone.
    pub(super) fn add_corner(&mut self, block: &Block) {
        for (row, misfit) in block.misfits.iter().enumerate() {
            let by = &block.by_learned[row * self.learned..(row + 1) * self.learned];
            for (i, a) in by.iter().enumerate() {
                self.border_gradient[i] += a * misfit;
                for (j, b) in by.iter().enumerate() {
                    self.corner[(i, j)] += a * b;
                }
            }
        }
    }
}
