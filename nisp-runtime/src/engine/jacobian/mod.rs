//! Rows, Jacobian rows and products with them: what second-order methods ask of the engine.
//!
//! Rows are ordered by group, term, row of the term, point. A Jacobian row is one adjoint pass of its tile, whose
//! weight gradients are formed point by point instead of being summed.

mod rows_out;
mod tile_job;

use rayon::prelude::*;

use super::tile::{Network, Tile};
use super::{Engine, Integral, TileRange, add_up, weigh, with_buffers};
use crate::schema::TermKind;
use crate::solve::fault::Fault;
use crate::solve::vector;
use rows_out::RowsOut;
use tile_job::TileJob;

impl Engine<f64> {
    /// Number of rows of all terms.
    pub(crate) fn row_count(&self) -> usize {
        self.row_starts().last().map_or(0, |&(_, _, end)| end)
    }

    /// For every term, in order of groups: group, first row, and the row after the last.
    pub(crate) fn row_starts(&self) -> Vec<(usize, usize, usize)> {
        let mut next = 0;
        let mut starts = Vec::new();
        for (at, group) in self.groups.iter().enumerate() {
            for term in &group.terms {
                let first = next;
                next += term.row_count(group.points);
                starts.push((at, first, next));
            }
        }
        starts
    }

    /// First row of every group's row, by group and row within a point.
    fn starts_by_group(&self) -> Vec<Vec<usize>> {
        let mut next = 0;
        self.groups
            .iter()
            .map(|group| {
                let mut starts = vec![0; group.schema.rows];
                for term in &group.terms {
                    let points = if term.schema.kind == TermKind::Integral { 1 } else { group.points };
                    for start in &mut starts[term.schema.first..][..term.schema.rows] {
                        *start = next;
                        next += points;
                    }
                    next += usize::from(term.chamfer.is_some());
                }
                starts
            })
            .collect()
    }

    /// Overwrites `r` with all rows, and gives half the sum of their squares.
    pub(crate) fn weighted_rows(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        self.rows_and_jacobian(theta, r, None)
    }

    /// Overwrites `r` with all rows and `j` with their derivatives (row-major).
    pub(crate) fn jacobian_rows(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        self.rows_and_jacobian(theta, r, Some(j))
    }

    fn rows_and_jacobian(&mut self, theta: &[f64], r: &mut [f64], j: Option<&mut [f64]>) -> Result<f64, Fault> {
        self.set(theta);
        self.integrate()?;
        let starts = self.starts_by_group();
        let rows = RowsOut::new(r, 1);
        let jacobian = j.map(|j| RowsOut::new(j, self.layout.len));
        let slopes: Vec<f64> = self.learned_slopes(theta);
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let (groups, buffers) = (&self.groups, &self.buffers);
        self.chunks.par_iter_mut().for_each(|chunk| {
            chunk.fault = None;
            with_buffers(buffers, |buffers| {
                let mut gradients = Vec::new();
                let mut shares = vec![0.0; chunk.shares.len()];
                for &TileRange { group, first, count } in &chunk.tiles {
                    let tile = Tile::new(&groups[group], first, count);
                    network.forward(&tile, buffers);
                    let terms = tile.group.terms.len();
                    if let Some((term, point)) = weigh(&network, &tile, buffers, &mut shares[..terms]) {
                        let before: usize = groups[..group].iter().map(|g| g.terms.len()).sum();
                        chunk.fault.get_or_insert((before + term, point));
                    }
                    let job = TileJob { network: &network, tile, starts: &starts[group], theta, slopes: &slopes };
                    job.write_rows(buffers, rows);
                    if let Some(jacobian) = jacobian {
                        job.write_jacobian(buffers, &mut gradients, jacobian);
                    }
                }
            });
        });
        if let Some((term, point)) = self.chunks.iter().find_map(|chunk| chunk.fault) {
            return Err(Fault::residual(self.term_name(term), Some(point)));
        }
        self.slope_targets();
        for integral in &self.integrals.rows {
            // SAFETY: the parallel section is over; this thread is alone.
            unsafe {
                rows.row(starts[integral.group][integral.row])[0] = integral.misfit;
                if let Some(jacobian) = jacobian {
                    self.integral_jacobian(integral, theta, jacobian.row(starts[integral.group][integral.row]));
                }
            }
        }
        self.scatter_rows(rows, jacobian);
        let loss = r.iter().map(|x| x * x).sum::<f64>() / 2.0;
        if loss.is_finite() { Ok(loss) } else { Err(Fault::residual("loss", None)) }
    }

    /// The last row of every Chamfer term, which depends on nothing.
    fn scatter_rows(&self, rows: RowsOut, jacobian: Option<RowsOut>) {
        let terms = self.groups.iter().flat_map(|group| &group.terms);
        for ((_, _, end), term) in self.row_starts().into_iter().zip(terms).filter(|(_, term)| term.chamfer.is_some()) {
            // SAFETY: called after the parallel section; this thread is alone.
            unsafe {
                rows.row(end - 1)[0] = term.scatter();
                if let Some(jacobian) = jacobian {
                    jacobian.row(end - 1).fill(0.0);
                }
            }
        }
    }

    fn learned_slopes(&self, theta: &[f64]) -> Vec<f64> {
        let learned = &theta[self.layout.learned.clone()];
        self.learned.iter().zip(learned).map(|(learned, &theta)| learned.map.at(theta).1).collect()
    }

    /// The derivative of an integral term's row, by one summed adjoint over its group and, for what the target depends
    /// on, by its slopes.
    fn integral_jacobian(&self, integral: &Integral, theta: &[f64], out: &mut [f64]) {
        let group = &self.groups[integral.group];
        let term = &group.terms[integral.term];
        let scale = term.scale();
        let mut gradient = vec![0.0; self.layout.padded_len];
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        with_buffers(&self.buffers, |buffers| {
            for (first, count) in group.tiles() {
                let tile = Tile::new(group, first, count);
                network.forward(&tile, buffers);
                let stride = tile.stride();
                buffers.seeds[..group.schema.rows * stride].fill(0.0);
                for p in 0..tile.count {
                    let weight = term.point_weights.as_ref().map_or(1.0, |w| w[first + p]);
                    buffers.seeds[integral.row * stride + p] = scale * weight;
                }
                network.adjoint(&tile, buffers, &mut gradient, false);
            }
        });
        term.shrink(integral.misfit, &mut gradient[self.layout.learned_at..]);
        for (i, (slope, by_target)) in self.learned_slopes(theta).iter().zip(&integral.target_slopes).enumerate() {
            let at = self.layout.learned_at + i;
            gradient[at] = (gradient[at] - scale * by_target) * slope;
        }
        self.layout.pad_adjoint(theta, &gradient, out);
    }

    /// `out = J^T u` at `theta`.
    pub(crate) fn transposed_product(&mut self, theta: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.set(theta);
        self.integrate()?;
        let starts = self.starts_by_group();
        let slopes = self.learned_slopes(theta);
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let (groups, buffers) = (&self.groups, &self.buffers);
        add_up(&mut self.chunks, &|chunk| {
            chunk.gradient.fill(0.0);
            with_buffers(buffers, |buffers| {
                for &TileRange { group, first, count } in &chunk.tiles {
                    let tile = Tile::new(&groups[group], first, count);
                    network.forward(&tile, buffers);
                    let terms = tile.group.terms.len();
                    weigh(&network, &tile, buffers, &mut chunk.shares[..terms]);
                    let job = TileJob { network: &network, tile, starts: &starts[group], theta, slopes: &slopes };
                    job.seed(buffers, u);
                    network.adjoint(&tile, buffers, &mut chunk.gradient, false);
                    job.shrink(buffers, u, &mut chunk.gradient);
                }
            });
        });
        let total = &mut self.chunks[0].gradient;
        for (i, slope) in slopes.iter().enumerate() {
            total[self.layout.learned_at + i] *= slope;
        }
        self.layout.pad_adjoint(theta, total, out);
        self.slope_targets();
        let mut row = vec![0.0; self.layout.len];
        for integral in &self.integrals.rows {
            self.integral_jacobian(integral, theta, &mut row);
            let weight = u[starts[integral.group][integral.row]];
            out.iter_mut().zip(&row).for_each(|(out, row)| *out += weight * row);
        }
        if vector::all_finite(out) { Ok(()) } else { Err(Fault::gradient("gradient", None)) }
    }
}
