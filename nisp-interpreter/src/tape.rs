//! A straight-line program with its values placed: the form that is interpreted.
//!
//! A place is one row of numbers, as many as are computed at once. Inputs have places of their own, which the caller points
//! at where the numbers are. Values have places among the registers, taken again as soon as nothing reads them any more.

use std::collections::BTreeSet;

use nisp_compiler::model::Function;
use nisp_compiler::program::{Op, Program, Slot};

/// Where a value is: an input or a register.
pub(crate) type Place = usize;

/// One operation on places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) code: Code,
    pub(crate) to: Place,
    /// Operands; those that the operation does not have are zero.
    pub(crate) from: [Place; 3],
}

/// What a step does.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Code {
    Constant(f64),
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    MulAdd,
    MulSub,
    NegMulAdd,
    Min,
    Max,
    Sqrt,
    Abs,
    Call(fn(f64) -> f64),
}

/// A program whose values are placed.
#[derive(Debug)]
pub(crate) struct Tape {
    /// Inputs in the order of their places, which come first.
    pub(crate) inputs: Vec<(Slot, usize)>,
    /// Registers: places after those of the inputs.
    pub(crate) registers: usize,
    /// Steps whose results are the same for all points; they keep their places.
    pub(crate) once: Vec<Step>,
    /// The others, in order.
    pub(crate) steps: Vec<Step>,
    /// Where the outputs are; None for a structural zero.
    pub(crate) outputs: Vec<Option<Place>>,
}

impl Tape {
    /// Places a program's values.
    pub(crate) fn new(program: &Program) -> Self {
        let uniform = program.uniform();
        let mut inputs: Vec<(Slot, usize)> = Vec::new();
        for op in &program.ops {
            if let Op::Input(slot, index) = *op
                && !inputs.contains(&(slot, index))
            {
                inputs.push((slot, index));
            }
        }
        let last = last_uses(program);
        let mut registers = Registers { first: inputs.len(), used: 0, free: Vec::new() };
        let mut places: Vec<Place> = Vec::with_capacity(program.ops.len());
        let (mut once, mut steps) = (Vec::new(), Vec::new());
        for (at, op) in program.ops.iter().enumerate() {
            if let Op::Input(slot, index) = *op {
                places.push(inputs.iter().position(|input| *input == (slot, index)).unwrap_or(0));
                continue;
            }
            let operands = op.operands();
            let mut from = [0; 3];
            for (place, operand) in from.iter_mut().zip(&operands) {
                *place = places[*operand];
            }
            // The result may take the place of an operand that ends here: a step reads a vector before it writes there.
            if !uniform[at] {
                let ended: BTreeSet<usize> = operands.into_iter().filter(|o| last[*o] == at && !uniform[*o]).collect();
                ended.into_iter().for_each(|operand| registers.release(places[operand]));
            }
            // Steps that run once come before all others, so that no place of theirs may be one that was used before.
            let to = if uniform[at] { registers.fresh() } else { registers.take() };
            places.push(to);
            let list = if uniform[at] { &mut once } else { &mut steps };
            list.push(Step { code: code(op), to, from });
        }
        let outputs = program.outputs.iter().map(|output| output.map(|value| places[value])).collect();
        Self { inputs, registers: registers.used, once, steps, outputs }
    }
}

/// For each value, the last operation that reads it; past the end for outputs.
fn last_uses(program: &Program) -> Vec<usize> {
    let mut last = vec![0; program.ops.len()];
    for (at, op) in program.ops.iter().enumerate() {
        for operand in op.operands() {
            last[operand] = at;
        }
    }
    for output in program.outputs.iter().flatten() {
        last[*output] = usize::MAX;
    }
    last
}

/// Registers in use and free ones.
struct Registers {
    first: Place,
    used: usize,
    free: Vec<Place>,
}

impl Registers {
    fn fresh(&mut self) -> Place {
        self.used += 1;
        self.first + self.used - 1
    }

    fn take(&mut self) -> Place {
        self.free.pop().unwrap_or_else(|| self.fresh())
    }

    /// Gives a register back; inputs stay where they are.
    fn release(&mut self, place: Place) {
        if place >= self.first {
            self.free.push(place);
        }
    }
}

fn code(op: &Op) -> Code {
    match *op {
        Op::Input(..) => Code::Constant(0.0),
        Op::Constant(value) => Code::Constant(value),
        Op::Add(..) => Code::Add,
        Op::Sub(..) => Code::Sub,
        Op::Mul(..) => Code::Mul,
        Op::Div(..) => Code::Div,
        Op::Neg(_) => Code::Neg,
        Op::MulAdd(..) => Code::MulAdd,
        Op::MulSub(..) => Code::MulSub,
        Op::NegMulAdd(..) => Code::NegMulAdd,
        Op::Min(..) => Code::Min,
        Op::Max(..) => Code::Max,
        Op::Call(Function::Sqrt, _) => Code::Sqrt,
        Op::Call(Function::Abs, _) => Code::Abs,
        Op::Call(function, _) => Code::Call(elementary(function)),
    }
}

/// The function behind a name, as compiled programs call it.
fn elementary(function: Function) -> fn(f64) -> f64 {
    use nisp_runtime::functions;
    match function {
        Function::Sin => f64::sin,
        Function::Cos => f64::cos,
        Function::Tan => f64::tan,
        Function::Asin => f64::asin,
        Function::Acos => f64::acos,
        Function::Atan => f64::atan,
        Function::Sinh => f64::sinh,
        Function::Cosh => f64::cosh,
        Function::Tanh => f64::tanh,
        Function::Exp => f64::exp,
        Function::Ln => f64::ln,
        Function::Sqrt => f64::sqrt,
        Function::Abs => f64::abs,
        Function::Sign => functions::sign,
        Function::Step => functions::step,
        Function::Softplus => functions::softplus,
        Function::Sigmoid => functions::sigmoid,
    }
}
