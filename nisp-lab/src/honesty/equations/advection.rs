//! A cloud of dye that a stream of unknown speed carries.

use nisp_interpreter::interpret;

use super::super::corruption::Corruption::{Exact, Few, Mirrored, Nothing, Outliers, Physics, Scaled, Swapped};
use super::super::experiment::{Physics as Kind, Plain, Subject, Truth, axis, cases, lattice, line};
use super::super::samples::Samples;

interpret! {
    /// Transport without spreading.
    mod advection {
        coordinates: x [m], t [s];
        fields: u [1];
        parameters: c [m/s] in -10 .. 10 = 1;
        on stream { carried: d(u, t) + c * d(u, x) == 0; }
        on samples { observe u; }
        scene identify { learn c; }
    }
}

const SPEED: f64 = 0.4;

/// In the other physics the dye spreads and decays. Mirrored, the stream goes the other way; with places and times swapped it
/// has the inverse speed.
pub(super) fn subject() -> Subject {
    let make = |physics: Kind| {
        let samples = lattice(&line(0.0, 2.0, 20), &line(0.0, 1.0, 8));
        let (x, t) = (axis(&samples, 0), axis(&samples, 1));
        let dye = |(&x, &t): (&f64, &f64)| {
            let (width, decay) = if physics == Kind::Other { (0.3 + 0.2 * t, 1.5) } else { (0.3, 0.0) };
            let away: f64 = x - SPEED * t - 0.7;
            (-decay * t - (away / width).powi(2)).exp()
        };
        let u = x.iter().zip(&t).map(dye).collect();
        let plain = Plain {
            scene: advection::scene("identify"),
            groups: vec![("stream", lattice(&line(0.0, 2.0, 25), &line(0.0, 1.0, 12)).into(), vec![])],
            observed: "samples",
            stated: vec![],
            truth: Truth { scalars: vec![("c", SPEED)], ..Truth::default() },
        };
        Ok(plain.measured(Samples::default().at("x", x).at("t", t).of("u", u), 0.02))
    };
    let told =
        [Nothing, Exact, Few(40), Physics, Scaled("x", 1e3), Scaled("u", 1e3), Swapped("x", "t"), Outliers(0.05)];
    Subject { name: "advection", make: Box::new(make), cases: cases(&told, &[Mirrored("x", 1.0)]), patience: 1.0 }
}
