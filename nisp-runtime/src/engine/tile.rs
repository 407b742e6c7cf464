//! One tile of points through the network and back.
//!
//! A tile is so small that its channels stay in the second-level cache from the coordinates to the gradient.

use super::group::BoundGroup;
use super::heads::{Heads, HeadsRowsAdjoint, HeadsWeightsAdjoint};
use super::reading::Reading;
use crate::aligned::AlignedVec;
use crate::layer::{Gate, GateAdjoint, Gated, GatedAdjoint, Layer, LayerAdjoint, Shape, row_distance};
use crate::network::{Layout, ProductAdjoint, Weights};
use crate::real::Real;
use crate::residual::Points;
use crate::simd::{Isa, dispatch};
use crate::wide::subtract;

/// Points of a tile are padded to a multiple of this, so that every vector length divides it.
pub(crate) const POINT_LANES: usize = 16;

/// Scratch of one worker, large enough for a tile of any group.
pub(crate) struct Buffers<E: Real> {
    pub(super) coordinates: AlignedVec<E>,
    /// Channels of the features of the coordinates, if there are any.
    pub(super) features: AlignedVec<E>,
    /// `tanh` of the first layer and the gates (on features of the coordinates, their arguments), and its slope.
    pub(super) values: Vec<AlignedVec<E>>,
    pub(super) slopes: Vec<AlignedVec<E>>,
    /// Channels of the first layer, of `c - d`, and of `d`.
    pub(super) lifted: Vec<AlignedVec<E>>,
    arguments: Vec<AlignedVec<E>>,
    hidden_slopes: Vec<AlignedVec<E>>,
    pub(super) output: AlignedVec<E>,
    seed: AlignedVec<E>,
    pub(super) bar: AlignedVec<E>,
    pub(super) next_bar: AlignedVec<E>,
    pub(super) difference_bar: AlignedVec<E>,
    pub(super) floor_bar: AlignedVec<E>,
    pub(crate) outputs: AlignedVec<E>,
    pub(crate) jets: AlignedVec<E>,
    pub(crate) points: AlignedVec<E>,
    pub(crate) columns: AlignedVec<E>,
    pub(crate) rows: AlignedVec<E>,
    pub(crate) seeds: AlignedVec<E>,
    pub(crate) bars: AlignedVec<E>,
    output_bars: AlignedVec<E>,
    pub(crate) row_slopes: AlignedVec<E>,
}

/// Largest sizes that a set of groups asks of [`Buffers`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extent {
    /// Points of the network in a tile.
    points: usize,
    rows: usize,
    sites: usize,
    outputs: usize,
    jets: usize,
    columns: usize,
    residuals: usize,
}

impl Extent {
    pub(crate) fn of<'a, E: Real>(groups: impl Iterator<Item = &'a BoundGroup<E>>) -> Self {
        groups.fold(Self::default(), |extent, group| {
            let tiles = [&group.reading, group.ahead()].map(|reading| (reading.tile * group.sites(), reading));
            Self {
                points: tiles.iter().map(|(points, _)| *points).fold(extent.points, usize::max),
                rows: tiles.iter().map(|(points, r)| points * r.layers.channels()).fold(extent.rows, usize::max),
                sites: extent.sites.max(group.sites()),
                outputs: extent.outputs.max(group.reading.outputs.len()),
                jets: extent.jets.max(group.schema.jets.len()),
                columns: extent.columns.max(group.schema.columns.len()),
                residuals: extent.residuals.max(group.schema.rows),
            }
        })
    }
}

impl<E: Real> Buffers<E> {
    pub(crate) fn new(layout: &Layout, extent: Extent) -> Self {
        let ld = row_distance(layout.width);
        let stride = extent.points.next_multiple_of(POINT_LANES);
        let rows = || AlignedVec::zeros(extent.rows * ld);
        let values = || AlignedVec::zeros(extent.points * ld);
        let quantities = |count: usize| AlignedVec::zeros(count * stride);
        let features = if layout.is_mapped() { extent.rows * row_distance(layout.affine[0].padded_row) } else { 0 };
        Self {
            coordinates: AlignedVec::zeros(extent.points * layout.inputs),
            features: AlignedVec::zeros(features),
            values: layout.affine.iter().map(|_| if features == 0 { values() } else { rows() }).collect(),
            slopes: layout.affine.iter().map(|_| values()).collect(),
            lifted: layout.affine.iter().map(|_| rows()).collect(),
            arguments: layout.hidden.iter().map(|_| rows()).collect(),
            hidden_slopes: layout.hidden.iter().map(|_| values()).collect(),
            output: rows(),
            seed: rows(),
            bar: rows(),
            next_bar: rows(),
            difference_bar: rows(),
            floor_bar: rows(),
            outputs: quantities(extent.outputs),
            jets: quantities(extent.jets),
            points: quantities(layout.inputs * extent.sites),
            columns: quantities(extent.columns),
            rows: quantities(extent.residuals),
            seeds: quantities(extent.residuals),
            bars: quantities(extent.jets + layout.learned.len()),
            output_bars: quantities(extent.outputs),
            row_slopes: quantities(extent.residuals),
        }
    }
}

/// The network as a tile sees it.
#[derive(Clone, Copy)]
pub(crate) struct Network<'a, E: Real> {
    pub(crate) isa: Isa,
    pub(crate) layout: &'a Layout,
    pub(crate) weights: &'a Weights<E>,
    pub(crate) scalars: &'a [E],
}

/// A tile: `count` points of a group from `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Tile<'a, E: Real> {
    pub(crate) group: &'a BoundGroup<E>,
    pub(crate) reading: &'a Reading<E>,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl<'a, E: Real> Tile<'a, E> {
    /// A tile of which all is read that its group's programs read.
    pub(crate) fn new(group: &'a BoundGroup<E>, first: usize, count: usize) -> Self {
        Self { group, reading: &group.reading, first, count }
    }

    /// A tile of which is read what has to be known ahead of a step's pass.
    pub(crate) fn ahead(group: &'a BoundGroup<E>, first: usize, count: usize) -> Self {
        Self { group, reading: group.ahead(), first, count }
    }

    fn shape(&self, layout: &Layout) -> Shape {
        Shape { points: self.count * self.group.sites(), width: layout.width, ld: row_distance(layout.width) }
    }

    /// Distance between quantities of the network's points: the tile's own, then their partners.
    fn output_stride(&self) -> usize {
        (self.count * self.group.sites()).next_multiple_of(POINT_LANES)
    }

    /// Distance between per-point quantities.
    pub(crate) fn stride(&self) -> usize {
        self.count.next_multiple_of(POINT_LANES)
    }
}

impl<E: Real> Network<'_, E> {
    /// From the points of a tile to the jets that its group reads.
    pub(crate) fn forward(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>) {
        self.load(tile, buffers);
        let shape = tile.shape(self.layout);
        let kernel = tile.reading.layers;
        self.lift(tile, shape, buffers);
        let rows = shape.points * kernel.channels();
        let (first, gates) = split_gates(&mut buffers.lifted, rows * shape.ld);
        let layers = self.layout.architecture.layers;
        match gates {
            Some(gate) => {
                kernel.gate(self.isa, Gated { shape, input: first, gate, output: &mut buffers.output });
            }
            None => buffers.output[..first.len()].copy_from_slice(first),
        }
        for (l, matrix) in self.layout.hidden.iter().enumerate() {
            let argument = &mut buffers.arguments[l];
            self.weights.hidden[l].forward(self.isa, rows, shape.ld, &buffers.output, argument);
            let layer = Layer {
                shape,
                argument,
                bias: self.weights.bias(matrix),
                slope: &mut buffers.hidden_slopes[l],
                output: &mut buffers.output,
            };
            kernel.layer(self.isa, layer, gates, l + 2 == layers);
        }
        self.heads(tile, shape, buffers);
    }

    /// Copies a tile's points and data; lanes past the last point repeat it, so that programs stay finite there.
    fn load(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>) {
        let group = tile.group;
        let inputs = self.layout.inputs;
        let len = tile.count * inputs;
        for (site, to) in buffers.coordinates.chunks_exact_mut(len).take(group.sites()).enumerate() {
            to.copy_from_slice(&group.network[(site * group.points + tile.first) * inputs..][..len]);
        }
        for (from, to) in [(&group.coordinates, &mut buffers.points), (&group.columns, &mut buffers.columns)] {
            for (from, to) in from.chunks_exact(group.points).zip(to.chunks_exact_mut(tile.stride())) {
                let values = &from[tile.first..][..tile.count];
                to[..tile.count].copy_from_slice(values);
                to[tile.count..].fill(values[tile.count - 1]);
            }
        }
    }

    /// From the last layer's channels to jets.
    fn heads(&self, tile: &Tile<'_, E>, shape: Shape, buffers: &mut Buffers<E>) {
        let reading = tile.reading;
        let (stride, output_stride) = (tile.stride(), tile.output_stride());
        let heads = Heads {
            shape,
            channels: reading.layers.channels(),
            outputs: &reading.outputs,
            weights: self.weights.matrix(&self.layout.head),
            rows: &buffers.output,
            out: &mut buffers.outputs,
            stride: output_stride,
        };
        dispatch(self.isa, heads);
        for (output, out) in reading.outputs.iter().zip(buffers.outputs.chunks_exact_mut(output_stride)) {
            if output.channel == 0 {
                let bias = self.weights.bias(&self.layout.head)[output.head];
                out[..shape.points].iter_mut().for_each(|x| *x += bias);
            }
        }
        for (map, jet) in reading.jets.iter().zip(buffers.jets.chunks_exact_mut(stride)) {
            jet[..tile.count].fill(map.offset);
            for &(output, factor) in &map.parts {
                let out = &buffers.outputs[output * output_stride + map.site * tile.count..][..tile.count];
                for (jet, &out) in jet.iter_mut().zip(out) {
                    *jet += factor * out;
                }
            }
            let last = jet[tile.count - 1];
            jet[tile.count..].fill(last);
        }
    }

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

/// The first layer's channels, and the gates as difference and floor: `c` is replaced by `c - d` in place.
fn split_gates<E: Real>(lifted: &mut [AlignedVec<E>], len: usize) -> (&mut [E], Option<Gate<'_, E>>) {
    match lifted {
        [first, c, d] => {
            subtract(&mut c[..len], &d[..len]);
            (&mut first[..len], Some(Gate { difference: c, floor: d }))
        }
        lifted => (&mut lifted[0][..len], None),
    }
}
