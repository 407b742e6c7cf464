//! From a tile's rows to their shares of the loss and the seeds of the adjoint.

use super::buffers::Buffers;
use super::group::BoundTerm;
use super::tile::{Network, Tile};
use crate::kernel::Precision;
use crate::residual::Points;
use crate::schema::TermKind;

/// Rows of a tile, their shares of the loss, and the seeds of the adjoint. Gives the first row that is not finite.
pub(super) fn weigh<E: Precision>(
    network: &Network<'_, E>,
    tile: &Tile<'_, E>,
    buffers: &mut Buffers<E>,
    shares: &mut [f64],
) -> Option<(usize, usize)> {
    let stride = tile.stride();
    let Buffers { jets, points, columns, rows, seeds, row_slopes, .. } = buffers;
    let inputs =
        Points { count: tile.count, stride, jets, coordinates: points, columns, scalars: network.scalars, seeds: &[] };
    tile.group.programs.residual(network.isa, inputs, rows);
    let mut fault = None;
    for ((index, term), share) in tile.group.terms.iter().enumerate().zip(shares) {
        if term.schema.kind == TermKind::Integral {
            continue;
        }
        let mut judge = |sum: f64, values: &[E]| {
            *share += sum;
            if !sum.is_finite() && fault.is_none() {
                let point = (0..tile.count).find(|p| values[*p..].iter().step_by(stride).any(|x| !x.is_finite()));
                fault = Some((index, tile.first + point.unwrap_or(0)));
            }
        };
        if let Some(chamfer) = &term.chamfer {
            let (at, len) = (term.schema.first * stride, term.schema.rows * stride);
            let (values, seeds) = (&mut rows[at..][..len], &mut seeds[at..][..len]);
            let points = tile.first..tile.first + tile.count;
            let scale = E::from_f64(term.scale());
            let sum = chamfer.weigh(points.clone(), stride, scale, values);
            seeds.fill(E::ZERO);
            for (i, row) in values.chunks_exact(stride).enumerate() {
                chamfer.seed(i, points.clone(), stride, |p| row[p] * scale, seeds);
            }
            judge(sum, values);
            continue;
        }
        for row in term.schema.first..term.schema.first + term.schema.rows {
            let values = &mut rows[row * stride..][..stride];
            let (seeds, slopes) = (&mut seeds[row * stride..][..stride], &mut row_slopes[row * stride..][..stride]);
            let sum = term.weigh(tile.first, tile.count, values, seeds, slopes);
            judge(sum, values);
        }
    }
    fault
}

impl<E: Precision> BoundTerm<E> {
    /// Replaces the raw rows of a tile by what counts, and gives half the sum of their squares.
    fn weigh(&self, first: usize, count: usize, values: &mut [E], seeds: &mut [E], slopes: &mut [E]) -> f64 {
        let mut sum = 0.0;
        for p in 0..count {
            let weight = self.point_weights.as_ref().map_or(E::ONE, |w| w[first + p]);
            let (value, slope) = self.row(values[p], weight);
            values[p] = value;
            slopes[p] = slope;
            seeds[p] = value * slope;
            let value = value.to_f64();
            sum += value * value;
        }
        seeds[count..].fill(E::ZERO);
        sum / 2.0
    }
}
