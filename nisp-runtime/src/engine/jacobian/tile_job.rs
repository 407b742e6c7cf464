//! The rows of a tile, their derivatives, and products with these.

use super::rows_out::RowsOut;
use crate::engine::tile::{Network, Tile};
use crate::engine::{Buffers, covers};
use crate::schema::TermKind;

/// One tile's part of the rows.
pub(super) struct TileJob<'a> {
    pub(super) network: &'a Network<'a, f64>,
    pub(super) tile: Tile<'a, f64>,
    /// First row of each row of the group.
    pub(super) starts: &'a [usize],
    pub(super) theta: &'a [f64],
    pub(super) slopes: &'a [f64],
}

impl TileJob<'_> {
    /// Rows of the group that are evaluated point by point.
    fn pointwise(&self) -> impl Iterator<Item = usize> {
        let terms = &self.tile.group.terms;
        (0..self.tile.group.schema.rows)
            .filter(|&row| terms.iter().any(|t| covers(t, row) && t.schema.kind != TermKind::Integral))
    }

    pub(super) fn write_rows(&self, buffers: &Buffers<f64>, out: RowsOut) {
        for row in self.pointwise() {
            for p in 0..self.tile.count {
                // SAFETY: this tile owns the rows of its points.
                let to = unsafe { out.row(self.starts[row] + self.tile.first + p) };
                to[0] = buffers.rows[row * self.tile.stride() + p];
            }
        }
    }

    pub(super) fn write_jacobian(&self, buffers: &mut Buffers<f64>, gradients: &mut Vec<f64>, out: RowsOut) {
        let stride = self.tile.stride();
        let layout = self.network.layout;
        for row in self.pointwise() {
            buffers.seeds[..self.tile.group.schema.rows * stride].fill(0.0);
            self.seed_row(row, |_| 1.0, buffers);
            gradients.clear();
            gradients.resize(self.tile.count * layout.padded_len, 0.0);
            self.network.adjoint(&self.tile, buffers, gradients, true);
            let term = self.tile.group.terms.iter().find(|term| covers(term, row));
            for (p, gradient) in gradients.chunks_exact_mut(layout.padded_len).enumerate() {
                if let Some(term) = term {
                    term.shrink(buffers.rows[row * stride + p], &mut gradient[layout.learned_at..]);
                }
                for (i, slope) in self.slopes.iter().enumerate() {
                    gradient[layout.learned_at + i] *= slope;
                }
                // SAFETY: this tile owns the rows of its points.
                let row = unsafe { out.row(self.starts[row] + self.tile.first + p) };
                layout.pad_adjoint(self.theta, gradient, row);
            }
        }
    }

    /// Seeds of a product `J^T u`.
    pub(super) fn seed(&self, buffers: &mut Buffers<f64>, u: &[f64]) {
        let stride = self.tile.stride();
        buffers.seeds[..self.tile.group.schema.rows * stride].fill(0.0);
        for row in self.pointwise() {
            self.seed_row(row, |p| u[self.starts[row] + self.tile.first + p], buffers);
        }
    }

    /// What sizes that follow learned scalars add to a product `J^T u`.
    pub(super) fn shrink(&self, buffers: &Buffers<f64>, u: &[f64], gradient: &mut [f64]) {
        let stride = self.tile.stride();
        for row in self.pointwise() {
            let Some(term) = self.tile.group.terms.iter().find(|term| covers(term, row)) else { continue };
            let own = &buffers.rows[row * stride..][..self.tile.count];
            let product = own.iter().enumerate().map(|(p, r)| r * u[self.starts[row] + self.tile.first + p]);
            term.shrink(product.sum(), &mut gradient[self.network.layout.learned_at..]);
        }
    }

    /// Adds to the seeds of the raw rows those of one row as it counts, a seed for each point of the tile.
    fn seed_row(&self, row: usize, u: impl Fn(usize) -> f64, buffers: &mut Buffers<f64>) {
        let stride = self.tile.stride();
        let Buffers { seeds, row_slopes, .. } = buffers;
        let chamfer = self.tile.group.terms.iter().find(|term| term.chamfer.is_some() && covers(term, row));
        if let Some((term, chamfer)) = chamfer.and_then(|term| Some((term, term.chamfer.as_ref()?))) {
            let (points, scale) = (self.tile.first..self.tile.first + self.tile.count, term.scale());
            let seeds = &mut seeds[term.schema.first * stride..];
            chamfer.seed(row - term.schema.first, points, stride, |p| scale * u(p), seeds);
        } else {
            for p in 0..self.tile.count {
                seeds[row * stride + p] += row_slopes[row * stride + p] * u(p);
            }
        }
    }
}
