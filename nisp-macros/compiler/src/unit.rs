//! Physical units: exact rational exponents over the SI base units, and the factor to SI.

use crate::rational::Rational;

/// Number of SI base units: metre, kilogram, second, ampere, kelvin, mole, candela.
pub const BASES: usize = 7;

/// The dimension of a quantity: exponents of m, kg, s, A, K, mol, cd.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Dimension(pub [Rational; BASES]);

/// A unit as written by the user: its dimension, its size in SI, and its text (`mm`, `N/m^2`; empty for `1`).
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Exponents over the base units.
    pub dimension: Dimension,
    /// One of this unit in SI units: 1e-3 for `mm`.
    pub factor: f64,
    /// The text between the brackets, as the user wrote it.
    pub text: String,
}
