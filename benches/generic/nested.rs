//! Nested dual numbers of `num-dual`: one scalar forward pass per mixed derivative.

use nisp::network::{Layout, Matrix};
use num_dual::{DualNum, HyperDual};

/// Second derivatives by two variables, nested as deep as the operator asks.
type Once = HyperDual<f64>;
type Twice = HyperDual<Once>;
type Thrice = HyperDual<Twice>;

/// The network's first output by plain loops.
fn network<D: DualNum<Primitive = f64> + Copy>(layout: &Layout, theta: &[f64], x: &[D]) -> D {
    let affine = |m: &Matrix, input: &[D]| -> Vec<D> {
        (0..m.rows)
            .map(|i| {
                let row = &theta[m.weights + i * m.columns..][..m.columns];
                row.iter().zip(input).fold(D::from(theta[m.bias + i]), |sum, (&w, &x)| sum + x * w)
            })
            .collect()
    };
    let tanh = |a: Vec<D>| -> Vec<D> { a.into_iter().map(|a| a.tanh()).collect() };
    let [first, c, d] = [0, 1, 2].map(|at| tanh(affine(&layout.affine[at], x)));
    let gate = |z: Vec<D>| -> Vec<D> {
        z.into_iter().zip(c.iter().zip(&d)).map(|(z, (&c, &d))| c * z + d * (-z + 1.0)).collect()
    };
    let last = layout.hidden.iter().fold(gate(first), |z, m| gate(tanh(affine(m, &z))));
    affine(&layout.head, &last)[0]
}

/// A variable, seeded in whichever of the two directions it is.
fn seeded<T: DualNum<Primitive = f64> + Copy>(value: T, variable: usize, pair: [usize; 2]) -> HyperDual<T> {
    let one = |at: usize| T::from(if variable == at { 1.0 } else { 0.0 });
    HyperDual::new(value, one(pair[0]), one(pair[1]), T::from(0.0))
}

/// The derivative of one pass at a point.
pub(crate) fn pass(layout: &Layout, theta: &[f64], x: &[f64], pairs: &[[usize; 2]]) -> f64 {
    match *pairs {
        [a] => {
            let x: Vec<Once> = x.iter().enumerate().map(|(i, &x)| seeded(x, i, a)).collect();
            network(layout, theta, &x).eps1eps2
        }
        [a, b] => {
            let x: Vec<Twice> = x.iter().enumerate().map(|(i, &x)| seeded(seeded(x, i, b), i, a)).collect();
            network(layout, theta, &x).eps1eps2.eps1eps2
        }
        [a, b, c] => {
            let inner = |i, x| seeded(seeded(x, i, c), i, b);
            let x: Vec<Thrice> = x.iter().enumerate().map(|(i, &x)| seeded(inner(i, x), i, a)).collect();
            network(layout, theta, &x).eps1eps2.eps1eps2.eps1eps2
        }
        _ => unreachable!("operators have order 2, 4 or 6"),
    }
}
