//! Expressions as written.

use super::Name;
use crate::error::Place;
use crate::rational::Rational;
use crate::unit::Unit;

/// `group` or `group.term`.
#[derive(Clone, Debug)]
pub struct Path {
    /// The group.
    pub group: Name,
    /// The term; None for all of the group's.
    pub term: Option<Name>,
}

/// An expression and where it stands.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its first and last token.
    pub place: Place,
}

/// An expression. Sums and products are flat, so that long ones nest no deeper than short ones.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A literal, perhaps with a unit.
    Number(Number, Option<Box<Unit>>),
    /// A name.
    Name(String),
    /// `-a`
    Negate(Box<Expr>),
    /// `a + b - c`: true where subtracted.
    Sum(Vec<(bool, Expr)>),
    /// `a * b / c`: true where divided by.
    Product(Vec<(bool, Expr)>),
    /// `a ^ b`
    Power(Box<Expr>, Box<Expr>),
    /// `f(a, b)`
    Call(Name, Vec<Expr>),
    /// `[a, b]`
    List(Vec<Expr>),
    /// `a[i, j]`
    Index(Box<Expr>, Vec<Expr>),
}

/// A literal.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its exact value, unless it has too many digits.
    pub exact: Option<Rational>,
    /// Its value.
    pub value: f64,
    /// As written.
    pub text: String,
}
