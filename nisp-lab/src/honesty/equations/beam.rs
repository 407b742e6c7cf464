//! A beam on two supports under an unknown load whose sum is known.

use std::f64::consts::PI;

use nisp::Points;
use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{
    Exact, Few, Gap, Mirrored, Moved, Nothing, Outliers, Parameter, Physics, Scaled,
};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;

interpret! {
    /// Euler's and Bernoulli's beam; its moment is a field of its own.
    mod beam {
        coordinates: x [m];
        fields: w [mm], M [N m];
        sources: q [N/m];
        parameters: EI [N m^2] > 0 = 100, total [N];
        on span {
            moment: M == EI * d(w, x, 2);
            balance: d(M, x, 2) == q;
            weighed: integral(q) == total;
        }
        on left { held: w == 0; hinged: M == 0; }
        on right { held: w == 0; hinged: M == 0; }
        on gauges { observe w; }
        scene recover { }
    }
}

const EI: f64 = 100.0;
/// Half waves of the deflection in mm.
const WAVES: [f64; 3] = [2.0, 0.6, 0.05];

/// A sum of half waves, each times a factor of its number.
fn waves(x: f64, factor: impl Fn(f64) -> f64) -> f64 {
    let own = |(n, amplitude): (f64, f64)| amplitude * factor(n) * (n * PI * x).sin();
    [1.0, 2.0, 3.0].into_iter().zip(WAVES).map(own).sum()
}

/// In N/m.
fn load(x: f64) -> f64 {
    1e-3 * EI * waves(x, |n| (n * PI).powi(4))
}

/// In the other physics the beam is pulled along as well. A load on the supports bends nothing: whatever is missing of the sum may
/// lie there, so that the sum refutes nothing.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let gauges = line(0.0, 1.0, 60);
        // A pull of 1000 N along the beam, which half wave n bends by EI (n pi)^4 / (EI (n pi)^4 + 1000 (n pi)^2) as much.
        let pull = if physics == Kind::Other { 1000.0 } else { 0.0 };
        let w = gauges.iter().map(|&x| waves(x, |n| 1.0 / (1.0 + pull / (EI * (n * PI).powi(2))))).collect();
        let points = line(0.05, 0.95, 91);
        let span = line(0.0, 1.0, 121);
        let weights = vec![1.0 / 120.0; 121].into_iter().enumerate();
        let weights = weights.map(|(i, weight)| if i == 0 || i == 120 { weight / 2.0 } else { weight }).collect();
        let stated = |x| Stated { head: "w", at: vec![x], value: 0.0, size: 2.0 };
        // The integral of half wave n over the beam is 2 / (n pi) where n is odd.
        let total: f64 = [(1.0, WAVES[0]), (3.0, WAVES[2])]
            .into_iter()
            .map(|(n, amplitude)| 1e-3 * EI * amplitude * (n * PI).powi(4) * 2.0 / (n * PI))
            .sum();
        let plain = Plain {
            scene: beam::scene("recover"),
            groups: vec![
                ("span", Points { coordinates: span, weights, ..Points::default() }, vec![]),
                ("left", vec![0.0].into(), vec![]),
                ("right", vec![1.0].into(), vec![]),
            ],
            observed: "gauges",
            stated: [0.0, 1.0].map(stated).into(),
            truth: Truth { heads: vec![("q", points.iter().map(|&x| load(x)).collect())], points, ..Truth::default() },
        };
        let experiment = plain.measured(Samples::default().at("x", gauges).of("w", w), 0.005);
        Ok(experiment.with("total", total))
    };
    let told = [Nothing, Exact, Few(20), Gap(0.4, 0.6), Moved("x", 0.15), Outliers(0.05)];
    let hidden = [Physics, Parameter("EI", 300.0), Scaled("w", 1e3), Mirrored("w", 0.0), Mirrored("x", 0.5)];
    Subject { name: "beam", make: Box::new(make), cases: cases(&told, &hidden), patience: 1.0 }
}
