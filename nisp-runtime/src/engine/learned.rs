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

impl Learned {
    /// Scalars with the learned ones at the values of their parameters, and the derivatives of these values.
    pub(crate) fn read_all(learned: &[Self], scalars: &[f64], parameters: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut scalars = scalars.to_vec();
        let read = |(learned, &parameter): (&Self, &f64)| {
            let (value, slope) = learned.map.at(parameter);
            scalars[learned.slot] = value;
            slope
        };
        let slopes = learned.iter().zip(parameters).map(read).collect();
        (scalars, slopes)
    }
}

impl LearnedMap {
    /// True if all values are above zero.
    pub(crate) fn is_positive(self) -> bool {
        match self {
            Self::Positive(_) => true,
            Self::Linear(..) => false,
            Self::Between(lower, ..) => lower >= 0.0,
        }
    }

    /// What a size is multiplied by that goes with a power of the value, and the derivative of its logarithm by the value. One
    /// that may be zero or change its sign is no measure of sizes.
    pub(crate) fn grown(self, theta: f64, power: f64) -> (f64, f64) {
        if power == 0.0 || !self.is_positive() {
            return (1.0, 0.0);
        }
        let value = self.at(theta).0;
        ((value / self.at(0.0).0).powf(power), power / value)
    }

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
