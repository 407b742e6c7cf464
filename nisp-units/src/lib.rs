//! Physical units: exact rational exponents over the SI base units, and the scale to SI. What equations, headers of tables and
//! results know of units they know from here. A number's type says in which units it is: see [`frame`].

use num_traits::{One, Zero};

use crate::frame::{Declared, Scale, Si};
use crate::rational::{Rational, ratio};

pub mod frame;
mod header;
pub mod rational;
mod show;
mod table;

pub use header::{Conversion, conversion, is_unit};
pub use table::{Symbol, known_symbols, look_up};

/// Number of SI base units: metre, kilogram, second, ampere, kelvin, mole, candela.
pub const BASES: usize = 7;

/// Exponents past this size are a mistake, and this bound keeps exact arithmetic far from overflow.
const LARGEST_EXPONENT: i128 = 1000;

/// The dimension of a quantity: exponents of m, kg, s, A, K, mol, cd.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Dimension(pub [Rational; BASES]);

/// A unit as written by the user: its dimension, its scale to SI, and its text (`mm`, `N/m^2`; empty for `1`).
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Exponents over the base units.
    pub dimension: Dimension,
    /// From numbers in this unit to SI: 1e-3 for `mm`.
    pub factor: Scale<Declared, Si>,
    /// The text between the brackets, as the user wrote it.
    pub text: String,
}

impl Dimension {
    /// The dimension of pure numbers.
    pub fn none() -> Self {
        Self::default()
    }

    /// The dimension of lengths.
    pub fn length() -> Self {
        Self::base(0)
    }

    /// One of the SI base dimensions.
    pub fn base(index: usize) -> Self {
        let mut exponents = [Rational::zero(); BASES];
        exponents[index] = Rational::one();
        Self(exponents)
    }

    /// True for pure numbers.
    pub fn is_none(&self) -> bool {
        self.0.iter().all(Zero::is_zero)
    }

    /// The dimension of a product, or None if an exponent becomes absurd.
    pub fn times(&self, other: &Self) -> Option<Self> {
        self.combine(other, |a, b| a + b)
    }

    /// The dimension of a quotient, or None if an exponent becomes absurd.
    pub fn over(&self, other: &Self) -> Option<Self> {
        self.combine(other, |a, b| a - b)
    }

    /// The dimension of a power, or None if an exponent becomes absurd.
    pub fn power(&self, exponent: Rational) -> Option<Self> {
        if !sensible(&exponent) {
            return self.is_none().then(Self::none);
        }
        self.combine(self, |a, _| a * exponent)
    }

    fn combine(&self, other: &Self, operation: impl Fn(Rational, Rational) -> Rational) -> Option<Self> {
        let mut exponents = self.0;
        for (exponent, &second) in exponents.iter_mut().zip(&other.0) {
            *exponent = operation(*exponent, second);
        }
        exponents.iter().all(sensible).then_some(Self(exponents))
    }
}

fn sensible(exponent: &Rational) -> bool {
    let limit = ratio(LARGEST_EXPONENT, 1);
    *exponent <= limit && *exponent >= -limit && *exponent.denom() <= LARGEST_EXPONENT
}

impl Unit {
    /// The unit of pure numbers.
    pub fn one() -> Self {
        Self { dimension: Dimension::none(), factor: Scale::new(1.0), text: String::new() }
    }

    /// The SI unit of a dimension, spelled in a way that parses again.
    pub fn si(dimension: Dimension) -> Self {
        let text = if dimension.is_none() { String::new() } else { dimension.to_string() };
        Self { dimension, factor: Scale::new(1.0), text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_root_of_an_area_is_a_length() {
        let area = Dimension::length().power(ratio(2, 1)).unwrap();
        assert_eq!(area.power(ratio(1, 2)), Some(Dimension::length()));
    }

    #[test]
    fn absurd_exponents_are_refused_not_overflowed() {
        let mut dimension = Dimension::length();
        for _ in 0..100 {
            match dimension.power(ratio(999, 1)) {
                Some(next) => dimension = next,
                None => return,
            }
        }
        panic!("never refused");
    }
}
