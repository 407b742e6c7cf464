//! A pendulum of unknown length that swings far, from its angle.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Moved, Nothing, Parameter, Physics, Scaled};
use super::super::experiment::{Physics as Kind, Plain, Subject, Truth, cases, line};
use super::super::samples::Samples;
use crate::rk4::integrate;

interpret! {
    /// A pendulum without friction.
    mod swing {
        coordinates: t [s];
        fields: theta [rad];
        parameters: l [m] in 0.01 .. 100 = 1, g [m/s^2] = 9.81;
        on motion { balance: l * d(theta, t, 2) + g * sin(theta) == 0; }
        on samples { observe theta; }
        scene identify { learn l; }
    }
}

const LENGTH: f64 = 0.6;
const GRAVITY: f64 = 9.81;

/// The other physics is friction. A wrong gravity scales the length.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let times = line(0.0, 4.0, 100);
        let friction = if physics == Kind::Other { 0.8 } else { 0.0 };
        let slope = |_, [angle, rate]: [f64; 2]| [rate, -GRAVITY / LENGTH * angle.sin() - friction * rate];
        let theta = integrate(slope, [1.2, 0.0], &times).into_iter().map(|[angle, _]| angle).collect();
        let plain = Plain {
            scene: swing::scene("identify"),
            groups: vec![("motion", times.clone().into(), vec![])],
            observed: "samples",
            stated: vec![],
            truth: Truth { scalars: vec![("l", LENGTH)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("t", times).of("theta", theta), 0.02))
    };
    let told = [Nothing, Exact, Few(20), Physics, Scaled("theta", 180.0 / std::f64::consts::PI), Moved("theta", 0.5)];
    Subject { name: "swing", make: Box::new(make), cases: cases(&told, &[Parameter("g", 3.7)]), patience: 1.0 }
}
