//! A learned factor of an unknown source: where one may be doubled and the other halved, data cannot tell them apart.

use num_traits::{One, Zero};

use super::{Expr, Function, Node, TermKind};
use crate::rational::{Rational, ratio};

/// How a source and a learned parameter are scaled together.
#[derive(Clone, Copy)]
pub(super) struct Scaling {
    pub(super) source: usize,
    pub(super) parameter: usize,
    /// Power of the scale that the parameter goes with, where the source goes with the first.
    pub(super) power: i128,
}

/// The power of the scale that an expression goes with.
#[derive(Clone, Copy, PartialEq)]
enum Goes {
    /// A literal zero goes with any.
    Any,
    With(Rational),
}

impl Scaling {
    /// True if the scaling leaves a term as it is, up to a factor where its rows are wanted zero.
    pub(super) fn keeps(self, term: &TermKind) -> bool {
        let scales = |expr: &Expr| self.goes(expr).is_some();
        let stays = |expr: &Expr| {
            matches!(self.goes(expr), Some(Goes::Any)) || self.goes(expr) == Some(Goes::With(Rational::zero()))
        };
        match term {
            TermKind::Residual(rows) | TermKind::Inequality(rows) => rows.iter().all(scales),
            TermKind::Complementarity { a, b, .. } => scales(a) && scales(b),
            TermKind::Observation { rows, .. } => rows.iter().all(stays),
            TermKind::Integral { integrand, target, .. } => integrand.iter().chain(target).all(stays),
            TermKind::Chamfer { point, .. } => point.iter().all(stays),
        }
    }

    fn goes(self, expr: &Expr) -> Option<Goes> {
        let zero = Rational::zero();
        Some(match &**expr {
            Node::Number(value) if value.is_zero() => Goes::Any,
            Node::Number(_) | Node::Real(_) | Node::Quantity(..) | Node::Coordinate(_) | Node::Column(_) => {
                Goes::With(zero)
            }
            Node::Field(at) => Goes::With(if *at == self.source { Rational::one() } else { zero }),
            Node::Parameter(at) => Goes::With(if *at == self.parameter { ratio(self.power, 1) } else { zero }),
            Node::Add(parts) => self.alike(parts)?,
            Node::Min(a, b) | Node::Max(a, b) => self.alike([a, b])?,
            Node::Mul(parts) => {
                let mut sum = zero;
                for part in parts {
                    match self.goes(part)? {
                        Goes::Any => return Some(Goes::Any),
                        Goes::With(power) => sum += power,
                    }
                }
                Goes::With(sum)
            }
            Node::Div(a, b) => match (self.goes(a)?, self.goes(b)?) {
                (Goes::With(a), Goes::With(b)) => Goes::With(a - b),
                (other, _) => other,
            },
            Node::Pow(inner, exponent) => match self.goes(inner)? {
                Goes::With(power) => Goes::With(power * exponent),
                Goes::Any => Goes::Any,
            },
            Node::Call(Function::Abs, inner) | Node::Derivative(inner, _) | Node::Partner(inner) => self.goes(inner)?,
            Node::Call(Function::Sqrt, inner) => match self.goes(inner)? {
                Goes::With(power) => Goes::With(power / ratio(2, 1)),
                Goes::Any => Goes::Any,
            },
            Node::Call(_, inner) => self.alike([inner, &number()])?,
            Node::Power(a, b) => self.alike([a, b, &number()])?,
        })
    }

    /// What all of them go with, if that is one power.
    fn alike<'a>(self, parts: impl IntoIterator<Item = &'a Expr>) -> Option<Goes> {
        let mut common = Goes::Any;
        for part in parts {
            match (common, self.goes(part)?) {
                (_, Goes::Any) => {}
                (Goes::Any, found) => common = found,
                (common, found) if common == found => {}
                _ => return None,
            }
        }
        Some(common)
    }
}

/// A number, which no scaling changes.
fn number() -> Expr {
    Expr::new(Node::Number(Rational::one()))
}
