//! Builds scalar expressions, with just the simplifications that keep tensor algebra from filling up with zeros.

use std::rc::Rc;

use num_traits::{One, Zero};

use super::value::{Reads, Scalar};
use super::{Expr, Function, Node};
use crate::rational::{Rational, ratio};
use crate::syntax::exact;

pub(super) fn zero() -> Scalar {
    Scalar::number(Rational::zero())
}

pub(super) fn one() -> Scalar {
    Scalar::number(Rational::one())
}

/// A real number, exact if it is a small integer.
pub(super) fn real(value: f64) -> Scalar {
    Scalar::leaf(Node::Real(value), Reads::default())
}

/// The sum of all; true where subtracted.
pub(super) fn sum(terms: &[(bool, Scalar)]) -> Scalar {
    let mut literal = Rational::zero();
    let mut rest: Vec<Scalar> = Vec::new();
    for (subtracted, term) in terms {
        let folded =
            term.as_number().and_then(|value| exact(if *subtracted { literal - value } else { literal + value }));
        match folded {
            Some(folded) => literal = folded,
            None => rest.push(if *subtracted { negate(term) } else { term.clone() }),
        }
    }
    if !literal.is_zero() || rest.is_empty() {
        rest.push(Scalar::number(literal));
    }
    nary(rest, Node::Add)
}

/// The sum of two.
pub(super) fn add(a: &Scalar, b: &Scalar) -> Scalar {
    sum(&[(false, a.clone()), (false, b.clone())])
}

/// The difference of two.
pub(super) fn subtract(a: &Scalar, b: &Scalar) -> Scalar {
    sum(&[(false, a.clone()), (true, b.clone())])
}

/// The product of all.
pub(super) fn product(factors: &[Scalar]) -> Scalar {
    let mut literal = Rational::one();
    let mut rest: Vec<Scalar> = Vec::new();
    for factor in factors {
        if factor.is_zero() {
            return zero();
        }
        match factor.as_number().and_then(|value| exact(literal * value)) {
            Some(folded) => literal = folded,
            None => rest.push(factor.clone()),
        }
    }
    if !literal.is_one() || rest.is_empty() {
        rest.insert(0, Scalar::number(literal));
    }
    nary(rest, Node::Mul)
}

/// The product of two.
pub(super) fn multiply(a: &Scalar, b: &Scalar) -> Scalar {
    product(&[a.clone(), b.clone()])
}

pub(super) fn negate(a: &Scalar) -> Scalar {
    multiply(&Scalar::number(ratio(-1, 1)), a)
}

/// A quotient; the caller has refused a literal zero below.
pub(super) fn divide(a: &Scalar, b: &Scalar) -> Scalar {
    if a.is_zero() {
        return zero();
    }
    match b.as_number().filter(|value| !value.is_zero()).and_then(|value| exact(value.recip())) {
        Some(inverse) => multiply(a, &Scalar::number(inverse)),
        None => Scalar::over(Node::Div(Rc::clone(&a.expr), Rc::clone(&b.expr)), &[a, b]),
    }
}

/// A power with a literal exponent.
pub(super) fn power(base: &Scalar, exponent: Rational) -> Scalar {
    if exponent.is_one() {
        return base.clone();
    }
    if exponent.is_zero() {
        return one();
    }
    match base.as_number().and_then(|value| exact_power(value, exponent)) {
        Some(value) => Scalar::number(value),
        None => Scalar::over(Node::Pow(Rc::clone(&base.expr), exponent), &[base]),
    }
}

fn exact_power(base: Rational, exponent: Rational) -> Option<Rational> {
    let count = exponent.is_integer().then(|| *exponent.numer())?;
    if count.abs() > 60 || (base.is_zero() && count < 0) {
        return None;
    }
    let base = if count < 0 { base.recip() } else { base };
    (0..count.abs()).try_fold(Rational::one(), |value, _| exact(value * base))
}

/// A power with any exponent.
pub(super) fn general_power(base: &Scalar, exponent: &Scalar) -> Scalar {
    Scalar::over(Node::Power(Rc::clone(&base.expr), Rc::clone(&exponent.expr)), &[base, exponent])
}

pub(super) fn call(function: Function, argument: &Scalar) -> Scalar {
    Scalar::over(Node::Call(function, Rc::clone(&argument.expr)), &[argument])
}

pub(super) fn minimum(a: &Scalar, b: &Scalar) -> Scalar {
    Scalar::over(Node::Min(Rc::clone(&a.expr), Rc::clone(&b.expr)), &[a, b])
}

pub(super) fn maximum(a: &Scalar, b: &Scalar) -> Scalar {
    Scalar::over(Node::Max(Rc::clone(&a.expr), Rc::clone(&b.expr)), &[a, b])
}

/// The derivative by a coordinate; zero at once where nothing depends on one.
pub(super) fn derivative(inner: &Scalar, coordinate: usize) -> Scalar {
    if !inner.reads.any(Reads::FIELD.and(Reads::COORDINATE)) {
        return zero();
    }
    if let Node::Coordinate(index) = *inner.expr {
        return if index == coordinate { one() } else { zero() };
    }
    let mut scalar = Scalar::over(Node::Derivative(Rc::clone(&inner.expr), coordinate), &[inner]);
    if inner.reads.any(Reads::FIELD) {
        scalar.order += 1;
    }
    scalar
}

/// The expression at the point's partner.
pub(super) fn partner(inner: &Scalar) -> Scalar {
    let mut scalar = Scalar::over(Node::Partner(Rc::clone(&inner.expr)), &[inner]);
    scalar.reads = scalar.reads.and(Reads::PARTNER);
    scalar
}

fn nary(mut parts: Vec<Scalar>, node: fn(Vec<Expr>) -> Node) -> Scalar {
    if parts.len() == 1
        && let Some(only) = parts.pop()
    {
        return only;
    }
    let inner: Vec<&Scalar> = parts.iter().collect();
    Scalar::over(node(parts.iter().map(|part| Rc::clone(&part.expr)).collect()), &inner)
}
