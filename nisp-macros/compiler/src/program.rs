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

impl Op {
    /// The values it reads.
    pub fn operands(&self) -> Vec<Value> {
        match *self {
            Self::Input(..) | Self::Constant(_) => Vec::new(),
            Self::Neg(a) | Self::Call(_, a) => vec![a],
            Self::Add(a, b) | Self::Sub(a, b) | Self::Mul(a, b) | Self::Div(a, b) => vec![a, b],
            Self::Min(a, b) | Self::Max(a, b) => vec![a, b],
            Self::MulAdd(a, b, c) | Self::MulSub(a, b, c) | Self::NegMulAdd(a, b, c) => vec![a, b, c],
        }
    }
}

impl Program {
    /// The outputs in double precision; a structural zero is zero.
    pub fn evaluate(&self, input: impl Fn(Slot, usize) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.ops.len());
        for op in &self.ops {
            let value = match *op {
                Op::Input(slot, index) => input(slot, index),
                Op::Constant(value) => value,
                Op::Add(a, b) => values[a] + values[b],
                Op::Sub(a, b) => values[a] - values[b],
                Op::Mul(a, b) => values[a] * values[b],
                Op::Div(a, b) => values[a] / values[b],
                Op::Neg(a) => -values[a],
                Op::MulAdd(a, b, c) => values[a].mul_add(values[b], values[c]),
                Op::MulSub(a, b, c) => values[a].mul_add(values[b], -values[c]),
                Op::NegMulAdd(a, b, c) => (-values[a]).mul_add(values[b], values[c]),
                Op::Min(a, b) => values[a].min(values[b]),
                Op::Max(a, b) => values[a].max(values[b]),
                Op::Call(function, a) => value(function, values[a]),
            };
            values.push(value);
        }
        self.outputs.iter().map(|output| output.map_or(0.0, |value| values[value])).collect()
    }

    /// For each operation, whether it depends on scalars ([`Slot::Parameter`]) and literals only: such operations
    /// have one value for all points.
    pub fn uniform(&self) -> Vec<bool> {
        let mut uniform: Vec<bool> = Vec::with_capacity(self.ops.len());
        for op in &self.ops {
            let value = match op {
                Op::Input(slot, _) => *slot == Slot::Parameter,
                other => other.operands().iter().all(|&operand| uniform[operand]),
            };
            uniform.push(value);
        }
        uniform
    }

    /// Number of operations per point: neither inputs and literals nor what is the same for all points.
    pub fn operations(&self) -> usize {
        self.arithmetic().count()
    }

    /// Floating-point operations per point: a fused multiply-add counts two, an elementary function one.
    pub fn flops(&self) -> usize {
        let cost = |op: &Op| match op {
            Op::MulAdd(..) | Op::MulSub(..) | Op::NegMulAdd(..) => 2,
            _ => 1,
        };
        self.arithmetic().map(cost).sum()
    }

    fn arithmetic(&self) -> impl Iterator<Item = &Op> {
        let varying = self.ops.iter().zip(self.uniform()).filter(|(_, uniform)| !uniform);
        varying.map(|(op, _)| op).filter(|op| !matches!(op, Op::Input(..) | Op::Constant(_)))
    }
}

/// The function's value.
pub fn value(function: Function, x: f64) -> f64 {
    use Function::*;
    match function {
        Sin => x.sin(),
        Cos => x.cos(),
        Tan => x.tan(),
        Asin => x.asin(),
        Acos => x.acos(),
        Atan => x.atan(),
        Sinh => x.sinh(),
        Cosh => x.cosh(),
        Tanh => x.tanh(),
        Exp => x.exp(),
        Ln => x.ln(),
        Sqrt => x.sqrt(),
        Abs => x.abs(),
        Sign if x == 0.0 => 0.0,
        Sign => x.signum(),
        Step => f64::from(x > 0.0),
        // max(x, 0) + ln(1 + exp(-|x|)) neither overflows nor cancels.
        Softplus => x.max(0.0) + (-x.abs()).exp().ln_1p(),
        Sigmoid => {
            let e = (-x.abs()).exp();
            if x >= 0.0 { 1.0 / (1.0 + e) } else { e / (1.0 + e) }
        }
    }
}
