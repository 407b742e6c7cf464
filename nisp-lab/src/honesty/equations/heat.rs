//! Heat in a rod between ice, with unknown diffusivity, over place and time.

use std::f64::consts::PI;

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Mirrored, Moved, Nothing, Outliers, Physics, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Stated, Subject, Truth, axis, cases, lattice, line};
use super::super::samples::Samples;

interpret! {
    /// Fourier's equation.
    mod heat {
        coordinates: x [m], t [s];
        fields: u [K];
        parameters: a [m^2/s] in 1e-4 .. 10 = 0.1;
        on rod { diffusion: d(u, t) == a * d(u, x, 2); }
        on ends { ice: u == 0; }
        on samples { observe u; }
        scene identify { learn a; }
    }
}

const DIFFUSIVITY: f64 = 0.05;

fn temperature([x, t]: [f64; 2], loss: f64) -> f64 {
    let wave = |n: f64| (n * PI * x).sin() * (-DIFFUSIVITY * (n * PI).powi(2) * t).exp();
    10.0 * (-loss * t).exp() * (wave(1.0) + 0.5 * wave(2.0))
}

/// In the other physics the rod loses heat to the air. A rod that is mirrored, or warmer all over, has the same diffusivity.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let loss = if physics == Kind::Other { 0.5 } else { 0.0 };
        let samples = lattice(&line(0.05, 0.95, 12), &line(0.0, 1.0, 10));
        let (x, t) = (axis(&samples, 0), axis(&samples, 1));
        let u = x.iter().zip(&t).map(|(&x, &t)| temperature([x, t], loss)).collect();
        let plain = Plain {
            scene: heat::scene("identify"),
            groups: vec![
                ("rod", lattice(&line(0.0, 1.0, 20), &line(0.0, 1.0, 15)).into(), vec![]),
                ("ends", lattice(&[0.0, 1.0], &line(0.0, 1.0, 15)).into(), vec![]),
            ],
            observed: "samples",
            stated: vec![Stated { head: "u", at: vec![0.0, 0.5], value: 0.0, size: 10.0 }],
            truth: Truth { scalars: vec![("a", DIFFUSIVITY)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("x", x).at("t", t).of("u", u), 0.02))
    };
    let told = [
        Nothing,
        Exact,
        Few(30),
        Physics,
        Mirrored("x", 0.5),
        Moved("x", 0.2),
        Moved("u", 5.0),
        Scaled("u", 1e3),
        Scaled("x", 1e3),
        Swapped("x", "t"),
        Outliers(0.05),
    ];
    Subject { name: "heat", make: Box::new(make), cases: cases(&told, &[]), patience: 1.0 }
}
