//! Forward passes without gradient: network outputs at points, magnitudes of rows.

use rayon::prelude::*;

use super::buffers::Buffers;
use super::tile::{Network, Tile};
use super::{Chamfer, Engine, with_buffers};
use crate::kernel::Precision;
use crate::residual::Points;
use crate::schema::TermKind;

impl<E: Precision> Engine<E> {
    /// Runs `work` on every tile of a group, in order, with the raw rows of its residuals.
    pub(super) fn each_tile(&self, group: usize, mut work: impl FnMut(&Tile<'_, E>, &Buffers<E>)) {
        let bound = &self.groups[group];
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        with_buffers(&self.buffers, |buffers| {
            for (first, count) in bound.tiles() {
                let tile = Tile::new(bound, first, count);
                residuals(&network, &tile, buffers);
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

    /// How far the points of a term are off at `theta`, in the engine's units: of a cloud as last assigned, by coordinate or
    /// across the surface.
    pub(crate) fn misfits(&mut self, group: usize, term: usize, theta: &[E]) -> Vec<f64> {
        let bound = &self.groups[group].terms[term];
        if let Some(chamfer) = bound.chamfer.as_ref().filter(|chamfer| chamfer.is_assigned()) {
            return chamfer.misfits();
        }
        let (points, schema) = (self.groups[group].points, bound.schema);
        let is_lacking = bound.point_weights.is_some() && schema.kind == TermKind::Observation;
        let measured = bound.point_weights.clone().filter(|_| is_lacking);
        let rows = &self.raw_rows(group, theta)[schema.first * points..(schema.first + schema.rows) * points];
        match measured {
            None => rows.to_vec(),
            Some(weights) => {
                let with = rows.iter().zip(weights.iter().cycle());
                with.filter(|(_, weight)| **weight != E::ZERO).map(|(row, _)| *row).collect()
            }
        }
    }

    /// Clouds of Chamfer terms.
    pub(super) fn chamfers(&self) -> impl Iterator<Item = &Chamfer<E>> {
        self.groups.iter().flat_map(|group| &group.terms).filter_map(|term| term.chamfer.as_ref())
    }

    /// Assigns every cloud to the surface that the present parameters predict. Returns true if rows have changed.
    pub(super) fn assign(&mut self) -> bool {
        let mut changed = false;
        for group in 0..self.groups.len() {
            for term in 0..self.groups[group].terms.len() {
                let Some(mut chamfer) = self.groups[group].terms[term].chamfer.take() else { continue };
                self.predict_surface(group, term, chamfer.surface());
                let term = &mut self.groups[group].terms[term];
                changed |= chamfer.assign(term.size);
                term.chamfer = Some(chamfer);
            }
        }
        self.is_assigned = true;
        changed
    }

    /// Raw rows of a term, point by point.
    fn predict_surface(&self, group: usize, term: usize, surface: &mut [f64]) {
        let bound = &self.groups[group];
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let schema = bound.terms[term].schema;
        let points = bound.ahead().tile;
        surface.par_chunks_mut(points * schema.rows).enumerate().for_each(|(at, out)| {
            let tile = Tile::ahead(bound, at * points, out.len() / schema.rows);
            with_buffers(&self.buffers, |buffers| {
                residuals(&network, &tile, buffers);
                for (p, point) in out.chunks_exact_mut(schema.rows).enumerate() {
                    for (i, x) in point.iter_mut().enumerate() {
                        *x = buffers.rows[(schema.first + i) * tile.stride() + p].to_f64();
                    }
                }
            });
        });
    }
}

/// A tile forward to the raw rows of its residuals.
fn residuals<E: Precision>(network: &Network<'_, E>, tile: &Tile<'_, E>, buffers: &mut Buffers<E>) {
    network.forward(tile, buffers);
    let Buffers { jets, points, columns, rows, .. } = buffers;
    let inputs = Points {
        count: tile.count,
        stride: tile.stride(),
        jets,
        coordinates: points,
        columns,
        scalars: network.scalars,
        seeds: &[],
    };
    tile.group.programs.residual(network.isa, inputs, rows);
}
