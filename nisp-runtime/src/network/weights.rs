//! The working form of the weights: materialised and packed once per step, for all tiles.

use super::{Layout, Matrix};
use crate::aligned::AlignedVec;
use crate::layer::Shape;
use crate::real::Real;
use crate::simd::Isa;

/// Padded weights, and hidden matrices packed for both directions.
#[derive(Debug)]
pub struct Weights<E: Real> {
    padded: AlignedVec<E>,
    pub(crate) hidden: Vec<Hidden<E>>,
}

/// A hidden weight matrix `W`.
#[derive(Debug)]
pub(crate) struct Hidden<E: Real> {
    w: AlignedVec<E>,
    width: usize,
}

impl<E: Real> Weights<E> {
    /// Weights of a network of this layout, all zero.
    pub fn new(_isa: Isa, layout: &Layout) -> Self {
        Self {
            padded: AlignedVec::zeros(layout.padded_len),
            hidden: layout
                .hidden
                .iter()
                .map(|_| Hidden { w: AlignedVec::zeros(layout.width * layout.width), width: layout.width })
                .collect(),
        }
    }

    /// Takes over parameters.
    pub fn set(&mut self, _isa: Isa, layout: &Layout, theta: &[E]) {
        layout.pad(theta, &mut self.padded);
        for (hidden, matrix) in self.hidden.iter_mut().zip(&layout.hidden) {
            hidden.w.copy_from_slice(&self.padded[matrix.padded..matrix.padded_bias]);
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
    pub(crate) fn forward(&self, _isa: Isa, rows: usize, ld: usize, input: &[E], out: &mut [E]) {
        for r in 0..rows {
            for i in 0..self.width {
                let mut s = E::ZERO;
                for j in 0..self.width {
                    s += self.w[i * self.width + j] * input[r * ld + j];
                }
                out[r * ld + i] = s;
            }
        }
    }

    /// Adjoint of [`Hidden::forward`]: `input_bar = out_bar W`
    pub(crate) fn backward(&self, _isa: Isa, rows: usize, ld: usize, out_bar: &[E], input_bar: &mut [E]) {
        for r in 0..rows {
            for j in 0..self.width {
                let mut s = E::ZERO;
                for i in 0..self.width {
                    s += self.w[i * self.width + j] * out_bar[r * ld + i];
                }
                input_bar[r * ld + j] = s;
            }
        }
    }
}

/// The other adjoint of [`Hidden::forward`], by the weights: `weights_bar += out_bar^T input`.
pub(crate) fn add_outer<E: Real>(_isa: Isa, rows: usize, shape: Shape, out_bar: &[E], input: &[E], weights_bar: &mut [E]) {
    for r in 0..rows {
        for i in 0..shape.width {
            for j in 0..shape.width {
                weights_bar[i * shape.width + j] += out_bar[r * shape.ld + i] * input[r * shape.ld + j];
            }
        }
    }
}
