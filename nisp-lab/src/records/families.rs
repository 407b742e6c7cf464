//! Equations of records, each with a way to draw a truth.

use nisp::{SceneRef, scene};
use nisp_equations::{pendulum::pendulum, rlc::rlc};
use nisp_interpreter::interpret;

use super::draws::{Course, bent, circuit, course, heated, pushed, regulated};
use super::drive::Drive;
use crate::random::Random;
use crate::rk4::integrate;

/// An equation.
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) scene: SceneRef,
    /// The group of the equations, and that of the measurements.
    pub(super) law: &'static str,
    pub(super) samples: &'static str,
    /// The unknown source.
    pub(super) source: &'static str,
    /// Conditions, with where they hold as a share of the span.
    pub(super) conditions: &'static [(&'static str, f64)],
    pub(super) span: f64,
    /// True if noise is in declared units, and not in spreads of each column.
    pub(super) absolute: bool,
    /// The truth at rising places, the first of which is zero.
    pub(super) draw: fn(&mut Random, &[f64]) -> Course,
}

interpret! {
    /// An oscillator with a hardening spring.
    mod duffing {
        coordinates: t [s];
        fields: y [V];
        sources: u [V];
        parameters: m [s^2] = 4e-2, c [s] = 4e-2, a = 1, b [1/V^2] = 3;
        on motion { balance: m * d(y, t, 2) + c * d(y, t) + a * y + b * y^3 == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// Van der Pol's oscillator under a drive.
    mod pol {
        coordinates: t [s];
        fields: x;
        sources: u [1/s^2];
        parameters: mu [1/s] = 1, k [1/s^2] = 1;
        on motion { balance: d(x, t, 2) - mu * (1 - x^2) * d(x, t) + k * x == u; }
        on samples { observe x; }
        scene recover { }
    }
}

interpret! {
    /// A cart with friction.
    mod cart {
        coordinates: t [s];
        fields: x [m];
        sources: F [N];
        parameters: m [kg] = 2, c [kg/s] = 0.8;
        on motion { balance: m * d(x, t, 2) + c * d(x, t) == F; }
        on samples { observe x; }
        scene recover { }
    }
}

interpret! {
    /// Lorenz's equations, the first of them driven.
    mod lorenz {
        units: off;
        coordinates: t;
        fields: x, y, z;
        sources: f;
        parameters: s = 10, r = 28, b = 2.667;
        on flow {
            first: d(x, t) == s * (y - x) + f;
            second: d(y, t) == x * (r - z) - y;
            third: d(z, t) == x * y - b * z;
        }
        on samples { observe x, y, z; }
        scene recover { }
    }
}

interpret! {
    /// Lotka's and Volterra's equations with a harvest of the prey.
    mod prey {
        units: off;
        coordinates: t;
        fields: x, y;
        sources: h;
        parameters: a = 1, b = 0.8, c = 0.6, e = 0.9;
        on growth {
            prey: d(x, t) == a * x - b * x * y - h;
            predators: d(y, t) == c * x * y - e * y;
        }
        on samples { observe x, y; }
        scene recover { }
    }
}

interpret! {
    /// A tank that empties through a hole, and what flows in.
    mod tank {
        coordinates: t [s];
        fields: h [m];
        sources: q [m^3/s];
        parameters: A [m^2] = 0.5, k [m^3/s] = 0.05, h0 [m] = 1;
        on level { balance: A * d(h, t) + k * sqrt(h / h0) == q; }
        on samples { observe h; }
        scene recover { }
    }
}

interpret! {
    /// Two reactions in a row, the first of second order, and what is fed.
    mod reaction {
        coordinates: t [s];
        fields: a [mol/m^3], b [mol/m^3];
        sources: u [mol/(m^3 s)];
        parameters: k [m^3/(mol s)] = 0.4, l [1/s] = 0.3;
        on reactor {
            fed: d(a, t) == u - k * a^2;
            made: d(b, t) == k * a^2 - l * b;
        }
        on samples { observe a, b; }
        scene recover { }
    }
}

interpret! {
    /// A beam on two supports under an unknown load.
    mod beam {
        coordinates: x [m];
        fields: w [mm], M [N m];
        sources: q [N/m];
        parameters: EI [N m^2] > 0 = 100;
        on span {
            moment: M == EI * d(w, x, 2);
            balance: d(M, x, 2) == q;
        }
        on left { held: w == 0; hinged: M == 0; }
        on right { held: w == 0; hinged: M == 0; }
        on gauges { observe w; }
        scene recover { }
    }
}

interpret! {
    /// A rod that loses heat along its length and is heated somewhere.
    mod rod {
        coordinates: x [m];
        fields: T [K];
        sources: q [W/m];
        parameters: k [W m/K] = 0.02, h [W/(m K)] = 0.2;
        on inside { conduction: -k * d(T, x, 2) + h * T == q; }
        on probes { observe T; }
        scene recover { }
    }
}

/// All of them.
pub(super) fn families() -> Vec<Family> {
    let plain = |name, scene, law, source, span, draw| Family {
        name,
        scene,
        law,
        samples: "samples",
        source,
        conditions: &[],
        span,
        absolute: false,
        draw,
    };
    let of_pendulum = scene::<pendulum::recover::Scene>();
    let of_rlc = scene::<rlc::recover::Scene>();
    vec![
        Family { absolute: true, ..plain("pendulum", of_pendulum, "motion", "f", 4.0, regulated) },
        Family { absolute: true, ..plain("pushed", of_pendulum, "motion", "f", 4.0, pushed) },
        Family { conditions: &[("start", 0.0)], ..plain("rlc", of_rlc, "circuit", "f", 2.0, circuit) },
        plain("duffing", duffing::scene("recover"), "motion", "u", 6.0, |random, t| {
            let drive = Drive::draw(random, 6.0, 0.3);
            let start = [0.3 * random.normal(), 0.3 * random.normal()];
            let slope = |t: f64, [y, v]: [f64; 2]| [v, (drive.at(t) - 4e-2 * v - y - 3.0 * y.powi(3)) / 4e-2];
            course(&drive, t, integrate(slope, start, t), 1)
        }),
        plain("van der pol", pol::scene("recover"), "motion", "u", 12.0, |random, t| {
            let drive = Drive::draw(random, 12.0, 1.5);
            let start = [random.normal(), random.normal()];
            let slope = |t: f64, [x, v]: [f64; 2]| [v, drive.at(t) + (1.0 - x * x) * v - x];
            course(&drive, t, integrate(slope, start, t), 1)
        }),
        plain("cart", cart::scene("recover"), "motion", "F", 10.0, |random, t| {
            let drive = Drive::draw(random, 10.0, 3.0);
            let slope = |t: f64, [_, v]: [f64; 2]| [v, (drive.at(t) - 0.8 * v) / 2.0];
            course(&drive, t, integrate(slope, [0.0, random.normal()], t), 1)
        }),
        plain("lorenz", lorenz::scene("recover"), "flow", "f", 4.0, |random, t| {
            let drive = Drive::draw(random, 4.0, 40.0);
            let start = [5.0 * random.normal(), 5.0 * random.normal(), 20.0 + 5.0 * random.normal()];
            let slope =
                |t: f64, [x, y, z]: [f64; 3]| [10.0 * (y - x) + drive.at(t), x * (28.0 - z) - y, x * y - 2.667 * z];
            course(&drive, t, integrate(slope, start, t), 3)
        }),
        plain("prey", prey::scene("recover"), "growth", "h", 15.0, |random, t| {
            let drive = Drive::draw(random, 15.0, 0.08);
            let start = [1.0 + random.uniform(), 0.5 + random.uniform()];
            let slope = |t: f64, [x, y]: [f64; 2]| [x - 0.8 * x * y - drive.at(t), 0.6 * x * y - 0.9 * y];
            course(&drive, t, integrate(slope, start, t), 2)
        }),
        plain("tank", tank::scene("recover"), "level", "q", 60.0, |random, t| {
            let drive = Drive::draw(random, 60.0, 0.02);
            let inflow = |t: f64| 0.06 + drive.at(t);
            let slope = |t: f64, [h]: [f64; 1]| [(inflow(t) - 0.05 * h.max(0.0).sqrt()) / 0.5];
            let levels = integrate(slope, [1.0 + random.uniform()], t);
            Course { source: t.iter().map(|&t| inflow(t)).collect(), ..course(&drive, t, levels, 1) }
        }),
        plain("reaction", reaction::scene("recover"), "reactor", "u", 20.0, |random, t| {
            let drive = Drive::draw(random, 20.0, 0.15);
            let feed = |t: f64| 0.4 + drive.at(t);
            let slope = |t: f64, [a, b]: [f64; 2]| [feed(t) - 0.4 * a * a, 0.4 * a * a - 0.3 * b];
            let found = integrate(slope, [random.uniform(), random.uniform()], t);
            Course { source: t.iter().map(|&t| feed(t)).collect(), ..course(&drive, t, found, 2) }
        }),
        Family {
            law: "span",
            samples: "gauges",
            conditions: &[("left", 0.0), ("right", 1.0)],
            ..plain("beam", beam::scene("recover"), "span", "q", 1.0, bent)
        },
        Family { samples: "probes", ..plain("rod", rod::scene("recover"), "inside", "q", 1.0, heated) },
    ]
}
