//! What the first layer and the gates see of the coordinates: the coordinates themselves, or fixed features of them.

use rand::{SeedableRng, rngs::StdRng};

use super::init::normal;
use crate::layer::Function;

/// What the network is a function of. Coordinates are scaled to [-1, 1] beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inputs {
    /// Stretched at a hundredth of the range where there is one coordinate (at a tenth where a source's value at its start
    /// is a condition), and the plain coordinates where there are more.
    Automatic,
    /// The coordinates.
    Coordinates,
    /// The coordinates, and beside each the logarithm of the distance from its lower end; see [`Stretched`].
    Stretched(Stretched),
    /// A random Fourier mapping (Tancik et al. 2020), for the paper's ablation: it hurts under noise.
    Fourier(Fourier),
}

/// Logarithms `ln(1 + ratio (x - first) / (last - first))` beside the coordinates `x`.
///
/// A motion that is set off, or a circuit that is switched on, answers at first in a layer that is thin beside the rest
/// of the record, and slower and slower later on. In the logarithm the layer is as wide as the rest, so that a small
/// network resolves it, and a prior that calls for smooth functions does not wipe it out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretched {
    /// Range over the width of the thinnest layer that is to be resolved.
    pub ratio: f64,
}

/// Random Fourier features: cosines, then sines, of `frequencies` random projections of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fourier {
    /// Number of projections; there are twice as many features.
    pub frequencies: usize,
    /// Standard deviation of the projections, in radians per half the domain.
    pub deviation: f64,
}

impl Fourier {
    /// The projections, `[projection][coordinate]`: normal numbers that depend on nothing but these settings.
    pub fn projections(&self, coordinates: usize) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(0);
        (0..self.frequencies * coordinates).map(|_| self.deviation * normal(&mut random)).collect()
    }
}

/// A feature `function(projection . x + phase) + linear . x + offset`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Feature {
    pub(crate) projection: Vec<f64>,
    pub(crate) phase: f64,
    pub(crate) linear: Vec<f64>,
    pub(crate) offset: f64,
}

impl Inputs {
    /// What `Automatic` stands for.
    pub(crate) fn resolved(self, coordinates: usize) -> Self {
        match self {
            Self::Automatic if coordinates == 1 => Self::Stretched(Stretched::default()),
            Self::Automatic => Self::Coordinates,
            chosen => chosen,
        }
    }

    /// How much steeper than across the whole range functions of these inputs are expected to be: between the slopes at
    /// the ends of a stretched coordinate, the geometric mean.
    pub(crate) fn steepness(self, coordinates: usize) -> f64 {
        match self.resolved(coordinates) {
            Self::Stretched(stretched) => stretched.ratio.sqrt(),
            _ => 1.0,
        }
    }

    /// The features, and the function they share; none where the network sees the coordinates.
    pub(crate) fn features(self, coordinates: usize) -> Option<(Function, Vec<Feature>)> {
        match self.resolved(coordinates) {
            Self::Automatic | Self::Coordinates => None,
            Self::Stretched(stretched) => Some(stretched.features(coordinates)),
            Self::Fourier(fourier) => Some((Function::Sine, fourier.features(coordinates))),
        }
    }
}

impl Default for Stretched {
    /// Layers of a hundredth of the range.
    fn default() -> Self {
        Self { ratio: 100.0 }
    }
}

impl Stretched {
    fn features(self, coordinates: usize) -> (Function, Vec<Feature>) {
        let axis = |i: usize, length: f64| (0..coordinates).map(|j| if i == j { length } else { 0.0 }).collect();
        let plain = |i| Feature { projection: axis(i, 0.0), phase: 1.0, linear: axis(i, 1.0), offset: 0.0 };
        // The argument runs from 1 to 1 + ratio, and the feature from -1 to 1.
        let stretched = |i| Feature {
            projection: axis(i, self.ratio / 2.0),
            phase: 1.0 + self.ratio / 2.0,
            linear: axis(i, 0.0),
            offset: -1.0,
        };
        let function = Function::Logarithm { scale: 2.0 / self.ratio.ln_1p() };
        (function, (0..coordinates).map(plain).chain((0..coordinates).map(stretched)).collect())
    }
}

impl Fourier {
    fn features(self, coordinates: usize) -> Vec<Feature> {
        let projections = self.projections(coordinates);
        let of = |phase: f64| {
            projections.chunks_exact(coordinates).map(move |projection| Feature {
                projection: projection.to_vec(),
                phase,
                linear: vec![0.0; coordinates],
                offset: 0.0,
            })
        };
        // A cosine is a sine a quarter turn ahead.
        of(std::f64::consts::FRAC_PI_2).chain(of(0.0)).collect()
    }
}
