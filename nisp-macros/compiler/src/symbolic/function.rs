//! Elementary functions: values, exact values, parities and derivatives, one table each.

use num_traits::{One, Signed, Zero};

use super::graph::{Graph, Id};
use crate::model::Function;
use crate::rational::{Rational, ratio};

/// Below this, a square root counts as zero in its derivative; representable in single precision.
pub const TINY_ROOT: f64 = 1e-30;

/// How a function reacts to the sign of its argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// `f(-x) = f(x)`
    Even,
    /// `f(-x) = -f(x)`
    Odd,
    /// Neither.
    None,
}

/// The function's parity.
pub fn parity(function: Function) -> Parity {
    use Function::*;
    match function {
        Cos | Cosh | Abs => Parity::Even,
        Sin | Tan | Asin | Atan | Sinh | Tanh | Sign => Parity::Odd,
        Acos | Exp | Ln | Sqrt | Step | Softplus | Sigmoid => Parity::None,
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

/// The function's value at an exact number, where that is exact too.
pub fn exact_value(function: Function, x: Rational) -> Option<Rational> {
    use Function::*;
    match function {
        Sin | Tan | Asin | Atan | Sinh | Tanh if x.is_zero() => Some(x),
        Cos | Cosh | Exp if x.is_zero() => Some(Rational::one()),
        Ln | Acos if x.is_one() => Some(Rational::zero()),
        Sigmoid if x.is_zero() => Some(ratio(1, 2)),
        Abs => (*x.numer() != i128::MIN).then(|| x.abs()),
        Sign => Some(x.signum()),
        Step => Some(if x.is_positive() { Rational::one() } else { Rational::zero() }),
        Sqrt => Some(Rational::new_raw(exact_root(*x.numer())?, exact_root(*x.denom())?)),
        _ => None,
    }
}

fn exact_root(n: i128) -> Option<i128> {
    let root = (n as f64).sqrt() as i128;
    (n >= 0 && root.checked_mul(root) == Some(n)).then_some(root)
}

/// The derivative of `function` at `x`, where `y` is its value there.
///
/// At kinks it is a subgradient: `|x|' = sign(x)` with `sign(0) = 0`, `sqrt'(0) = 0`.
pub fn derivative(graph: &mut Graph, function: Function, x: Id, y: Id) -> Id {
    use Function::*;
    let one = graph.integer(1);
    let square = |graph: &mut Graph, of: Id| graph.power(of, ratio(2, 1));
    match function {
        Sin => graph.call(Cos, x),
        Cos => {
            let sine = graph.call(Sin, x);
            graph.negate(sine)
        }
        Tan => {
            let y2 = square(graph, y);
            graph.add(&[one, y2])
        }
        Asin | Acos => {
            let x2 = square(graph, x);
            let rest = graph.subtract(one, x2);
            let slope = graph.power(rest, ratio(-1, 2));
            if function == Asin { slope } else { graph.negate(slope) }
        }
        Atan => {
            let x2 = square(graph, x);
            let sum = graph.add(&[one, x2]);
            graph.power(sum, ratio(-1, 1))
        }
        Sinh => graph.call(Cosh, x),
        Cosh => graph.call(Sinh, x),
        Tanh => {
            let y2 = square(graph, y);
            graph.subtract(one, y2)
        }
        Exp => y,
        Ln => graph.power(x, ratio(-1, 1)),
        Sqrt => {
            let floor = graph.real(TINY_ROOT);
            let root = graph.max(y, floor);
            let positive = graph.call(Step, x);
            let slope = graph.divide(positive, root);
            graph.scale(ratio(1, 2), slope)
        }
        Abs => graph.call(Sign, x),
        Sign | Step => graph.integer(0),
        Softplus => graph.call(Sigmoid, x),
        Sigmoid => {
            let rest = graph.subtract(one, y);
            graph.multiply(&[y, rest])
        }
    }
}
