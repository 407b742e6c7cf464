//! Forward passes without gradient: network outputs at points, magnitudes of rows.

use super::tile::{Buffers, Network, Tile};
use super::{Engine, with_buffers};
use crate::real::Real;
use crate::residual::Points;

impl<E: Real> Engine<E> {
    /// Runs `work` on every tile of a group, in order, with the raw rows of its residuals.
    pub(super) fn each_tile(&self, group: usize, mut work: impl FnMut(&Tile<'_, E>, &Buffers<E>)) {
        let bound = &self.groups[group];
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        with_buffers(&self.buffers, |buffers| {
            for (first, count) in bound.tiles() {
                let tile = Tile { group: bound, first, count };
                network.forward(&tile, buffers);
                let Buffers { jets, points, columns, rows, .. } = buffers;
                let inputs = Points {
                    count: tile.count,
                    stride: tile.stride(),
                    jets,
                    coordinates: points,
                    columns,
                    scalars: &self.scalars,
                    seeds: &[],
                };
                bound.kernel.residual(self.isa, inputs, rows);
                work(&tile, buffers);
            }
        });
    }

    /// Raw rows of a group at `theta`, `[row][point]`: neither divided by their natural size nor weighted, in the
    /// engine's units.
    pub fn raw_rows(&mut self, group: usize, theta: &[E]) -> Vec<f64> {
        self.set(theta);
        let bound = &self.groups[group];
        let mut all = vec![0.0; bound.schema.rows * bound.points];
        self.each_tile(group, |tile, buffers| {
            for row in 0..tile.group.schema.rows {
                for p in 0..tile.count {
                    all[row * tile.group.points + tile.first + p] = buffers.rows[row * tile.stride() + p].to_f64();
                }
            }
        });
        all
    }
}
