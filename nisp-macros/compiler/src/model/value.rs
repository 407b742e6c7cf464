//! What an expression evaluates to while it is checked: scalars, vectors and matrices of scalar expressions.

use std::rc::Rc;

use num_traits::Zero;

use super::{Expr, Node};
use crate::rational::Rational;
use crate::unit::Dimension;

/// Nodes of one scalar expression, shared ones counted each time: past this, code would take minutes to compile.
pub(super) const LARGEST: u32 = 100_000;

/// Depth of one scalar expression, far from where later stages' recursion runs out of stack.
pub(super) const DEEPEST: u32 = 256;

/// What kinds of leaf an expression contains, as a set of bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Reads(u8);

impl Reads {
    pub(super) const FIELD: Self = Self(1);
    pub(super) const COORDINATE: Self = Self(2);
    pub(super) const COLUMN: Self = Self(4);
    pub(super) const PARAMETER: Self = Self(8);
    pub(super) const PARTNER: Self = Self(16);

    pub(super) fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    pub(super) fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if the value is known when it compiles.
    pub(super) fn is_constant(self) -> bool {
        self.0 == 0
    }
}

/// A scalar expression and what one needs to know of it without walking through it.
#[derive(Clone, Debug)]
pub(super) struct Scalar {
    pub(super) expr: Expr,
    pub(super) reads: Reads,
    /// Highest order of derivative of a field in it.
    pub(super) order: u32,
    pub(super) size: u32,
    pub(super) depth: u32,
}

impl Scalar {
    pub(super) fn leaf(node: Node, reads: Reads) -> Self {
        Self { expr: Rc::new(node), reads, order: 0, size: 1, depth: 1 }
    }

    pub(super) fn number(value: Rational) -> Self {
        Self::leaf(Node::Number(value), Reads::default())
    }

    /// A node above others.
    pub(super) fn over(node: Node, inner: &[&Scalar]) -> Self {
        let mut scalar = Self::leaf(node, Reads::default());
        for part in inner {
            scalar.reads = scalar.reads.and(part.reads);
            scalar.order = scalar.order.max(part.order);
            scalar.size = scalar.size.saturating_add(part.size);
            scalar.depth = scalar.depth.max(part.depth.saturating_add(1));
        }
        scalar
    }

    /// Its value if it is an exact literal.
    pub(super) fn as_number(&self) -> Option<Rational> {
        match *self.expr {
            Node::Number(value) => Some(value),
            _ => None,
        }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.as_number().is_some_and(|value| value.is_zero())
    }
}

/// Rows and columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    Scalar,
    Vector(usize),
    Matrix(usize, usize),
}

impl std::fmt::Display for Extent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Extent::Scalar => write!(f, "a scalar"),
            Extent::Vector(length) => write!(f, "a vector of {length}"),
            Extent::Matrix(rows, columns) => write!(f, "a {rows} x {columns} matrix"),
        }
    }
}

/// The dimension of an expression, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
// One for each value under construction: a box would cost more than it saves.
#[allow(clippy::large_enum_variant)]
pub(super) enum Dim {
    /// A literal zero: fits everywhere.
    Any,
    /// This one.
    Known(Dimension),
    /// Units are off, or a mistake was already reported: compares with everything.
    Unknown,
}

impl Dim {
    pub(super) fn none() -> Self {
        Dim::Known(Dimension::none())
    }

    pub(super) fn known(&self) -> Option<&Dimension> {
        match self {
            Dim::Known(dimension) => Some(dimension),
            _ => None,
        }
    }

    /// True unless it certainly is the dimension of something else.
    pub(super) fn fits(&self, dimension: &Dimension) -> bool {
        self.known().is_none_or(|known| known == dimension)
    }

    /// Combines two by an operation on dimensions; None if an exponent becomes absurd.
    pub(super) fn combine(
        &self,
        other: &Dim,
        operation: impl Fn(&Dimension, &Dimension) -> Option<Dimension>,
    ) -> Option<Dim> {
        Some(match (self, other) {
            (Dim::Known(a), Dim::Known(b)) => Dim::Known(operation(a, b)?),
            // A literal zero brings no unit of its own, but zero times a length is a length.
            (Dim::Any, Dim::Known(other)) if !other.is_none() => Dim::Known(operation(&Dimension::none(), other)?),
            (Dim::Known(own), Dim::Any) if !own.is_none() => Dim::Known(own.clone()),
            (Dim::Any, _) | (_, Dim::Any) => Dim::Any,
            _ => Dim::Unknown,
        })
    }
}

/// A value: entries in rows, all of one dimension.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) extent: Extent,
    pub(super) dim: Dim,
    pub(super) entries: Vec<Scalar>,
}

impl Value {
    pub(super) fn scalar(scalar: Scalar, dim: Dim) -> Self {
        Self { extent: Extent::Scalar, dim, entries: vec![scalar] }
    }

    pub(super) fn vector(entries: Vec<Scalar>, dim: Dim) -> Self {
        Self { extent: Extent::Vector(entries.len()), dim, entries }
    }

    /// A square or oblong matrix from its entries, row by row.
    pub(super) fn matrix(rows: usize, columns: usize, dim: Dim, entry: impl Fn(usize, usize) -> Scalar) -> Self {
        let entries = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let entries = entries.map(|(row, column)| entry(row, column)).collect();
        Self { extent: Extent::Matrix(rows, columns), dim, entries }
    }

    /// The same function of every entry.
    pub(super) fn map(&self, dim: Dim, function: impl Fn(&Scalar) -> Scalar) -> Self {
        Self { extent: self.extent, dim, entries: self.entries.iter().map(function).collect() }
    }

    /// Its only entry, if it is a scalar.
    pub(super) fn as_scalar(&self) -> Option<&Scalar> {
        match (self.extent, self.entries.as_slice()) {
            (Extent::Scalar, [only]) => Some(only),
            _ => None,
        }
    }

    /// True for a literal zero, which is a vector or matrix of zeros where one is needed.
    pub(super) fn is_zero(&self) -> bool {
        self.as_scalar().is_some_and(Scalar::is_zero)
    }

    /// What all entries read.
    pub(super) fn reads(&self) -> Reads {
        self.entries.iter().fold(Reads::default(), |all, entry| all.and(entry.reads))
    }

    /// The highest order of derivative in it.
    pub(super) fn order(&self) -> u32 {
        self.entries.iter().map(|entry| entry.order).max().unwrap_or(0)
    }
}
