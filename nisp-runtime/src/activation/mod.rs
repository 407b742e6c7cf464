//! What the units of a network do to their argument, with all derivatives, vectorised.
//!
//! An activation keeps two numbers of an argument, its value and its slope. All of its derivatives are made from these
//! two, so that the way back computes nothing transcendental.

pub mod sine;
pub mod tanh;

use crate::simd::Simd;

/// The function that a network's units apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Activation {
    /// Hyperbolic tangent: smooth fields with steep places.
    #[default]
    Tanh,
    /// Sine (Sitzmann et al. 2020): fields that oscillate.
    Sine,
}

impl Activation {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Tanh, Self::Sine];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tanh => "tanh",
            Self::Sine => "sine",
        }
    }

    /// The activation of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|activation| activation.name() == name)
    }

    /// Value and slope at `a`, of which [`Activation::derivatives`] makes `D` functions.
    #[inline(always)]
    pub fn value_and_slope<V: Simd, const D: usize>(self, a: V) -> (V, V) {
        match self {
            Self::Tanh => tanh::tanh_and_slope::<V, D>(a),
            Self::Sine => sine::sine_and_cosine(a),
        }
    }

    /// The function and its first `D - 1` derivatives, from its value `t` and slope `s`.
    #[inline(always)]
    pub fn derivatives<V: Simd, const D: usize>(self, t: V, s: V) -> [V; D] {
        match self {
            Self::Tanh => tanh::derivatives(t, s),
            Self::Sine => sine::derivatives(t, s),
        }
    }
}
