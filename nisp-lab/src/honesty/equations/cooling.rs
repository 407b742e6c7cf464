//! A body in a shell that cools in air, heated by an unknown power.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Gap, Moved, Nothing, Outliers, Parameter, Physics, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// Newton's cooling of a body through its shell.
    mod cooling {
        coordinates: t [s];
        fields: body [K], shell [K];
        sources: q [W];
        parameters:
            C1 [J/K] > 0 = 400, C2 [J/K] > 0 = 150, k [W/K] > 0 = 4, h [W/K] > 0 = 1.5, air [K] = 293;
        on course {
            inner: C1 * d(body, t) == q - k * (body - shell);
            outer: C2 * d(shell, t) == k * (body - shell) - h * (shell - air);
        }
        on start { off: q == 0; }
        on samples { observe body, shell; }
        scene recover { }
    }
}

const LAST: f64 = 600.0;

fn power(t: f64) -> f64 {
    60.0 * (std::f64::consts::PI * t / LAST).sin().powi(2)
}

/// In the other physics the shell loses heat by the square of its warmth. A wrong heat capacity of the body is another power.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, LAST, 100);
        let slope = |t, [body, shell]: [f64; 2]| {
            let warmth: f64 = shell - 293.0;
            let loss = if physics == Kind::Other { 0.08 * warmth * warmth.abs() } else { 1.5 * warmth };
            [(power(t) - 4.0 * (body - shell)) / 400.0, (4.0 * (body - shell) - loss) / 150.0]
        };
        let states = integrate(slope, [293.0, 293.0], &times);
        let of = |at: usize| states.iter().map(|state| state[at]).collect();
        let plain = Plain {
            scene: cooling::scene("recover"),
            groups: vec![("course", line(0.0, LAST, 200).into(), vec![]), ("start", vec![0.0].into(), vec![])],
            observed: "samples",
            stated: vec![Stated { head: "q", at: vec![0.0], value: 0.0, size: 60.0 }],
            truth: Truth {
                heads: vec![("q", times.iter().map(|&t| power(t)).collect())],
                points: times.clone(),
                ..Truth::default()
            },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("body", of(0)).of("shell", of(1)), 0.01))
    };
    let told = [
        Nothing,
        Exact,
        Few(20),
        Gap(0.4, 0.6),
        Physics,
        Parameter("k", 12.0),
        Parameter("h", 4.0),
        Moved("shell", -273.15),
        Swapped("body", "shell"),
        Outliers(0.05),
    ];
    Subject { name: "cooling", make: Box::new(make), cases: cases(&told, &[Parameter("C1", 800.0)]), patience: 1.0 }
}
