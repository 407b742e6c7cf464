//! Literals: exact where they fit.

use num_traits::ToPrimitive;
use proc_macro2::Literal;

use super::stream::Context;
use super::tree::Number;
use crate::error::{Checked, catalogue};
use crate::rational::{Rational, ratio};

/// Numerators and denominators past this become reals: products of a few stay far from overflow.
const LARGEST_EXACT: i128 = 1_000_000_000_000_000_000;

/// Keeps a rational only if later arithmetic with it cannot overflow.
pub(crate) fn exact(value: Rational) -> Option<Rational> {
    (value.numer().abs() <= LARGEST_EXACT && *value.denom() <= LARGEST_EXACT).then_some(value)
}

/// The nearest float, up to one rounding of each part.
pub(crate) fn real(value: Rational) -> f64 {
    *value.numer() as f64 / *value.denom() as f64
}

/// Reads a literal token.
pub(super) fn parse(literal: &Literal, context: &mut Context<'_>) -> Checked<Number> {
    let written = literal.to_string();
    let place = literal.span();
    let mut report = |message| Err(context.errors.report(place, message));
    if !written.starts_with(|c: char| c.is_ascii_digit()) {
        return report(catalogue::not_a_number(&written));
    }
    let (digits, exponent, suffix) = split(&written);
    if !suffix.is_empty() {
        return report(catalogue::suffixed_number(&written[..written.len() - suffix.len()], suffix));
    }
    let text = written.replace('_', "");
    let value: f64 = text.parse().unwrap_or(f64::INFINITY);
    if !value.is_finite() {
        return report(catalogue::number_too_large(&written));
    }
    Ok(Number { exact: exact_value(&digits, exponent), value, text })
}

/// Digits without underscores, power of ten, and what follows the number.
fn split(written: &str) -> (String, i32, &str) {
    let end = written.find(|c: char| !(c.is_ascii_digit() || c == '_' || c == '.')).unwrap_or(written.len());
    let (mantissa, rest) = written.split_at(end);
    let digits = mantissa.replace('_', "");
    let Some(tail) = rest.strip_prefix(['e', 'E']) else { return (digits, 0, rest) };
    let sign = usize::from(tail.starts_with(['+', '-']));
    let length = tail[sign..].find(|c: char| !(c.is_ascii_digit() || c == '_')).unwrap_or(tail.len() - sign);
    let power = tail[..sign + length].replace('_', "");
    match power.parse() {
        Ok(power) => (digits, power, &tail[sign + length..]),
        // No digits after the `e`: it belongs to a suffix. Too many: the value overflows or vanishes as a float.
        Err(_) if length == 0 => (digits, 0, rest),
        Err(_) => (digits, if power.starts_with('-') { i32::MIN } else { i32::MAX }, &tail[sign + length..]),
    }
}

fn exact_value(digits: &str, exponent: i32) -> Option<Rational> {
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    let mantissa: i128 = format!("{whole}{fraction}").parse().ok()?;
    let power = exponent.checked_sub(fraction.len().to_i32()?)?;
    let scale = 10_i128.checked_pow(power.unsigned_abs())?;
    let value = if power < 0 { ratio(mantissa, scale) } else { ratio(mantissa.checked_mul(scale)?, 1) };
    exact(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_literals_are_exact() {
        assert_eq!(exact_value("9.81", 0), Some(ratio(981, 100)));
        assert_eq!(exact_value("2.10", 11), Some(ratio(210_000_000_000, 1)));
        assert_eq!(exact_value("1", -30), None);
        assert_eq!(exact_value("1", i32::MIN), None);
        assert_eq!(exact_value("123456789012345678901234567890123456789012345", 0), None);
    }

    #[test]
    fn a_suffix_is_told_from_an_exponent() {
        assert_eq!(split("2e9Pa"), ("2".into(), 9, "Pa"));
        assert_eq!(split("2x"), ("2".into(), 0, "x"));
        assert_eq!(split("2e"), ("2".into(), 0, "e"));
        assert_eq!(split("1_0.5e-3"), ("10.5".into(), -3, ""));
    }
}
