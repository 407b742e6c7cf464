//! Learned scalars: from parameters to their values.

/// A learned scalar: its slot, and the map from its parameter to its value in the engine's units.
#[derive(Clone, Debug)]
pub(crate) struct Learned {
    pub(crate) slot: usize,
    pub(crate) map: LearnedMap,
}

/// How a learned scalar follows from its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LearnedMap {
    /// `start * exp(theta)`: positive quantities.
    Positive(f64),
    /// `start + scale * theta`
    Linear(f64, f64),
    /// `lower + (upper - lower) / (1 + exp(-(theta + shift)))`
    Between(f64, f64, f64),
}

impl LearnedMap {
    /// Value and derivative.
    pub(crate) fn at(self, theta: f64) -> (f64, f64) {
        match self {
            Self::Positive(start) => (start * theta.exp(), start * theta.exp()),
            Self::Linear(start, scale) => (start + scale * theta, scale),
            Self::Between(lower, upper, shift) => {
                let s = 1.0 / (1.0 + (-(theta + shift)).exp());
                (lower + (upper - lower) * s, (upper - lower) * s * (1.0 - s))
            }
        }
    }
}
