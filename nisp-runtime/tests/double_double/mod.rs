//! Numbers of about 106 bits as unevaluated sums of two f64: enough to judge f64 results by, plain enough to trust.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo` with |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dd {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

/// ln 2, rounded to both parts.
const LN2: Dd = Dd { hi: std::f64::consts::LN_2, lo: 2.319_046_813_846_299_6e-17 };

/// The sum of two f64, exactly (Knuth).
fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let from_b = hi - a;
    Dd { hi, lo: (a - (hi - from_b)) + (b - from_b) }
}

impl Dd {
    pub(crate) const ZERO: Dd = Dd { hi: 0.0, lo: 0.0 };

    pub(crate) fn abs(self) -> Dd {
        if self.hi < 0.0 { -self } else { self }
    }

    /// `self * 2^n` in two steps, so that 2^n itself need not exist.
    pub(crate) fn scale2(self, n: i32) -> Dd {
        let (half, rest) = (2.0_f64.powi(n / 2), 2.0_f64.powi(n - n / 2));
        Dd { hi: self.hi * half * rest, lo: self.lo * half * rest }
    }
}

impl From<f64> for Dd {
    fn from(x: f64) -> Dd {
        Dd { hi: x, lo: 0.0 }
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, b: Dd) -> Dd {
        let (hi, lo) = (two_sum(self.hi, b.hi), two_sum(self.lo, b.lo));
        let first = two_sum(hi.hi, hi.lo + lo.hi);
        two_sum(first.hi, first.lo + lo.lo)
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, b: Dd) -> Dd {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, b: Dd) -> Dd {
        let hi = self.hi * b.hi;
        let lost = self.hi.mul_add(b.hi, -hi);
        two_sum(hi, lost + (self.hi * b.lo + self.lo * b.hi))
    }
}

impl Div for Dd {
    type Output = Dd;
    fn div(self, b: Dd) -> Dd {
        let first = self.hi / b.hi;
        let rest = self - Dd::from(first) * b;
        let second = rest.hi / b.hi;
        let rest = rest - Dd::from(second) * b;
        two_sum(first, second) + Dd::from(rest.hi / b.hi)
    }
}

/// `(exp(y), exp(y) - 1)`, both to full relative precision, by reduction to |r| <= ln(2)/2 and the power series.
pub(crate) fn exponential(y: Dd) -> (Dd, Dd) {
    let n = (y.hi / LN2.hi).round();
    let r = y - Dd::from(n) * LN2;
    let (mut term, mut less_one) = (r, r);
    for k in 2..30 {
        term = term * r / Dd::from(f64::from(k));
        less_one = less_one + term;
    }
    let scaled = (Dd::from(1.0) + less_one).scale2(n as i32);
    let shifted =
        if n == 0.0 { less_one } else { less_one.scale2(n as i32) + (Dd::from(1.0).scale2(n as i32) - Dd::from(1.0)) };
    (scaled, shifted)
}
