//! An elliptic equation on a line whose rate of reaction is unknown.

use std::f64::consts::PI;

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Mirrored, Moved, Nothing, Outliers, Parameter, Scaled};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, cases, line};
use super::super::samples::Samples;

interpret! {
    /// Diffusion and reaction under a known load.
    mod rate {
        units: off;
        coordinates: x;
        fields: u;
        sources: k >= 0;
        parameters: l = 0.02;
        on inside { columns: load; law: -l * d(u, x, 2) + k * u == load; }
        on left { held: u == 0; }
        on right { held: u == 0; }
        on gauges { observe u; }
        scene recover { }
    }
}

const L: f64 = 0.02;

fn field(x: f64) -> f64 {
    (PI * x).sin() * (1.0 + 0.4 * x)
}

fn bend(x: f64) -> f64 {
    -PI * PI * (PI * x).sin() * (1.0 + 0.4 * x) + 0.8 * PI * (PI * x).cos()
}

fn true_rate(x: f64) -> f64 {
    0.3 + 1.2 * (-((x - 0.4) / 0.15).powi(2)).exp()
}

/// A wrong diffusivity is another rate, as long as it is not negative.
pub(super) fn subject() -> Subject {
    let make = |_: Kind| {
        let places = line(0.0, 1.0, 120);
        let load = places.iter().map(|&x| -L * bend(x) + true_rate(x) * field(x)).collect();
        // Where the field is near zero, at the ends, no data say anything of its rate.
        let points = line(0.1, 0.9, 81);
        let gauges = line(0.0, 1.0, 100);
        let stated = |x| Stated { head: "u", at: vec![x], value: 0.0, size: 1.0 };
        let plain = Plain {
            scene: rate::scene("recover"),
            groups: vec![
                ("inside", places.into(), vec![load]),
                ("left", vec![0.0].into(), vec![]),
                ("right", vec![1.0].into(), vec![]),
            ],
            observed: "gauges",
            stated: [0.0, 1.0].map(stated).into(),
            truth: Truth {
                heads: vec![("k", points.iter().map(|&x| true_rate(x)).collect())],
                points,
                ..Truth::default()
            },
        };
        let u = gauges.iter().map(|&x| field(x)).collect();
        Ok(plain.measured(Samples::default().at("x", gauges).of("u", u), 0.01))
    };
    let told = [
        Nothing,
        Exact,
        Few(25),
        Parameter("l", 0.3),
        Scaled("u", 1e3),
        Moved("x", 0.25),
        Mirrored("u", 0.0),
        Outliers(0.05),
    ];
    Subject { name: "rate", make: Box::new(make), cases: cases(&told, &[Mirrored("x", 0.5)]), patience: 1.0 }
}
