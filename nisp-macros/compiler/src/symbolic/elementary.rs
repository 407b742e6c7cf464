//! Elementary functions: parities and exact values, one table each.

use num_traits::{One, Signed, Zero};

use crate::model::Function;
use crate::rational::{Rational, ratio};

/// How a function reacts to the sign of its argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Parity {
    /// `f(-x) = f(x)`
    Even,
    /// `f(-x) = -f(x)`
    Odd,
    /// Neither.
    None,
}

/// The function's parity.
pub(super) fn parity(function: Function) -> Parity {
    use Function::*;
    match function {
        Cos | Cosh | Abs => Parity::Even,
        Sin | Tan | Asin | Atan | Sinh | Tanh | Sign => Parity::Odd,
        Acos | Exp | Ln | Sqrt | Step | Softplus | Sigmoid => Parity::None,
    }
}

/// The function's value at an exact number, where that is exact too.
pub(super) fn exact_value(function: Function, x: Rational) -> Option<Rational> {
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
