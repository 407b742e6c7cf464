//! The working form of the weights: materialised and packed once per step, for all tiles.

use super::inputs::Feature;
use super::{Layout, Matrix};
use crate::aligned::AlignedVec;
use crate::gemm::{self, Left, Packed, Right, Write, gemm};
use crate::layer::{Function, Shape, row_distance, tabulate};
use crate::simd::{Element, Isa};
use crate::wide::add_rows;

/// Padded weights, and hidden matrices packed for both directions.
#[derive(Debug)]
pub struct Weights<E: Element> {
    padded: AlignedVec<E>,
    pub(crate) hidden: Vec<Hidden<E>>,
    pub(crate) features: Option<Mapping<E>>,
    doubled: Option<Box<Doubled>>,
}

/// The same parameters in double precision.
#[derive(Debug)]
struct Doubled {
    theta: Vec<f64>,
    weights: Weights<f64>,
}

/// Features of the coordinates, and the matrices on them.
#[derive(Debug)]
pub(crate) struct Mapping<E: Element> {
    /// Features in the place of units, no points.
    pub(crate) shape: Shape,
    pub(crate) function: Function,
    /// `[coordinate][feature]`, padded.
    pub(crate) projections: AlignedVec<E>,
    pub(crate) phases: AlignedVec<E>,
    /// `[coordinate][feature]`, padded.
    pub(crate) linear: AlignedVec<E>,
    pub(crate) offsets: AlignedVec<E>,
    /// `W^T` of the first layer and the gates.
    pub(crate) matrices: Vec<Packed<E>>,
}

impl<E: Element> Mapping<E> {
    fn new(isa: Isa, layout: &Layout, (function, features): (Function, Vec<Feature>)) -> Self {
        let width = features.len().next_multiple_of(isa.lanes::<E>());
        let by_feature = |value: &dyn Fn(&Feature) -> f64| {
            let mut values = AlignedVec::zeros(width);
            values.iter_mut().zip(&features).for_each(|(to, feature)| *to = E::from_f64(value(feature)));
            values
        };
        let by_coordinate = |value: &dyn Fn(&Feature) -> &[f64]| {
            let mut values = AlignedVec::zeros(layout.inputs * width);
            for (f, feature) in features.iter().enumerate() {
                for (i, &x) in value(feature).iter().enumerate() {
                    values[i * width + f] = E::from_f64(x);
                }
            }
            values
        };
        Self {
            shape: Shape { points: 0, width, ld: row_distance(width) },
            function,
            projections: by_coordinate(&|feature| &feature.projection),
            phases: by_feature(&|feature| feature.phase),
            linear: by_coordinate(&|feature| &feature.linear),
            offsets: by_feature(&|feature| feature.offset),
            matrices: layout.affine.iter().map(|_| Packed::zeros(isa, features.len(), layout.width)).collect(),
        }
    }

    /// What the features at points (`[point][coordinate]`) are made of, `[point][2][feature]`.
    pub(crate) fn table(&self, coordinates: &[E]) -> Vec<E> {
        let width = self.shape.width;
        let inputs = self.projections.len() / width;
        let mut table = vec![E::ZERO; coordinates.len() / inputs * 2 * width];
        for (point, table) in coordinates.chunks_exact(inputs).zip(table.chunks_exact_mut(2 * width)) {
            tabulate(self.function, point, &self.projections, &self.phases, table);
        }
        table
    }
}

/// A hidden weight matrix `W`, packed for both directions.
#[derive(Debug)]
pub(crate) struct Hidden<E: Element> {
    /// `W^T`
    forward: Packed<E>,
    /// `W`
    backward: Packed<E>,
}

impl<E: Element> Weights<E> {
    /// Weights of a network of this layout, all zero; in double precision too if values are needed in it.
    pub fn new(isa: Isa, layout: &Layout, doubled: bool) -> Self {
        let pack = || Packed::zeros(isa, layout.width, layout.width);
        Self {
            padded: AlignedVec::zeros(layout.padded_len),
            hidden: layout.hidden.iter().map(|_| Hidden { forward: pack(), backward: pack() }).collect(),
            features: layout
                .architecture
                .inputs
                .features(layout.inputs)
                .map(|features| Mapping::new(isa, layout, features)),
            doubled: doubled
                .then(|| Box::new(Doubled { theta: vec![0.0; layout.len], weights: Weights::new(isa, layout, false) })),
        }
    }

    /// Takes over parameters.
    pub fn set(&mut self, layout: &Layout, theta: &[E]) {
        self.set_forward(layout, theta);
        for (hidden, matrix) in self.hidden.iter_mut().zip(&layout.hidden) {
            let w = &self.padded[matrix.padded..matrix.padded_bias];
            hidden.backward.pack(Left::rows(w, layout.width), layout.width);
        }
        if let Some(doubled) = &mut self.doubled {
            doubled.theta.iter_mut().zip(theta).for_each(|(wide, narrow)| *wide = narrow.to_f64());
            doubled.weights.set_forward(layout, &doubled.theta);
        }
    }

    /// Takes over parameters for the way there only.
    fn set_forward(&mut self, layout: &Layout, theta: &[E]) {
        layout.pad(theta, &mut self.padded);
        for (hidden, matrix) in self.hidden.iter_mut().zip(&layout.hidden) {
            let w = &self.padded[matrix.padded..matrix.padded_bias];
            hidden.forward.pack(Left::transposed(w, layout.width), layout.width);
        }
        if let Some(features) = &mut self.features {
            for (packed, matrix) in features.matrices.iter_mut().zip(&layout.affine) {
                let w = &self.padded[matrix.padded..matrix.padded_bias];
                packed.pack(Left::rows(w, layout.width), layout.width);
            }
        }
    }

    /// Weights of the same parameters in double precision, if they are kept; for the way there only.
    pub(crate) fn doubled(&self) -> Option<&Weights<f64>> {
        self.doubled.as_deref().map(|doubled| &doubled.weights)
    }

    /// Weights of a matrix, in its padded layout.
    pub fn matrix(&self, matrix: &Matrix) -> &[E] {
        &self.padded[matrix.padded..matrix.padded_bias]
    }

    /// Biases of a matrix, padded.
    pub fn bias(&self, matrix: &Matrix) -> &[E] {
        &self.padded[matrix.padded_bias..]
    }
}

impl<E: Element> Hidden<E> {
    /// `out = rows W^T`
    pub(crate) fn forward(&self, isa: Isa, rows: usize, ld: usize, input: &[E], out: &mut [E]) {
        multiply(isa, rows, input, &self.forward, out, [ld; 2], Write::SetFromShortSums);
    }

    /// Adjoint of [`Hidden::forward`]: `input_bar = out_bar W`
    pub(crate) fn backward(&self, isa: Isa, rows: usize, ld: usize, out_bar: &[E], input_bar: &mut [E]) {
        multiply(isa, rows, out_bar, &self.backward, input_bar, [ld; 2], Write::Set);
    }
}

/// `out = input matrix`, rows of both as far apart as `lds` says.
pub(crate) fn multiply<E: Element>(
    isa: Isa,
    rows: usize,
    input: &[E],
    matrix: &Packed<E>,
    out: &mut [E],
    [input_ld, out_ld]: [usize; 2],
    write: Write,
) {
    let shape = gemm::Shape { rows, columns: matrix.columns(), inner: matrix.inner() };
    gemm(isa, shape, Left::rows(input, input_ld), Right::Packed(matrix), out, out_ld, write);
}

/// The other adjoint of a layer's product, by its weights and biases.
pub(crate) struct ProductAdjoint<'a, E> {
    /// Shape of the adjoint rows.
    pub(crate) shape: Shape,
    pub(crate) channels: usize,
    /// Adjoint of the product.
    pub(crate) bar: &'a [E],
    /// What was multiplied by the weights, `input_ld` apart.
    pub(crate) input: &'a [E],
    pub(crate) input_ld: usize,
}

impl<E: Element> ProductAdjoint<'_, E> {
    /// `weights += bar^T input`, or the transpose of that where weights lie so, and the biases the sum of the values'
    /// adjoints, in a padded gradient.
    pub(crate) fn add(&self, isa: Isa, matrix: &Matrix, gradient: &mut [E]) {
        let Self { shape, channels, bar, input, input_ld } = *self;
        let (weights, biases) = gradient[matrix.padded..].split_at_mut(matrix.padded_bias - matrix.padded);
        let distance = channels * shape.ld;
        add_rows(&mut biases[..shape.width], &bar[..shape.points * distance], distance);
        let (bar, input) = ((bar, shape.ld), (input, input_ld));
        let is_transposed = matrix.padded_row == 1;
        let (rows, left, right) = if is_transposed { (matrix.columns, input, bar) } else { (shape.width, bar, input) };
        let extents = gemm::Shape { rows, columns: shape.width, inner: shape.points * channels };
        let right = Right::Rows { elements: right.0, stride: right.1 };
        gemm(isa, extents, Left::transposed(left.0, left.1), right, weights, shape.width, Write::Add);
    }
}
