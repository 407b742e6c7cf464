//! Complex steps: a derivative without a difference, so that the step may be as small as one likes.

use num_complex::Complex64;

use crate::number::Number;

/// Imaginary part of what is moved. Its square is lost beside any number.
pub const STEP: f64 = 1e-40;

impl Number for Complex64 {
    fn of(x: f64) -> Self {
        x.into()
    }
    fn value(self) -> f64 {
        self.re
    }
    fn chain(self, value: f64, slope: f64) -> Self {
        Self::new(value, slope * self.im)
    }
    fn exp(self) -> Self {
        Complex64::exp(self)
    }
    fn sin(self) -> Self {
        Complex64::sin(self)
    }
    fn cos(self) -> Self {
        Complex64::cos(self)
    }
    fn sqrt(self) -> Self {
        Complex64::sqrt(self)
    }
    fn tanh(self) -> Self {
        Complex64::tanh(self)
    }
}
