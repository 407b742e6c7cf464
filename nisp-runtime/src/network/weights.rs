//! The working form of the weights: materialised and packed once per step, for all tiles.

use super::{Layout, Matrix};
use crate::aligned::AlignedVec;
use crate::gemm::{self, Left, Packed, Right, Write, gemm};
use crate::layer::Shape;
use crate::real::Real;
use crate::simd::Isa;

/// Padded weights, and hidden matrices packed for both directions.
#[derive(Debug)]
pub struct Weights<E: Real> {
    padded: AlignedVec<E>,
    pub(crate) hidden: Vec<Hidden<E>>,
}

/// A hidden weight matrix `W`, packed for both directions.
#[derive(Debug)]
pub(crate) struct Hidden<E: Real> {
    /// `W^T`
    forward: Packed<E>,
    /// `W`
    backward: Packed<E>,
}

impl<E: Real> Weights<E> {
    /// Weights of a network of this layout, all zero.
    pub fn new(isa: Isa, layout: &Layout) -> Self {
        let pack = || Packed::zeros(isa, layout.width, layout.width);
        Self {
            padded: AlignedVec::zeros(layout.padded_len),
            hidden: layout.hidden.iter().map(|_| Hidden { forward: pack(), backward: pack() }).collect(),
        }
    }

    /// Takes over parameters.
    pub fn set(&mut self, layout: &Layout, theta: &[E]) {
        layout.pad(theta, &mut self.padded);
        for (hidden, matrix) in self.hidden.iter_mut().zip(&layout.hidden) {
            let w = &self.padded[matrix.padded..matrix.padded_bias];
            hidden.forward.pack(Left::transposed(w, layout.width), layout.width);
            hidden.backward.pack(Left::rows(w, layout.width), layout.width);
        }
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

impl<E: Real> Hidden<E> {
    /// `out = rows W^T`
    pub(crate) fn forward(&self, isa: Isa, rows: usize, ld: usize, input: &[E], out: &mut [E]) {
        multiply(isa, rows, ld, input, &self.forward, out);
    }

    /// Adjoint of [`Hidden::forward`]: `input_bar = out_bar W`
    pub(crate) fn backward(&self, isa: Isa, rows: usize, ld: usize, out_bar: &[E], input_bar: &mut [E]) {
        multiply(isa, rows, ld, out_bar, &self.backward, input_bar);
    }
}

fn multiply<E: Real>(isa: Isa, rows: usize, ld: usize, input: &[E], matrix: &Packed<E>, out: &mut [E]) {
    let shape = gemm::Shape { rows, columns: matrix.columns(), inner: matrix.inner() };
    gemm(isa, shape, Left::rows(input, ld), Right::Packed(matrix), out, ld, Write::Set);
}

/// The other adjoint of [`Hidden::forward`], by the weights: `weights_bar += out_bar^T input`.
pub(crate) fn add_outer<E: Real>(
    isa: Isa,
    rows: usize,
    shape: Shape,
    out_bar: &[E],
    input: &[E],
    weights_bar: &mut [E],
) {
    let extents = gemm::Shape { rows: shape.width, columns: shape.width, inner: rows };
    let right = Right::Rows { elements: input, stride: shape.ld };
    gemm(isa, extents, Left::transposed(out_bar, shape.ld), right, weights_bar, shape.width, Write::Add);
}
