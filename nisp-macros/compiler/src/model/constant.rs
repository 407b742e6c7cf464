//! Values known when it compiles: defaults, bounds and constants.

use super::elaborate::Elaborator;
use super::value::{Extent, Reads};
use super::{Expr as Scalar, Function, Node};
use crate::error::{Checked, catalogue};
use crate::rational::Rational;
use crate::syntax::{Expr, ExprKind, print_text, real};
use crate::unit::Unit;
use crate::unit::frame::{Number, Si};

/// A value that is known when it compiles.
pub(super) struct Constant {
    pub(super) value: Number<Si>,
    /// Its exact value as written, if it has one.
    pub(super) exact: Option<Rational>,
}

/// Evaluates an expression that must be constant. Numbers without a unit are in the declared one.
pub(super) fn in_unit(expr: &Expr, unit: &Unit, elaborator: &mut Elaborator<'_>) -> Checked<Vec<Constant>> {
    let value = elaborator.value(expr)?;
    if !value.reads().is_constant() || matches!(value.extent, Extent::Matrix(..)) {
        let message = catalogue::not_constant(&print_text(expr), value.reads() == Reads::PARAMETER);
        return Err(elaborator.errors.report(expr.place, message));
    }
    let bare = value.dim.known().is_none_or(|dimension| dimension.is_none()) && !has_unit(expr);
    if !bare && !value.dim.fits(&unit.dimension) {
        let found = value.dim.known().cloned().unwrap_or_default();
        let message = catalogue::value_has_other_unit(&print_text(expr), &found, &unit.dimension);
        return Err(elaborator.errors.report(expr.place, message));
    }
    let in_si = |value| if bare { unit.factor.of(Number::declared(value)) } else { Number::si(value) };
    let evaluated = value.entries.iter().map(|entry| {
        let value = evaluate(&entry.expr).map(in_si).filter(|value| value.as_si().is_finite())?;
        Some(Constant { value, exact: entry.as_number() })
    });
    let all: Option<Vec<Constant>> = evaluated.collect();
    all.ok_or_else(|| elaborator.errors.report(expr.place, catalogue::not_finite(&print_text(expr))))
}

/// True if a unit is written anywhere in it, so that its value is not one in the declared unit.
fn has_unit(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_, unit) => unit.is_some(),
        ExprKind::Name(_) | ExprKind::Call(..) => false,
        ExprKind::Negate(inner) => has_unit(inner),
        ExprKind::Sum(parts) | ExprKind::Product(parts) => parts.iter().any(|(_, part)| has_unit(part)),
        ExprKind::Power(base, _) | ExprKind::Index(base, _) => has_unit(base),
        ExprKind::List(parts) => parts.iter().any(has_unit),
    }
}

/// The value of an expression without leaves that vary.
pub(super) fn evaluate(expr: &Scalar) -> Option<f64> {
    Some(match &**expr {
        Node::Number(value) => real(*value),
        Node::Real(value) | Node::Quantity(value, _) => *value,
        Node::Add(terms) => terms.iter().map(evaluate).sum::<Option<f64>>()?,
        Node::Mul(factors) => factors.iter().map(evaluate).product::<Option<f64>>()?,
        Node::Div(a, b) => evaluate(a)? / evaluate(b)?,
        Node::Pow(base, exponent) => evaluate(base)?.powf(real(*exponent)),
        Node::Power(base, exponent) => evaluate(base)?.powf(evaluate(exponent)?),
        Node::Min(a, b) => evaluate(a)?.min(evaluate(b)?),
        Node::Max(a, b) => evaluate(a)?.max(evaluate(b)?),
        Node::Call(function, argument) => apply(*function, evaluate(argument)?),
        Node::Coordinate(_)
        | Node::Field(_)
        | Node::Parameter(_)
        | Node::Column(_)
        | Node::Derivative(..)
        | Node::Partner(_) => return None,
    })
}

fn apply(function: Function, x: f64) -> f64 {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.tan(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Tanh => x.tanh(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Sqrt => x.sqrt(),
        Function::Abs => x.abs(),
        Function::Sign => {
            if x == 0.0 {
                0.0
            } else {
                x.signum()
            }
        }
        Function::Step => f64::from(x > 0.0),
        Function::Softplus => x.exp().ln_1p(),
        Function::Sigmoid => 1.0 / (1.0 + (-x).exp()),
    }
}
