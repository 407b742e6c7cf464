//! Poisson's equation on a square with an unknown source, from gauges inside.

use std::f64::consts::PI;

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Early, Exact, Few, Moved, Nothing, Outliers, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, axis, cases, lattice, line};
use super::super::samples::Samples;

interpret! {
    /// A membrane under an unknown pressure, in plain numbers.
    mod poisson {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f;
        on inside { balance: -laplacian(u) == f; }
        on edge { held: u == 0; }
        on gauges { observe u; }
        scene recover { }
    }
}

fn field(x: f64, y: f64) -> f64 {
    (PI * x).sin() * (PI * y).sin() * (1.0 + x)
}

fn load(x: f64, y: f64) -> f64 {
    2.0 * PI * PI * field(x, y) - 2.0 * PI * (PI * x).cos() * (PI * y).sin()
}

/// Other units of the data are another source, and the square looks the same along both axes.
pub(super) fn subject() -> Subject {
    let make = |_: Kind| {
        let gauges = lattice(&line(0.05, 0.95, 14), &line(0.05, 0.95, 14));
        let (x, y) = (axis(&gauges, 0), axis(&gauges, 1));
        let u = x.iter().zip(&y).map(|(&x, &y)| field(x, y)).collect();
        let points = lattice(&line(0.1, 0.9, 9), &line(0.1, 0.9, 9));
        let (across, up) = (axis(&points, 0), axis(&points, 1));
        let sides = [lattice(&line(0.0, 1.0, 15), &[0.0, 1.0]), lattice(&[0.0, 1.0], &line(0.0, 1.0, 15))];
        let plain = Plain {
            scene: poisson::scene("recover"),
            groups: vec![
                ("inside", lattice(&line(0.0, 1.0, 16), &line(0.0, 1.0, 16)).into(), vec![]),
                ("edge", sides.concat().into(), vec![]),
            ],
            observed: "gauges",
            stated: vec![Stated { head: "u", at: vec![0.0, 0.5], value: 0.0, size: 1.0 }],
            truth: Truth {
                heads: vec![("f", across.iter().zip(&up).map(|(&x, &y)| load(x, y)).collect())],
                points,
                ..Truth::default()
            },
        };
        Ok(plain.measured(Samples::default().at("x", x).at("y", y).of("u", u), 0.005))
    };
    let told = [Nothing, Exact, Few(50), Moved("x", 0.2), Moved("u", 1.0), Scaled("x", 1e3), Outliers(0.05), Early(3)];
    Subject {
        name: "poisson",
        make: Box::new(make),
        cases: cases(&told, &[Scaled("u", 1e3), Swapped("x", "y")]),
        patience: 1.0,
    }
}
