//! Scalar expressions.

use std::rc::Rc;

use crate::rational::Rational;
use crate::unit::Dimension;

/// A scalar expression, shared where the user shared it (`let`).
pub type Expr = Rc<Node>;

/// The node of a scalar expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A dimensionless literal, exact.
    Number(Rational),
    /// A dimensionless real that is not rational (`pi`), or a literal too long to be exact.
    Real(f64),
    /// A literal with a unit: its value in SI units and its dimension.
    Quantity(f64, Dimension),
    /// A coordinate, by index.
    Coordinate(usize),
    /// A field or source, by index.
    Field(usize),
    /// A parameter, by index.
    Parameter(usize),
    /// A data column of the group at hand, by index.
    Column(usize),
    /// A sum.
    Add(Vec<Expr>),
    /// A product.
    Mul(Vec<Expr>),
    /// A quotient.
    Div(Expr, Expr),
    /// A rational power with a literal exponent.
    Pow(Expr, Rational),
    /// A general power; base and exponent dimensionless.
    Power(Expr, Expr),
    /// An elementary function.
    Call(Function, Expr),
    /// The smaller of two.
    Min(Expr, Expr),
    /// The larger of two.
    Max(Expr, Expr),
    /// The derivative of an expression by a coordinate.
    Derivative(Expr, usize),
    /// The expression at the point's partner (periodic pairs).
    Partner(Expr),
}

/// Elementary functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    /// Derivative of `Abs`, zero at zero.
    Sign,
    /// One for positive arguments, zero otherwise: derivative of `max(x, 0)`.
    Step,
    /// `ln(1 + exp x)`.
    Softplus,
    /// `1 / (1 + exp(-x))`.
    Sigmoid,
}
