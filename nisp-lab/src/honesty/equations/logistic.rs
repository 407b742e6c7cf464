//! Growth that its own size slows down, with unknown rate and capacity.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Early, Exact, Few, Moved, Nothing, Outliers, Physics, Scaled};
use super::super::experiment::{Physics as Kind, Plain, Subject, Truth, cases, line};
use super::super::samples::Samples;

interpret! {
    /// Verhulst's equation.
    mod logistic {
        coordinates: t [h];
        fields: n [1];
        parameters: r [1/h] in 1e-3 .. 100 = 1, k in 1e-2 .. 1e6 = 2;
        on course { growth: k * d(n, t) == r * n * (k - n); }
        on samples { observe n; }
        scene identify { learn r, k; }
    }
}

const RATE: f64 = 0.8;
const CAPACITY: f64 = 3.0;

/// The other physics is Gompertz's growth. A population in other units scales the capacity.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, 12.0, 60);
        let grown = |t: &f64| match physics {
            Kind::Scene | Kind::Stated(_) => CAPACITY / (1.0 + 29.0 * (-RATE * t).exp()),
            Kind::Other => CAPACITY * (-30.0_f64.ln() * (-0.4 * t).exp()).exp(),
        };
        let n = times.iter().map(grown).collect();
        let plain = Plain {
            scene: logistic::scene("identify"),
            groups: vec![("course", times.clone().into(), vec![])],
            observed: "samples",
            stated: vec![],
            truth: Truth { scalars: vec![("r", RATE), ("k", CAPACITY)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("n", n), 0.02))
    };
    let told = [Nothing, Exact, Few(10), Physics, Moved("n", 1.5), Outliers(0.1), Early(2)];
    Subject { name: "logistic", make: Box::new(make), cases: cases(&told, &[Scaled("n", 1e3)]), patience: 1.0 }
}
