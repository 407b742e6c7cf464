//! Integral terms: a weighted sum over a group, wanted equal to a target.
//!
//! The misfit must be known before any point's adjoint, so the groups that have such terms are passed through once more,
//! forward only, with all their integrals summed in that one pass.

use rayon::prelude::*;

use super::buffers::Buffers;
use super::group::{BoundGroup, BoundTerm};
use super::tile::{Network, Tile};
use super::{Engine, TileRange, with_buffers};
use crate::kernel::Precision;
use crate::residual::Points;
use crate::schema::TermKind;
use crate::solve::fault::Fault;

/// An integral term's row, and its state between the forward pass and the adjoint.
#[derive(Clone, Debug)]
pub(super) struct Integral {
    pub(super) group: usize,
    pub(super) row: usize,
    pub(super) term: usize,
    /// The integral less its target, weighted.
    pub(super) misfit: f64,
    /// Adjoint of the integral.
    pub(super) seed: f64,
    /// Derivatives of the target by the learned scalars.
    pub(super) target_slopes: Vec<f64>,
}

/// All integrals, with the memory that summing them takes.
pub(super) struct Integrals {
    pub(super) rows: Vec<Integral>,
    /// Parts of every integral, by tile of the groups that have any.
    parts: Vec<(TileRange, Vec<f64>)>,
    scalars: Vec<f64>,
    targets: Vec<f64>,
    /// Derivatives of a group's targets by the learned scalars.
    slopes: Vec<f64>,
}

impl Integrals {
    pub(super) fn new<E: Precision>(groups: &[BoundGroup<E>], scalars: usize, learned: usize) -> Self {
        let mut rows = Vec::new();
        for (group, bound) in groups.iter().enumerate() {
            for (term, t) in bound.terms.iter().enumerate().filter(|(_, t)| t.schema.kind == TermKind::Integral) {
                let target_slopes = vec![0.0; learned];
                rows.extend((t.schema.first..t.schema.first + t.schema.rows).map(|row| Integral {
                    group,
                    row,
                    term,
                    misfit: 0.0,
                    seed: 0.0,
                    target_slopes: target_slopes.clone(),
                }));
            }
        }
        let involved = groups.iter().enumerate().filter(|(at, _)| rows.iter().any(|r| r.group == *at));
        let tiles = involved
            .flat_map(|(at, group)| group.ahead().tiles(group.points).map(move |(first, count)| (at, first, count)));
        let parts = tiles.map(|(group, first, count)| (TileRange { group, first, count }, vec![0.0; rows.len()]));
        let most = groups.iter().map(|g| g.schema.rows).max().unwrap_or(0);
        Self {
            parts: parts.collect(),
            scalars: vec![0.0; scalars],
            targets: vec![0.0; most],
            slopes: vec![0.0; most * learned],
            rows,
        }
    }
}

impl<E: Precision> Engine<E> {
    /// Sums integral terms over their groups, ahead of the pass that needs their misfits.
    pub(super) fn integrate(&mut self) -> Result<(), Fault> {
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let (groups, buffers) = (&self.groups, &self.buffers);
        let Integrals { rows, parts, scalars, targets, .. } = &mut self.integrals;
        let rows_read: &[Integral] = rows;
        parts.par_iter_mut().for_each(|(range, sums)| {
            let tile = Tile::ahead(&groups[range.group], range.first, range.count);
            with_buffers(buffers, |buffers| sum_tile(&network, &tile, range.group, rows_read, buffers, sums));
        });
        scalars.iter_mut().zip(&self.scalars).for_each(|(to, from)| *to = from.to_f64());
        for (at, integral) in rows.iter_mut().enumerate() {
            let group = &groups[integral.group];
            let term = &group.terms[integral.term];
            let sum: f64 =
                parts.iter().filter(|(range, _)| range.group == integral.group).map(|(_, sums)| sums[at]).sum();
            group.programs.target(scalars, targets);
            let scale = term.scale();
            let misfit = (sum - targets[integral.row]) * scale;
            if !misfit.is_finite() {
                return Err(Fault::residual(term.schema.name, None));
            }
            (integral.misfit, integral.seed) = (misfit, misfit * scale);
        }
        Ok(())
    }

    /// Derivatives of all targets by the learned scalars.
    pub(super) fn slope_targets(&mut self) {
        let Integrals { rows, scalars, slopes, .. } = &mut self.integrals;
        scalars.iter_mut().zip(&self.scalars).for_each(|(to, from)| *to = from.to_f64());
        for integral in rows {
            self.groups[integral.group].programs.target_slopes(scalars, slopes);
            let learned = integral.target_slopes.len();
            integral.target_slopes.copy_from_slice(&slopes[integral.row * learned..][..learned]);
        }
    }
}

/// A tile's part of every integral of its group.
fn sum_tile<E: Precision>(
    network: &Network<'_, E>,
    tile: &Tile<'_, E>,
    group: usize,
    integrals: &[Integral],
    buffers: &mut Buffers<E>,
    sums: &mut [f64],
) {
    network.forward(tile, buffers);
    let stride = tile.stride();
    let Buffers { jets, points, columns, rows, .. } = buffers;
    let scalars = network.scalars;
    let inputs = Points { count: tile.count, stride, jets, coordinates: points, columns, scalars, seeds: &[] };
    tile.group.programs.residual(network.isa, inputs, rows);
    for (integral, sum) in integrals.iter().zip(sums).filter(|(integral, _)| integral.group == group) {
        let weights = tile.group.terms[integral.term].point_weights.as_deref();
        let rows = &rows[integral.row * stride..][..tile.count];
        let weight = |p: usize| weights.map_or(1.0, |w| w[tile.first + p].to_f64());
        *sum = rows.iter().enumerate().map(|(p, r)| weight(p) * r.to_f64()).sum();
    }
}

/// Whether a term has this row.
pub(super) fn covers<E>(term: &BoundTerm<E>, row: usize) -> bool {
    (term.schema.first..term.schema.first + term.schema.rows).contains(&row)
}

/// Seeds of integral rows: the integral's adjoint times each point's weight.
pub(super) fn seed_integrals<E: Precision>(
    integrals: &[Integral],
    group: usize,
    tile: &Tile<'_, E>,
    buffers: &mut Buffers<E>,
) {
    let stride = tile.stride();
    for integral in integrals.iter().filter(|i| i.group == group) {
        let weights = tile.group.terms[integral.term].point_weights.as_deref();
        let seeds = &mut buffers.seeds[integral.row * stride..][..stride];
        for (p, seed) in seeds[..tile.count].iter_mut().enumerate() {
            *seed = E::from_f64(integral.seed) * weights.map_or(E::ONE, |w| w[tile.first + p]);
        }
        seeds[tile.count..].fill(E::ZERO);
    }
}
