//! Plain numbers, and numbers that carry one directional derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the reference computes with.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn of(x: f64) -> Self;
    /// The number without its derivative.
    fn value(self) -> f64;
    /// `f(x)`, given value and derivative of `f`.
    fn chain(self, value: f64, slope: f64) -> Self;

    /// Its exponential.
    fn exp(self) -> Self {
        self.chain(self.value().exp(), self.value().exp())
    }
    /// Its sine.
    fn sin(self) -> Self {
        self.chain(self.value().sin(), self.value().cos())
    }
    /// Its cosine.
    fn cos(self) -> Self {
        self.chain(self.value().cos(), -self.value().sin())
    }
    /// Its square root.
    fn sqrt(self) -> Self {
        self.chain(self.value().sqrt(), 0.5 / self.value().sqrt())
    }
    /// Its hyperbolic tangent.
    fn tanh(self) -> Self {
        self.chain(self.value().tanh(), 1.0 / self.value().cosh().powi(2))
    }
}

impl Number for f64 {
    fn of(x: f64) -> Self {
        x
    }
    fn value(self) -> f64 {
        self
    }
    fn chain(self, value: f64, _: f64) -> Self {
        value
    }
}

/// `value + slope * epsilon` with `epsilon^2 = 0`
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    /// The number itself.
    pub value: f64,
    /// Its derivative.
    pub slope: f64,
}

impl Number for Dual {
    fn of(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, slope: slope * self.slope }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { value: self.value * b.value, slope: self.slope * b.value + self.value * b.slope }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Self { value, slope: (self.slope - value * b.slope) / b.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}
