//! An oscillator with a hardening spring and an unknown drive, from one record with many periods.

use std::f64::consts::{FRAC_PI_2, TAU};

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Early, Exact, Few, Gap, Nothing, Outliers, Parameter};
use super::super::experiment::{Physics as Kind, Plain, Subject, Truth, cases, line};
use super::super::samples::Samples;

interpret! {
    /// An oscillator with a hardening spring.
    mod duffing {
        coordinates: t [s];
        fields: y [V];
        sources: u [V];
        parameters: m [s^2] = 5e-6, c [s] = 2e-4, a = 1, b [1/V^2] = 3;
        on motion { balance: m * d(y, t, 2) + c * d(y, t) + a * y + b * y^3 == u; }
        on samples { observe y; }
        scene recover { }
    }
}

/// Frequencies in Hz, amplitudes in V and phases of the motion.
const WAVES: [(f64, f64, f64); 3] = [(11.0, 0.03, 0.3), (23.7, 0.02, 1.1), (48.1, 0.015, 4.0)];
const LAST: f64 = 0.5;

/// Motion and drive.
fn motion(t: f64) -> (f64, f64) {
    let wave = |derivative: i32| -> f64 {
        let own = |&(hertz, amplitude, phase): &(f64, f64, f64)| {
            let turned = f64::from(derivative) * FRAC_PI_2;
            amplitude * (TAU * hertz).powi(derivative) * (TAU * hertz * t + phase + turned).sin()
        };
        WAVES.iter().map(own).sum()
    };
    let y = wave(0);
    (y, 5e-6 * wave(2) + 2e-4 * wave(1) + y + 3.0 * y.powi(3))
}

/// Another drive explains the motion under any parameter and any spring.
pub(super) fn subject() -> Subject {
    let make = |_: Kind| {
        let times = line(0.0, LAST, 300);
        let (y, u): (Vec<f64>, Vec<f64>) = times.iter().map(|&t| motion(t)).unzip();
        let plain = Plain {
            scene: duffing::scene("recover"),
            groups: vec![("motion", line(0.0, LAST, 300).into(), vec![])],
            observed: "samples",
            stated: vec![],
            truth: Truth { points: times.clone(), heads: vec![("u", u)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("y", y), 0.01))
    };
    let told = [Nothing, Exact, Few(100), Gap(0.45, 0.55), Outliers(0.05), Early(2)];
    Subject { name: "duffing", make: Box::new(make), cases: cases(&told, &[Parameter("a", 2.0)]), patience: 1.0 }
}
