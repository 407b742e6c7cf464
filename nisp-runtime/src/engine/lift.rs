//! From coordinates to the channels of the first layer and the gates, and back to their weights.
//!
//! On raw coordinates these layers are affine maps under the activation, whose channels have closed forms. On
//! features of the coordinates they are ordinary layers; the features themselves are fixed and need no adjoint.

use super::adjoint::Parts;
use super::buffers::{Buffers, round_rows};
use super::tile::{Network, Tile};
use crate::gemm::Write;
use crate::kernel::Precision;
use crate::layer::{Affine, AffineAdjoint, Features, Layer, LayerAdjoint, Layers, Shape};
use crate::network::{Matrix, ProductAdjoint, multiply};

impl<E: Precision> Network<'_, E> {
    /// Channels of the first layer and the gates, in `buffers.lifted`.
    pub(super) fn lift(
        &self,
        kernel: &dyn Layers<E>,
        shape: Shape,
        buffers: &mut Buffers<E>,
        given: Option<&Buffers<f64>>,
    ) {
        let rows = shape.points * kernel.channels();
        let activation = self.layout.architecture.activation;
        if let Some(features) = &self.weights.features {
            let layer = Features {
                shape: Shape { points: shape.points, ..features.shape },
                function: features.function,
                projections: &features.projections,
                table: &buffers.table,
                linear: &features.linear,
                offsets: &features.offsets,
                coordinates: &buffers.coordinates,
                output: &mut buffers.features,
            };
            kernel.features(self.isa, layer);
        }
        for (j, matrix) in self.layout.affine.iter().enumerate() {
            let (bias, slope) = (self.weights.bias(matrix), &mut buffers.slopes[j]);
            let (value, output) = (&mut buffers.values[j], &mut buffers.lifted[j]);
            if let Some(given) = given {
                round_rows(shape, &given.slopes[j], slope, 1);
            }
            match &self.weights.features {
                None => {
                    if let Some(given) = given {
                        round_rows(shape, &given.values[j], value, 1);
                    }
                    let (weights, coordinates) = (self.weights.matrix(matrix), &buffers.coordinates[..]);
                    kernel.affine(
                        self.isa,
                        Affine { shape, activation, weights, bias, coordinates, value, slope, output },
                    );
                }
                Some(features) => {
                    let lds = [features.shape.ld, shape.ld];
                    multiply(
                        self.isa,
                        rows,
                        &buffers.features,
                        &features.matrices[j],
                        value,
                        lds,
                        Write::SetFromShortSums,
                    );
                    if let Some(given) = given {
                        round_rows(shape, &given.values[j], value, kernel.channels());
                    }
                    kernel.layer(
                        self.isa,
                        Layer { shape, activation, argument: value, bias, slope, output },
                        None,
                        false,
                    );
                }
            }
        }
    }

    /// Adjoint of [`Network::lift`] by the weights. The adjoints of the lifted channels are in `bar`, `difference_bar` and
    /// `floor_bar`.
    pub(super) fn lift_adjoint(
        &self,
        tile: &Tile<'_, E>,
        shape: Shape,
        buffers: &mut Buffers<E>,
        gradient: &mut [E],
        parts: Parts,
    ) {
        for (j, matrix) in self.layout.affine.iter().enumerate() {
            match &self.weights.features {
                None => self.affine_adjoint(tile, shape, buffers, gradient, parts, (j, matrix)),
                Some(features) => {
                    self.mapped_adjoint(tile, shape, buffers, gradient, parts, (j, matrix, features.shape.ld));
                }
            }
        }
    }

    fn affine_adjoint(
        &self,
        tile: &Tile<'_, E>,
        shape: Shape,
        buffers: &Buffers<E>,
        gradient: &mut [E],
        parts: Parts,
        (j, matrix): (usize, &Matrix),
    ) {
        let kernel = tile.reading.layers;
        let seed = [&buffers.bar, &buffers.difference_bar, &buffers.floor_bar][j];
        for (first, count, at) in parts.ranges() {
            let (weights_bar, rest) = gradient[at + matrix.padded..].split_at_mut(matrix.padded_bias - matrix.padded);
            let layer = AffineAdjoint {
                shape: Shape { points: count, ..shape },
                activation: self.layout.architecture.activation,
                weights: self.weights.matrix(matrix),
                coordinates: &buffers.coordinates[first * self.layout.inputs..],
                value: &buffers.values[j][first * shape.ld..],
                slope: &buffers.slopes[j][first * shape.ld..],
                seed: &seed[first * kernel.channels() * shape.ld..],
                weights_bar,
                bias_bar: rest,
            };
            kernel.affine_adjoint(self.isa, layer);
        }
    }

    /// The same on features of the coordinates: a layer's adjoint, then a product with the features.
    fn mapped_adjoint(
        &self,
        tile: &Tile<'_, E>,
        shape: Shape,
        buffers: &mut Buffers<E>,
        gradient: &mut [E],
        parts: Parts,
        (j, matrix, input_ld): (usize, &Matrix, usize),
    ) {
        let kernel = tile.reading.layers;
        let Buffers { bar, difference_bar, floor_bar, next_bar, output, values, slopes, features, .. } = buffers;
        let layer = LayerAdjoint {
            shape,
            activation: self.layout.architecture.activation,
            argument: &values[j],
            slope: &slopes[j],
            seed: [&*bar, &*difference_bar, &*floor_bar][j],
            argument_bar: next_bar,
            output,
        };
        kernel.layer_adjoint(self.isa, layer, None, false);
        for (first, count, at) in parts.ranges() {
            let row = first * kernel.channels();
            let product = ProductAdjoint {
                shape: Shape { points: count, ..shape },
                channels: kernel.channels(),
                bar: &next_bar[row * shape.ld..],
                input: &features[row * input_ld..],
                input_ld,
            };
            product.add(self.isa, matrix, &mut gradient[at..]);
        }
    }
}
