//! A tile's way back: from the adjoints of its rows to the gradient.

use super::buffers::Buffers;
use super::heads::{HeadsRowsAdjoint, HeadsWeightsAdjoint};
use super::tile::{Network, Tile};
use crate::kernel::Precision;
use crate::layer::{Gate, GateAdjoint, GatedAdjoint, LayerAdjoint, Shape};
use crate::network::ProductAdjoint;
use crate::residual::Points;
use crate::simd::dispatch;
use crate::wide::subtract;

impl<E: Precision> Network<'_, E> {
    /// From the adjoints of a tile's rows (`buffers.seeds`) to the padded gradient, added to `gradient`: summed over
    /// the points, or one gradient per point, `padded_len` apart.
    pub(crate) fn adjoint(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>, gradient: &mut [E], per_point: bool) {
        let kernel = tile.reading.layers;
        let shape = tile.shape(self.layout);
        let channels = kernel.channels();
        let parts = Parts { count: tile.count, points: shape.points, per_point, distance: self.layout.padded_len };
        self.programs_adjoint(tile, buffers, gradient, parts);
        let rows = shape.points * channels;
        let gated = self.layout.affine.len() > 1;
        if self.layout.hidden.is_empty() || !gated {
            // Without a gate of its own a last layer's adjoint reads all channels; the heads write only those they read.
            buffers.seed[..rows * shape.ld].fill(E::ZERO);
        }
        let heads = HeadsRowsAdjoint {
            shape,
            channels,
            outputs: &tile.reading.outputs,
            weights: self.weights.matrix(&self.layout.head),
            seeds: &buffers.output_bars,
            stride: tile.output_stride(),
            rows_bar: &mut buffers.seed,
        };
        dispatch(self.isa, heads);
        if gated {
            buffers.difference_bar[..rows * shape.ld].fill(E::ZERO);
            buffers.floor_bar[..rows * shape.ld].fill(E::ZERO);
        }
        for l in (0..self.layout.hidden.len()).rev() {
            let last = l + 1 == self.layout.hidden.len();
            let gate = gated.then(|| GateAdjoint {
                gate: Gate { difference: &buffers.lifted[1], floor: &buffers.lifted[2] },
                difference_bar: &mut buffers.difference_bar,
                floor_bar: &mut buffers.floor_bar,
            });
            let layer = LayerAdjoint {
                shape,
                activation: self.layout.architecture.activation,
                argument: &buffers.arguments[l],
                slope: &buffers.hidden_slopes[l],
                seed: &buffers.seed,
                argument_bar: &mut buffers.bar,
                output: &mut buffers.output,
            };
            kernel.layer_adjoint(self.isa, layer, gate, last);
            self.output_used(tile, shape, buffers, gradient, parts, l + 1);
            self.weights.hidden[l].backward(self.isa, rows, shape.ld, &buffers.bar, &mut buffers.seed);
            std::mem::swap(&mut buffers.bar, &mut buffers.next_bar);
        }
        self.first_adjoint(tile, shape, buffers, gradient, parts);
    }

    /// Adjoint of the group's programs and of the map from head channels to jets.
    fn programs_adjoint(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>, gradient: &mut [E], parts: Parts) {
        let reading = tile.reading;
        let stride = tile.stride();
        let points = Points {
            count: tile.count,
            stride,
            jets: &buffers.jets,
            coordinates: &buffers.points,
            columns: &buffers.columns,
            scalars: self.scalars,
            seeds: &buffers.seeds,
        };
        tile.group.programs.adjoint(self.isa, points, &mut buffers.bars);
        let output_stride = tile.output_stride();
        buffers.output_bars[..reading.outputs.len() * output_stride].fill(E::ZERO);
        for (map, bar) in reading.jets.iter().zip(buffers.bars.chunks_exact(stride)) {
            for &(output, factor) in &map.parts {
                let out = &mut buffers.output_bars[output * output_stride + map.site * tile.count..][..tile.count];
                for (out, &bar) in out.iter_mut().zip(bar) {
                    *out += factor * bar;
                }
            }
        }
        let learned = &buffers.bars[reading.jets.len() * stride..];
        for (first, count, at) in (Parts { points: tile.count, ..parts }).ranges() {
            for i in 0..self.layout.learned.len() {
                gradient[at + self.layout.learned_at + i] +=
                    learned[i * stride + first..][..count].iter().copied().sum();
            }
        }
        for (first, count, at) in parts.ranges() {
            for (output, bar) in reading.outputs.iter().zip(buffers.output_bars.chunks_exact(output_stride)) {
                if output.channel == 0 {
                    gradient[at + self.layout.head.padded_bias + output.head] +=
                        bar[first..][..count].iter().copied().sum();
                }
            }
        }
    }

    /// Gradient of whatever multiplies the output of layer `layer` (counted from 0): the next layer's weights, or
    /// the heads. `next_bar` holds the adjoint of the next layer's argument.
    fn output_used(
        &self,
        tile: &Tile<'_, E>,
        shape: Shape,
        buffers: &Buffers<E>,
        gradient: &mut [E],
        parts: Parts,
        layer: usize,
    ) {
        let channels = tile.reading.layers.channels();
        let next = self.layout.hidden.get(layer);
        for (first, count, at) in parts.ranges() {
            let start = first * channels * shape.ld;
            match next {
                None => {
                    let heads = HeadsWeightsAdjoint {
                        shape: Shape { points: count, ..shape },
                        channels,
                        outputs: &tile.reading.outputs,
                        first,
                        rows: &buffers.output,
                        seeds: &buffers.output_bars,
                        stride: tile.output_stride(),
                        weights_bar: &mut gradient[at + self.layout.head.padded..],
                    };
                    dispatch(self.isa, heads);
                }
                Some(matrix) => {
                    let product = ProductAdjoint {
                        shape: Shape { points: count, ..shape },
                        channels,
                        bar: &buffers.next_bar[start..],
                        input: &buffers.output[start..],
                        input_ld: shape.ld,
                    };
                    product.add(self.isa, matrix, &mut gradient[at..]);
                }
            }
        }
    }

    /// The first layer and the gates.
    fn first_adjoint(
        &self,
        tile: &Tile<'_, E>,
        shape: Shape,
        buffers: &mut Buffers<E>,
        gradient: &mut [E],
        parts: Parts,
    ) {
        let kernel = tile.reading.layers;
        let len = shape.points * kernel.channels() * shape.ld;
        let gated = self.layout.affine.len() > 1;
        if gated {
            let gate = GateAdjoint {
                gate: Gate { difference: &buffers.lifted[1], floor: &buffers.lifted[2] },
                difference_bar: &mut buffers.difference_bar,
                floor_bar: &mut buffers.floor_bar,
            };
            let layer = GatedAdjoint {
                shape,
                input: &buffers.lifted[0],
                seed: &buffers.seed,
                gate,
                input_bar: &mut buffers.bar,
                output: &mut buffers.output,
            };
            kernel.gate_adjoint(self.isa, layer);
            // z = d + (c - d) z': c takes the adjoint of the difference, d what is left of its own.
            subtract(&mut buffers.floor_bar[..len], &buffers.difference_bar[..len]);
        } else {
            std::mem::swap(&mut buffers.bar, &mut buffers.seed);
            buffers.output[..len].copy_from_slice(&buffers.lifted[0][..len]);
        }
        self.output_used(tile, shape, buffers, gradient, parts, 0);
        self.lift_adjoint(tile, shape, buffers, gradient, parts);
    }
}

/// How a tile's gradient is split: as a whole, or point by point, a partner's with its point's.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    /// Points of the tile.
    count: usize,
    /// Points of the network, partners after the points.
    points: usize,
    per_point: bool,
    distance: usize,
}

impl Parts {
    /// First point, number of points, and where their gradient begins.
    pub(super) fn ranges(self) -> impl Iterator<Item = (usize, usize, usize)> {
        let size = if self.per_point { 1 } else { self.points };
        (0..self.points).step_by(size).map(move |first| {
            let at = if self.per_point { first % self.count * self.distance } else { 0 };
            (first, size, at)
        })
    }
}
