//! Lorenz's equations with all three coefficients unknown.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Nothing, Outliers, Physics, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// Lorenz's equations.
    mod lorenz {
        units: off;
        coordinates: t;
        fields: x, y, z;
        parameters: a = 8, b = 10, c = 2;
        on flow {
            first: d(x, t) == a * (y - x);
            second: d(y, t) == x * (b - z) - y;
            third: d(z, t) == x * y - c * z;
        }
        on start { x0: x == -8; y0: y == 7; z0: z == 27; }
        on samples { observe x, y, z; }
        scene identify { learn a, b, c; }
    }
}

const TRUE: [f64; 3] = [10.0, 15.0, 8.0 / 3.0];
const START: [f64; 3] = [-8.0, 7.0, 27.0];

/// The other physics has a drain of its own in the second equation.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, 3.0, 50);
        let drain = if physics == Kind::Other { 4.0 } else { 1.0 };
        let [a, b, c] = TRUE;
        let slope = |_, [x, y, z]: [f64; 3]| [a * (y - x), x * (b - z) - drain * y, x * y - c * z];
        let states = integrate(slope, START, &times);
        let of = |at: usize| states.iter().map(|state| state[at]).collect();
        let stated = |(head, value)| Stated { head, at: vec![0.0], value, size: 10.0 };
        let plain = Plain {
            scene: lorenz::scene("identify"),
            groups: vec![("flow", line(0.0, 3.0, 100).into(), vec![]), ("start", vec![0.0].into(), vec![])],
            observed: "samples",
            stated: ["x", "y", "z"].into_iter().zip(START).map(stated).collect(),
            truth: Truth { scalars: ["a", "b", "c"].into_iter().zip(TRUE).collect(), ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("x", of(0)).of("y", of(1)).of("z", of(2)), 0.002))
    };
    let told =
        [Nothing, Exact, Few(20), Physics, Scaled("y", 1e3), Swapped("x", "z"), Swapped("x", "y"), Outliers(0.1)];
    Subject { name: "lorenz", make: Box::new(make), cases: cases(&told, &[]), patience: 1.0 }
}
