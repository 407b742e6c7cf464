//! A substance that turns into a second and that into a third, both rates unknown.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Gap, Nothing, Outliers, Physics, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// Two reactions of first order, one after the other.
    mod reaction {
        coordinates: t [s];
        fields: a [mol/m^3], b [mol/m^3];
        parameters: k1 [1/s] in 1e-3 .. 100 = 1, k2 [1/s] in 1e-3 .. 100 = 1, a0 [mol/m^3] = 5;
        on course { first: d(a, t) == -k1 * a; second: d(b, t) == k1 * a - k2 * b; }
        on start { filled: a == a0; empty: b == 0; }
        on samples { observe a, b; }
        scene identify { learn k1, k2; }
    }
}

const FIRST: f64 = 0.7;
const SECOND: f64 = 0.3;
const FILLED: f64 = 5.0;

/// In the other physics the first reaction is of second order.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, 8.0, 60);
        let order = if physics == Kind::Other { 2 } else { 1 };
        let slope = |_, [a, b]: [f64; 2]| [-FIRST * a.powi(order), FIRST * a.powi(order) - SECOND * b];
        let states = integrate(slope, [FILLED, 0.0], &times);
        let of = |at: usize| states.iter().map(|state| state[at]).collect();
        let stated = |(head, value)| Stated { head, at: vec![0.0], value, size: FILLED };
        let plain = Plain {
            scene: reaction::scene("identify"),
            groups: vec![("course", times.clone().into(), vec![]), ("start", vec![0.0].into(), vec![])],
            observed: "samples",
            stated: [("a", FILLED), ("b", 0.0)].map(stated).into(),
            truth: Truth { scalars: vec![("k1", FIRST), ("k2", SECOND)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("a", of(0)).of("b", of(1)), 0.02))
    };
    let told = [
        Nothing,
        Exact,
        Few(12),
        Gap(0.1, 0.5),
        Physics,
        Swapped("a", "b"),
        Scaled("b", 1e3),
        Scaled("a", 2.0),
        Outliers(0.1),
    ];
    Subject { name: "reaction", make: Box::new(make), cases: cases(&told, &[]), patience: 1.0 }
}
