//! Exact rational numbers, in which exponents of units are kept, and all of the compiler's linear algebra is done.

/// An exact rational number.
pub type Rational = num_rational::Ratio<i128>;

/// `n / d` as a [`Rational`]; `d` must not be zero.
pub fn ratio(n: i128, d: i128) -> Rational {
    Rational::new(n, d)
}
