//! Units in brackets: `[m/s^2]`, `[kg m^-3]`, `[m^(1/2)]`, `[m^0.5]`, `[1]`.

use num_traits::{One, Zero};
use proc_macro2::Delimiter;

use super::parse_number;
use super::stream::{Context, Stream};
use crate::error::{Checked, Place, catalogue};
use crate::rational::Rational;
use crate::unit::frame::Scale;
use crate::unit::{Dimension, Unit, look_up};

/// What stands above and below the line of an exponent, at most.
const MOST: i128 = 100;

/// A product of powers under construction.
struct Product {
    dimension: Dimension,
    coefficient: f64,
    /// Power of ten, kept apart so that factors come out correctly rounded.
    exponent: Rational,
}

/// Takes `[...]` if there is one; an outer None means that there is none.
pub(super) fn parse_optional(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Option<Checked<Unit>> {
    let (mut inside, place) = stream.take_group(Delimiter::Bracket)?;
    Some(parse(&mut inside, place, context))
}

fn parse(stream: &mut Stream<'_>, place: Place, context: &mut Context<'_>) -> Checked<Unit> {
    let mut text = String::new();
    let product = context.nested(stream, |stream, context| product(stream, place, context, &mut text))?;
    let scale = if product.exponent.is_integer() {
        format!("1e{}", product.exponent).parse().unwrap_or(f64::INFINITY)
    } else {
        10_f64.powf(parse_number::real(product.exponent))
    };
    let factor = product.coefficient * scale;
    if !(factor.is_normal() && factor > 0.0) {
        return Err(context.errors.report(place, catalogue::absurd_unit()));
    }
    let text = if text == "1" { String::new() } else { text };
    Ok(Unit { dimension: product.dimension, factor: Scale::new(factor), text })
}

fn product(stream: &mut Stream<'_>, place: Place, context: &mut Context<'_>, text: &mut String) -> Checked<Product> {
    let mut whole = Product { dimension: Dimension::none(), coefficient: 1.0, exponent: Rational::zero() };
    let (mut first, mut divided) = (true, false);
    while !stream.at_end() {
        let at = stream.place();
        let below = stream.take("/").is_some();
        let times = !below && stream.take("*").is_some();
        if divided && !below && !times {
            // `J/kg K` means two things to two readers.
            return Err(context.errors.report(at, catalogue::ambiguous_unit(text, &stream.found())));
        }
        text.push_str(if below {
            "/"
        } else if first {
            ""
        } else {
            " "
        });
        let factor = factor(stream, context, text)?;
        let sign = if below { -Rational::one() } else { Rational::one() };
        whole = multiply(whole, factor, sign).ok_or_else(|| context.errors.report(place, catalogue::absurd_unit()))?;
        divided |= below;
        first = false;
    }
    Ok(whole)
}

fn multiply(whole: Product, factor: Product, power: Rational) -> Option<Product> {
    let dimension = whole.dimension.times(&factor.dimension.power(power)?)?;
    let coefficient = whole.coefficient * factor.coefficient.powf(parse_number::real(power));
    let exponent = whole.exponent + factor.exponent * power;
    let sensible = parse_number::real(exponent).abs() < 1000.0 && *exponent.denom() < 1_000_000;
    sensible.then_some(Product { dimension, coefficient, exponent })
}

fn factor(stream: &mut Stream<'_>, context: &mut Context<'_>, text: &mut String) -> Checked<Product> {
    let place = stream.place();
    let base = base(stream, context, text)?;
    if stream.take("^").is_none() {
        return Ok(base);
    }
    text.push('^');
    let power = exponent(stream, context, text)?;
    let one = Product { dimension: Dimension::none(), coefficient: 1.0, exponent: Rational::zero() };
    multiply(one, base, power).ok_or_else(|| context.errors.report(place, catalogue::absurd_unit()))
}

fn base(stream: &mut Stream<'_>, context: &mut Context<'_>, text: &mut String) -> Checked<Product> {
    let place = stream.place();
    let found = stream.found();
    if let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) {
        text.push('(');
        let inner = context.nested(&mut inside, |inside, context| product(inside, place, context, text))?;
        text.push(')');
        return Ok(inner);
    }
    let symbol = if stream.take("%").is_some() {
        "%".to_string()
    } else if let Some(name) = stream.take_name() {
        name.text
    } else {
        let one = stream.take_literal().is_some_and(|literal| literal.to_string() == "1");
        if !one {
            return Err(context.errors.report(place, catalogue::expected_unit(&found)));
        }
        text.push('1');
        return Ok(Product { dimension: Dimension::none(), coefficient: 1.0, exponent: Rational::zero() });
    };
    text.push_str(&symbol);
    match look_up(&symbol) {
        Some(found) => Ok(Product {
            dimension: found.dimension,
            coefficient: found.coefficient,
            exponent: Rational::from_integer(found.exponent.into()),
        }),
        None => Err(context.errors.report(place, catalogue::unknown_unit(&symbol))),
    }
}

/// `2`, `-3`, `0.5`, `(1/2)`, `(-1/2)`.
fn exponent(stream: &mut Stream<'_>, context: &mut Context<'_>, text: &mut String) -> Checked<Rational> {
    let Some((mut inside, _)) = stream.take_group(Delimiter::Parenthesis) else {
        return number(stream, context, text);
    };
    text.push('(');
    let mut value = number(&mut inside, context, text)?;
    let place = inside.place();
    if inside.take("/").is_some() {
        text.push('/');
        let below = number(&mut inside, context, text)?;
        if below.is_zero() {
            return Err(context.errors.report(place, catalogue::absurd_unit()));
        }
        value /= below;
    }
    if !inside.at_end() {
        return Err(context.errors.report(inside.place(), catalogue::expected_exponent(&inside.found())));
    }
    text.push(')');
    Ok(value)
}

/// A number that is a fraction of two small ones.
fn number(stream: &mut Stream<'_>, context: &mut Context<'_>, text: &mut String) -> Checked<Rational> {
    let negative = stream.take("-").is_some();
    let (place, found) = (stream.place(), stream.found());
    let number = match stream.take_literal() {
        Some(literal) => parse_number::parse(&literal, context)?,
        None => return Err(context.errors.report(place, catalogue::expected_exponent(&found))),
    };
    match number.exact.filter(|value| *value.numer() <= MOST && *value.denom() <= MOST) {
        Some(value) => {
            text.push_str(if negative { "-" } else { "" });
            text.push_str(&number.text);
            Ok(if negative { -value } else { value })
        }
        None => Err(context.errors.report(place, catalogue::expected_exponent(&found))),
    }
}
