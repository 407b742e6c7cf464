//! Where the parameters live: compact, as the solver sees them, and padded, as the engine works with them.

use std::ops::Range;

use super::Architecture;
use crate::simd::Element;
use crate::solve::prior::{PriorGroup, WeightPrior};

/// Positions of all parameters in the compact vector `theta` and in the padded working vector.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The network's shape.
    pub architecture: Architecture,
    /// Number of coordinates.
    pub inputs: usize,
    /// Number of outputs.
    pub heads: usize,
    /// Hidden units, padded to whole vectors.
    pub width: usize,
    /// Weights on the coordinates (or their features): the first layer, then the gates `c` and `d`.
    pub affine: Vec<Matrix>,
    /// Hidden layers 2, 3, ...
    pub hidden: Vec<Matrix>,
    /// The heads, one row each.
    pub head: Matrix,
    /// Learned scalars, in `theta`; as many in the padded vector from [`Layout::learned_at`].
    pub learned: Range<usize>,
    /// First learned scalar in the padded vector.
    pub learned_at: usize,
    /// Length of `theta`.
    pub len: usize,
    /// Length of the padded vector.
    pub padded_len: usize,
}

/// A weight matrix with its biases.
#[derive(Clone, Debug)]
pub struct Matrix {
    /// What it is, for reports.
    pub name: String,
    /// Units that it feeds.
    pub rows: usize,
    /// Units that feed it.
    pub columns: usize,
    /// Weights in `theta`, `[row][column]`.
    pub weights: usize,
    /// Logarithmic row scales in `theta`, if the matrix is factorised.
    pub scales: Option<usize>,
    /// Biases in `theta`, one per row.
    pub bias: usize,
    /// Weights in the padded vector.
    pub padded: usize,
    /// Distance of two rows in the padded vector.
    pub padded_row: usize,
    /// Distance of two columns in the padded vector.
    pub padded_column: usize,
    /// Biases in the padded vector.
    pub padded_bias: usize,
}

/// Hands out consecutive ranges of the two vectors.
struct Allocator {
    factorised: bool,
    theta: usize,
    padded: usize,
}

impl Allocator {
    fn matrix(&mut self, name: String, shape: [usize; 2], padded: [usize; 2], transposed: bool) -> Matrix {
        let [rows, columns] = shape;
        let weights = self.theta;
        self.theta += rows * columns;
        let scales = self.factorised.then_some(self.theta);
        if self.factorised {
            self.theta += rows;
        }
        let bias = self.theta;
        self.theta += rows;
        let at = self.padded;
        let padded_bias = at + padded[0] * padded[1];
        self.padded = padded_bias + padded[0];
        let (padded_row, padded_column) = if transposed { (1, padded[0]) } else { (padded[1], 1) };
        Matrix { name, rows, columns, weights, scales, bias, padded: at, padded_row, padded_column, padded_bias }
    }
}

impl Layout {
    /// Lays out a network with `learned` scalars behind it; widths are padded to multiples of `lanes`.
    pub fn new(architecture: Architecture, inputs: usize, heads: usize, learned: usize, lanes: usize) -> Self {
        let width = architecture.width.next_multiple_of(lanes);
        let mut at = Allocator { factorised: architecture.factorised, theta: 0, padded: 0 };
        let units = architecture.width;
        let columns = architecture.inputs.features(inputs).map_or(inputs, |(_, features)| features.len());
        // Transposed, for rows of a few numbers would be padding for the most part, and be multiplied like it.
        let affine = ["first layer", "gate c", "gate d"][..1 + architecture.gates()]
            .iter()
            .map(|&name| at.matrix(name.into(), [units, columns], [width, columns], true))
            .collect();
        let hidden = (2..=architecture.layers)
            .map(|layer| at.matrix(format!("layer {layer}"), [units, units], [width, width], false))
            .collect();
        let head = at.matrix("heads".into(), [heads, units], [heads, width], false);
        let learned_at = at.padded;
        Self {
            architecture,
            inputs,
            heads,
            width,
            affine,
            hidden,
            head,
            learned: at.theta..at.theta + learned,
            learned_at,
            len: at.theta + learned,
            padded_len: (learned_at + learned).next_multiple_of(lanes),
        }
    }

    /// A prior of one precision to begin with on two groups that may learn different ones: how wiggly the last layer's
    /// units are, and how much of them the heads take. Learned scalars have none but what the scene states.
    pub(crate) fn prior(&self, precision: f64) -> WeightPrior {
        let group = |name: &str, range| PriorGroup { name: name.into(), range, precision };
        WeightPrior::of([group("layers", 0..self.head.weights), group("heads", self.head.weights..self.learned.start)])
    }

    /// True if the network sees features of the coordinates instead of the coordinates.
    pub(crate) fn is_mapped(&self) -> bool {
        self.architecture.inputs.features(self.inputs).is_some()
    }

    /// All matrices, in order.
    pub fn matrices(&self) -> impl Iterator<Item = &Matrix> {
        self.affine.iter().chain(&self.hidden).chain(std::iter::once(&self.head))
    }

    /// Parameters of head `head`, in `theta`: its weights, then its bias.
    pub fn head_parameters(&self, head: usize) -> impl Iterator<Item = usize> {
        let first = self.head.weights + head * self.head.columns;
        (first..first + self.head.columns).chain(std::iter::once(self.head.bias + head))
    }

    /// From `theta` to the padded vector (padding is left as it is: zero).
    pub fn pad<E: Element>(&self, theta: &[E], padded: &mut [E]) {
        for m in self.matrices() {
            for i in 0..m.rows {
                let (scale, weights) = (m.scale(theta, i), &theta[m.row(i)]);
                let places = padded[m.padded_at(i, 0)..].iter_mut().step_by(m.padded_column);
                places.zip(weights).for_each(|(place, weight)| *place = scale * *weight);
                padded[m.padded_bias + i] = theta[m.bias + i];
            }
        }
        padded[self.learned_at..][..self.learned.len()].copy_from_slice(&theta[self.learned.clone()]);
    }

    /// Adjoint of [`Layout::pad`]: from the padded gradient to the gradient by `theta`.
    pub fn pad_adjoint<E: Element>(&self, theta: &[E], padded: &[E], gradient: &mut [E]) {
        for m in self.matrices() {
            for i in 0..m.rows {
                let (scale, bars) = (m.scale(theta, i), &mut gradient[m.row(i)]);
                let places = padded[m.padded_at(i, 0)..].iter().step_by(m.padded_column);
                bars.iter_mut().zip(places).for_each(|(bar, place)| *bar = scale * *place);
                if let Some(scales) = m.scales {
                    let by_scale = bars.iter().zip(&theta[m.row(i)]).map(|(bar, weight)| *bar * *weight).sum();
                    gradient[scales + i] = by_scale;
                }
                gradient[m.bias + i] = padded[m.padded_bias + i];
            }
        }
        gradient[self.learned.clone()].copy_from_slice(&padded[self.learned_at..][..self.learned.len()]);
    }
}

impl Matrix {
    /// A row's weights in `theta`.
    fn row(&self, row: usize) -> Range<usize> {
        let first = self.weights + row * self.columns;
        first..first + self.columns
    }

    /// Index of an entry in the padded vector.
    #[inline(always)]
    pub(crate) fn padded_at(&self, row: usize, column: usize) -> usize {
        self.padded + row * self.padded_row + column * self.padded_column
    }

    #[inline(always)]
    fn scale<E: Element>(&self, theta: &[E], row: usize) -> E {
        match self.scales {
            None => E::ONE,
            Some(scales) => E::from_f64(theta[scales + row].to_f64().exp()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pad_and_its_adjoint_are_transposes() {
        let mut architecture = Architecture::modified(5, 3);
        architecture.factorised = true;
        let layout = Layout::new(architecture, 2, 3, 1, 8);
        let theta: Vec<f64> = (0..layout.len).map(|i| (i as f64 * 0.37).sin()).collect();
        let direction: Vec<f64> = (0..layout.len).map(|i| (i as f64 * 0.11).cos()).collect();
        let weights: Vec<f64> = (0..layout.padded_len).map(|i| (i as f64 * 0.71).cos()).collect();
        let value = |step: f64| {
            let moved: Vec<f64> = theta.iter().zip(&direction).map(|(t, d)| t + step * d).collect();
            let mut padded = vec![0.0; layout.padded_len];
            layout.pad(&moved, &mut padded);
            padded.iter().zip(&weights).map(|(p, w)| p * w).sum::<f64>()
        };
        let mut gradient = vec![0.0; layout.len];
        layout.pad_adjoint(&theta, &weights, &mut gradient);
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let h = 1e-5;
        let difference = (value(h) - value(-h)) / (2.0 * h);
        assert!((slope - difference).abs() < 1e-8 * slope.abs().max(1.0), "{slope} against {difference}");
    }
}
