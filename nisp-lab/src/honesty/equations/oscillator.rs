//! A mass on a damped spring, both unknown, from its free motion out of a known start.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Gap, Moved, Nothing, Outliers, Parameter, Physics, Scaled};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// A mass on a damped spring.
    mod oscillator {
        coordinates: t [s];
        fields: y [m];
        parameters:
            m [kg] > 0 = 2, c [kg/s] in 1e-3 .. 100 = 1, k [N/m] in 1e-2 .. 1e4 = 20, y0 [m] = 0.1;
        on motion { balance: m * d(y, t, 2) + c * d(y, t) + k * y == 0; }
        on start { released: y == y0; at_rest: d(y, t) == 0; }
        on samples { observe y; }
        scene identify { learn c, k; }
    }
}

const M: f64 = 2.0;
const C: f64 = 0.8;
const K: f64 = 50.0;
const START: f64 = 0.1;

/// The other physics is drag with the square of the speed. A wrong mass scales both answers.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, 4.0, 120);
        let decay = C / (2.0 * M);
        let omega = (K / M - decay * decay).sqrt();
        let free = |t: &f64| START * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
        let y = match physics {
            Kind::Scene | Kind::Stated(_) => times.iter().map(free).collect(),
            Kind::Other => {
                let slope = |_, [y, v]: [f64; 2]| [v, -(8.0 * v * v.abs() + K * y) / M];
                integrate(slope, [START, 0.0], &times).into_iter().map(|[y, _]| y).collect()
            }
        };
        let plain = Plain {
            scene: oscillator::scene("identify"),
            groups: vec![("motion", times.clone().into(), vec![]), ("start", vec![0.0].into(), vec![])],
            observed: "samples",
            stated: vec![Stated { head: "y", at: vec![0.0], value: START, size: START }],
            truth: Truth { scalars: vec![("c", C), ("k", K)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("y", y), 0.02))
    };
    let told = [
        Nothing,
        Exact,
        Few(15),
        Gap(0.3, 0.6),
        Physics,
        Scaled("y", 1e3),
        Moved("t", 0.3),
        Moved("y", 0.05),
        Outliers(0.1),
    ];
    Subject { name: "oscillator", make: Box::new(make), cases: cases(&told, &[Parameter("m", 4.0)]), patience: 1.0 }
}
