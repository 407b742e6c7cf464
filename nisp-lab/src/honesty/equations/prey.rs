//! Predators and prey under an unknown harvest of the prey.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Gap, Nothing, Outliers, Parameter, Physics, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// Lotka's and Volterra's equations with a harvest.
    mod prey {
        units: off;
        coordinates: t;
        fields: x, y;
        sources: h;
        parameters: a = 1, b = 0.5, c = 0.3, e = 0.6;
        on course {
            prey: d(x, t) == a * x - b * x * y - h;
            predators: d(y, t) == c * x * y - e * y;
        }
        on samples { observe x, y; }
        scene recover { }
    }
}

const LAST: f64 = 10.0;

fn harvest(t: f64) -> f64 {
    0.1 + 0.5 * (-((t - 5.0) / 1.5).powi(2)).exp()
}

/// In the other physics predators compete with each other. A wrong growth of the prey is another harvest,
/// and so are predators that are counted in thousands.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, LAST, 120);
        let rivalry = if physics == Kind::Other { 0.2 } else { 0.0 };
        let slope = |t, [x, y]: [f64; 2]| [x - 0.5 * x * y - harvest(t), 0.3 * x * y - 0.6 * y - rivalry * y * y];
        let states = integrate(slope, [3.0, 1.5], &times);
        let of = |at: usize| states.iter().map(|state| state[at]).collect();
        let plain = Plain {
            scene: prey::scene("recover"),
            groups: vec![("course", line(0.0, LAST, 200).into(), vec![])],
            observed: "samples",
            stated: vec![],
            truth: Truth {
                heads: vec![("h", times.iter().map(|&t| harvest(t)).collect())],
                points: times.clone(),
                ..Truth::default()
            },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("x", of(0)).of("y", of(1)), 0.01))
    };
    let told = [
        Nothing,
        Exact,
        Few(25),
        Gap(0.4, 0.6),
        Physics,
        Parameter("c", 0.6),
        Parameter("e", 0.9),
        Swapped("x", "y"),
        Outliers(0.05),
    ];
    Subject {
        name: "prey",
        make: Box::new(make),
        cases: cases(&told, &[Parameter("a", 2.0), Scaled("y", 1e3)]),
        patience: 1.0,
    }
}
