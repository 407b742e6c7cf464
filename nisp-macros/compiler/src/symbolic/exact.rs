//! Checked exact arithmetic: a number that outgrows 128 bits is an error, never a panic.

use num_traits::{CheckedAdd, CheckedMul, One, Signed, Zero};

use crate::rational::Rational;

/// Exact arithmetic left the range of 128-bit integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// Result of exact arithmetic.
pub type Exact<T> = Result<T, Overflow>;

/// `a + b`
pub fn add(a: Rational, b: Rational) -> Exact<Rational> {
    a.checked_add(&b).ok_or(Overflow)
}

/// `a * b`
pub fn mul(a: Rational, b: Rational) -> Exact<Rational> {
    a.checked_mul(&b).ok_or(Overflow)
}

/// `1 / a`, for `a` other than zero.
pub fn invert(a: Rational) -> Exact<Rational> {
    if a.is_zero() || *a.numer() == i128::MIN { Err(Overflow) } else { Ok(a.recip()) }
}

/// `a^n`, for `a` other than zero if `n` is negative.
pub fn power(a: Rational, n: i128) -> Exact<Rational> {
    let base = if n < 0 { invert(a)? } else { a };
    if base.is_zero() || base.abs().is_one() {
        return Ok(if n == 0 || (base.is_negative() && n % 2 == 0) { Rational::one() } else { base });
    }
    if n.unsigned_abs() > 128 {
        return Err(Overflow);
    }
    (0..n.unsigned_abs()).try_fold(Rational::one(), |result, _| mul(result, base))
}

/// The nearest double, up to one rounding of each part.
pub fn to_f64(a: Rational) -> f64 {
    *a.numer() as f64 / *a.denom() as f64
}

/// The rational that a double was meant to be: its shortest decimal, if that is short enough to be exact.
pub fn from_f64(value: f64) -> Option<Rational> {
    if !value.is_finite() || (value != 0.0 && !(1e-12..1e15).contains(&value.abs())) {
        return None;
    }
    let text = format!("{value}");
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    if whole.len() + fraction.len() > 30 {
        return None;
    }
    let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
    let result = Rational::new(digits, 10i128.checked_pow(fraction.len() as u32)?);
    (to_f64(result) == value).then_some(result)
}

/// The binomial coefficient `n over k`.
pub fn binomial(n: u32, k: u32) -> Exact<Rational> {
    let mut result = Rational::one();
    for i in 0..k {
        let step = Rational::new(i128::from(n) - i128::from(i), i128::from(i) + 1);
        result = mul(result, step)?;
    }
    Ok(result)
}

/// The factor that makes these numbers coprime integers when they are divided by it, with the sign of the first.
pub fn content(numbers: impl Iterator<Item = Rational> + Clone) -> Exact<Rational> {
    let mut numerator = 0i128;
    let mut denominator = 1i128;
    for number in numbers.clone() {
        numerator = gcd(numerator, *number.numer())?;
        let common = gcd(denominator, *number.denom())?;
        denominator = (denominator / common).checked_mul(*number.denom()).ok_or(Overflow)?;
    }
    let size = Rational::new(numerator.max(1), denominator);
    Ok(if numbers.clone().next().is_some_and(|first| first.is_negative()) { -size } else { size })
}

fn gcd(a: i128, b: i128) -> Exact<i128> {
    let (mut a, mut b) = (a.checked_abs().ok_or(Overflow)?, b.checked_abs().ok_or(Overflow)?);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    Ok(a)
}
