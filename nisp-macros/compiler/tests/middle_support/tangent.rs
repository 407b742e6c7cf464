//! Tangents of programs: every operation in jets of first order along one direction, so that an adjoint is held against it
//! without differences.

use nisp_compiler::model::Function;
use nisp_compiler::program::{Op, Program, Slot};

use super::jet::Jet;
use super::oracle::{call, power};

/// A number that moves.
pub(crate) fn moving(value: f64, slope: f64) -> Jet {
    Jet::affine(&[slope], value, 1)
}

/// How fast a jet of first order moves.
fn slope(x: &Jet) -> f64 {
    x.coefficients.get(&vec![1]).copied().unwrap_or(0.0)
}

/// How fast the outputs move when the inputs do.
pub(crate) fn tangent(program: &Program, input: impl Fn(Slot, usize) -> Jet) -> Vec<f64> {
    let mut values: Vec<Jet> = Vec::with_capacity(program.ops.len());
    for op in &program.ops {
        let at = |index: usize| &values[index];
        let less = |a: &Jet, b: &Jet| a.plus(&b.scale(-1.0));
        let value = match *op {
            Op::Input(slot, index) => input(slot, index),
            Op::Constant(value) => moving(value, 0.0),
            Op::Add(a, b) => at(a).plus(at(b)),
            Op::Sub(a, b) => less(at(a), at(b)),
            Op::Mul(a, b) => at(a).times(at(b)),
            Op::Div(a, b) => at(a).times(&power(at(b), -1.0)),
            Op::Neg(a) => at(a).scale(-1.0),
            Op::MulAdd(a, b, c) => at(a).times(at(b)).plus(at(c)),
            Op::MulSub(a, b, c) => less(&at(a).times(at(b)), at(c)),
            Op::NegMulAdd(a, b, c) => less(at(c), &at(a).times(at(b))),
            Op::Min(a, b) => if at(a).value() < at(b).value() { at(a) } else { at(b) }.clone(),
            Op::Max(a, b) => if at(a).value() > at(b).value() { at(a) } else { at(b) }.clone(),
            Op::Call(Function::Step, a) => moving(f64::from(at(a).value() > 0.0), 0.0),
            Op::Call(function, a) => call(function, at(a)),
        };
        values.push(value);
    }
    program.outputs.iter().map(|output| output.map_or(0.0, |value| slope(&values[value]))).collect()
}

/// `u.(J v)` against `(J^T u).v`, each given as the products that it is the sum of: says so where they differ by more than
/// 1e-13 of the sum of magnitudes and `rounding`. Inputs and seeds are of size one, and so is what saturated functions leave
/// their rounding on.
pub(crate) fn compare(tangents: &[f64], adjoints: &[f64], rounding: f64) -> Result<(), String> {
    let sum = |products: &[f64]| products.iter().sum::<f64>();
    let size: f64 = tangents.iter().chain(adjoints).map(|x| x.abs()).sum();
    let (forward, backward) = (sum(tangents), sum(adjoints));
    if (forward - backward).abs() <= 1e-13 * size.max(1.0) + rounding {
        return Ok(());
    }
    Err(format!("u.(Jv) = {forward} and (J'u).v = {backward}, of products that add up to {size}"))
}
