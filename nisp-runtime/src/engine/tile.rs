//! One tile of points through the network.
//!
//! A tile is so small that its channels stay in the second-level cache from the coordinates to the gradient.

use super::buffers::{Buffers, POINT_LANES, round_rows};
use super::group::BoundGroup;
use super::heads::Heads;
use super::reading::Reading;
use super::sites::Sites;
use crate::aligned::AlignedVec;
use crate::kernel::Precision;
use crate::layer::{Gate, Gated, Layer, Layers, Shape, row_distance};
use crate::network::{Architecture, Layout, Weights};
use crate::simd::{Isa, dispatch};
use crate::wide::subtract;

/// The network as a tile sees it.
#[derive(Clone, Copy)]
pub(crate) struct Network<'a, E: Precision> {
    pub(crate) isa: Isa,
    pub(crate) layout: &'a Layout,
    pub(crate) weights: &'a Weights<E>,
    pub(crate) scalars: &'a [E],
}

/// A tile: `count` points of a group from `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Tile<'a, E: Precision> {
    pub(crate) group: &'a BoundGroup<E>,
    pub(crate) reading: &'a Reading<E>,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl<'a, E: Precision> Tile<'a, E> {
    /// A tile of which all is read that its group's programs read.
    pub(crate) fn new(group: &'a BoundGroup<E>, first: usize, count: usize) -> Self {
        Self { group, reading: &group.reading, first, count }
    }

    /// A tile of which is read what has to be known ahead of a step's pass.
    pub(crate) fn ahead(group: &'a BoundGroup<E>, first: usize, count: usize) -> Self {
        Self { group, reading: group.ahead(), first, count }
    }

    /// Copies where the network is evaluated for it, in either precision.
    pub(super) fn load_sites<F: Precision>(&self, sites: &Sites<F>, buffers: &mut Buffers<F>) {
        let all = (self.group.points, self.group.sites());
        sites.load((self.first, self.count), all, &mut buffers.coordinates, &mut buffers.table);
    }

    pub(super) fn shape(&self, layout: &Layout) -> Shape {
        Shape { points: self.count * self.group.sites(), width: layout.width, ld: row_distance(layout.width) }
    }

    /// Distance between quantities of the network's points: the tile's own, then their partners.
    pub(super) fn output_stride(&self) -> usize {
        (self.count * self.group.sites()).next_multiple_of(POINT_LANES)
    }

    /// Distance between per-point quantities.
    pub(crate) fn stride(&self) -> usize {
        self.count.next_multiple_of(POINT_LANES)
    }
}

impl<E: Precision> Network<'_, E> {
    /// From the points of a tile to the jets that its group reads.
    pub(crate) fn forward(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>) {
        self.load(tile, buffers);
        let (shape, kernel) = (tile.shape(self.layout), tile.reading.layers);
        let mut values = buffers.doubled.take();
        let given = values.as_deref_mut().filter(|_| kernel.takes_values()).map(|values| {
            self.doubled_values(tile, values);
            &*values
        });
        self.layers(kernel, shape, buffers, given);
        buffers.doubled = values;
        self.heads(tile, shape, buffers);
    }

    /// From coordinates to the channels of the last layer, with its values from elsewhere if they are given.
    pub(super) fn layers(
        &self,
        kernel: &dyn Layers<E>,
        shape: Shape,
        buffers: &mut Buffers<E>,
        given: Option<&Buffers<f64>>,
    ) {
        assert_eq!(kernel.takes_values(), given.is_some(), "values are given to layers that take them");
        self.lift(kernel, shape, buffers, given);
        let rows = shape.points * kernel.channels();
        let (first, gates) = split_gates(&mut buffers.lifted, rows * shape.ld);
        let Architecture { layers, activation, .. } = self.layout.architecture;
        match gates {
            Some(gate) => {
                kernel.gate(self.isa, Gated { shape, input: first, gate, output: &mut buffers.output });
            }
            None => buffers.output[..first.len()].copy_from_slice(first),
        }
        for (l, matrix) in self.layout.hidden.iter().enumerate() {
            let argument = &mut buffers.arguments[l];
            self.weights.hidden[l].forward(self.isa, rows, shape.ld, &buffers.output, argument);
            let slope = &mut buffers.hidden_slopes[l];
            if let Some(given) = given {
                round_rows(shape, &given.arguments[l], argument, kernel.channels());
                round_rows(shape, &given.hidden_slopes[l], slope, 1);
            }
            let layer = Layer {
                shape,
                activation,
                argument,
                bias: self.weights.bias(matrix),
                slope,
                output: &mut buffers.output,
            };
            kernel.layer(self.isa, layer, gates, l + 2 == layers);
        }
    }

    /// Copies a tile's points and data; lanes past the last point repeat it, so that programs stay finite there.
    fn load(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<E>) {
        let group = tile.group;
        tile.load_sites(&group.network, buffers);
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
}

/// The first layer's channels, and the gates as difference and floor: `c` is replaced by `c - d` in place.
fn split_gates<E: Precision>(lifted: &mut [AlignedVec<E>], len: usize) -> (&mut [E], Option<Gate<'_, E>>) {
    match lifted {
        [first, c, d] => {
            subtract(&mut c[..len], &d[..len]);
            (&mut first[..len], Some(Gate { difference: c, floor: d }))
        }
        lifted => (&mut lifted[0][..len], None),
    }
}
