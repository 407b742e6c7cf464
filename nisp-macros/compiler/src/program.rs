//! Straight-line programs: the compiler's neutral form of code, without tokens.

use crate::model::Function;

/// Index of a value, in order of computation.
pub type Value = usize;

/// A straight-line program in static single assignment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Operations; an operand refers to an earlier operation.
    pub ops: Vec<Op>,
    /// The values that leave the program, in order. `None` is a structural zero.
    pub outputs: Vec<Option<Value>>,
}

/// One operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// Read an input.
    Input(Slot, usize),
    /// A literal.
    Constant(f64),
    /// `a + b`
    Add(Value, Value),
    /// `a - b`
    Sub(Value, Value),
    /// `a * b`
    Mul(Value, Value),
    /// `a / b`
    Div(Value, Value),
    /// `-a`
    Neg(Value),
    /// `a * b + c`
    MulAdd(Value, Value, Value),
    /// `a * b - c`
    MulSub(Value, Value, Value),
    /// `c - a * b`
    NegMulAdd(Value, Value, Value),
    /// `min(a, b)`
    Min(Value, Value),
    /// `max(a, b)`
    Max(Value, Value),
    /// An elementary function; `Sqrt` is among them.
    Call(Function, Value),
}

/// Where an input of a program comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// A derivative of a network output (group programs).
    Jet,
    /// A coordinate of the point.
    Coordinate,
    /// A scalar: parameters, then literals with units, then scales.
    Parameter,
    /// Per-point data.
    Column,
    /// The adjoint of an output (adjoint programs).
    Seed,
    /// `phi[n]`: the n-th derivative of the activation at the point.
    Phi,
    /// Channels of the argument of a composition.
    Argument,
    /// Channels of the left factor of a product.
    Left,
    /// Channels of the right factor of a product.
    Right,
    /// Weights of an affine unit, one per coordinate.
    Weight,
}
