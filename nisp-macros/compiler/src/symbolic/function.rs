//! Derivatives of elementary functions.

use super::graph::{Graph, Id};
use crate::model::Function;
use crate::rational::ratio;

/// Below this, a square root counts as zero in its derivative; representable in single precision.
pub const TINY_ROOT: f64 = 1e-30;

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
