//! Problems in which nothing is measured, with closed forms, as texts that are read as `nisp solve` reads them; and the same problems
//! with a condition or a sign that is wrong.

use std::f64::consts::PI;
use std::fs;

use nisp::Carrier;
use nisp_equations::{Entry, Request};

use super::corruption::Corruption::{Nothing, Stated};
use super::experiment::{Experiment, Physics, Ready, Subject, Truth, cases, lattice, line};
use super::samples::Samples;

/// Mean error over the mean magnitude of a field from which on it is wrong: a solver has no noise to speak for it.
const OFF: f64 = 5e-3;

/// An equation over two coordinates from zero on. Its first scene is right.
struct Forward {
    name: &'static str,
    text: &'static str,
    /// Where the second coordinate ends; the first one ends at 1.
    end: f64,
    exact: fn(f64, f64) -> f64,
    /// Scenes that have no answer, many, or one that is lost in rounding.
    told: &'static [&'static str],
    /// Scenes that are right problems of their own.
    hidden: &'static [&'static str],
}

const HEAT: Forward = Forward {
    name: "forward heat",
    text: "units: off; coordinates: x, t: time; fields: u;
        domains: rod = 0 .. 1 times 0 .. 1;
        let shape = sin(pi * x) + 0.5 * sin(3 * pi * x);
        on inside in rod { balance: d(u, t) == 0.1 * d(u, x, 2); wrong: d(u, t) == -0.1 * d(u, x, 2); }
        on ends boundary of rod { held: u == 0; }
        on begin start of rod { first: u == shape; }
        on late end of rod { last: u == shape; }
        scene right { only inside.balance, ends, begin; }
        scene unbegun { only inside.balance, ends; }
        scene begun_late { only inside.balance, ends, late; }
        scene backward { only inside.wrong, ends, begin; }",
    end: 1.0,
    exact: |x, t| {
        let wave = |n: f64| (n * PI * x).sin() * (-0.1 * (n * PI).powi(2) * t).exp();
        wave(1.0) + 0.5 * wave(3.0)
    },
    told: &["unbegun", "begun_late", "backward"],
    hidden: &[],
};

const WAVE: Forward = Forward {
    name: "forward wave",
    text: "units: off; coordinates: x, t: time; fields: u;
        domains: string = 0 .. 1 times 0 .. 1.5;
        on inside in string { balance: d(u, t, 2) == d(u, x, 2); wrong: d(u, t, 2) == -d(u, x, 2); }
        on ends boundary of string { held: u == 0; }
        on begin start of string { first: u == sin(pi * x) + 0.3 * sin(2 * pi * x); rest: d(u, t) == 0; }
        scene right { only inside.balance, ends, begin; }
        scene without_speed { only inside.balance, ends, begin.first; }
        scene elliptic { only inside.wrong, ends, begin; }",
    end: 1.5,
    exact: |x, t| (PI * x).sin() * (PI * t).cos() + 0.3 * (2.0 * PI * x).sin() * (2.0 * PI * t).cos(),
    told: &["without_speed"],
    // Waves that grow instead of swinging: the conditions have such an answer too.
    hidden: &["elliptic"],
};

const POISSON: Forward = Forward {
    name: "forward poisson",
    text: "units: off; coordinates: x, y; fields: u;
        domains: plate = box(0 .. 1, 0 .. 1);
        let shape = sin(pi * x) * sin(pi * y) * (1 + x);
        let load = 2 * pi^2 * shape - 2 * pi * cos(pi * x) * sin(pi * y);
        on inside in plate { balance: -laplacian(u) == load; wrong: laplacian(u) == load; }
        on edge boundary of plate {
            columns: normal: vector [1];
            held: u == 0;
            three: (1 - normal[0]) * u == 0;
        }
        scene right { only inside.balance, edge.held; }
        scene three_sides { only inside.balance, edge.three; }
        scene upside_down { only inside.wrong, edge.held; }",
    end: 1.0,
    exact: |x, y| (PI * x).sin() * (PI * y).sin() * (1.0 + x),
    told: &["three_sides"],
    hidden: &["upside_down"],
};

const ADVECTION: Forward = Forward {
    name: "forward advection",
    text: "units: off; coordinates: x, t: time; fields: u;
        domains: pipe = 0 .. 1 times 0 .. 1;
        let shape = sin(2 * (x - t)) + 0.5 * cos(3 * (x - t));
        let fed = -sin(2 * t) + 0.5 * cos(3 * t);
        on inside in pipe { balance: d(u, t) + d(u, x) == 0; }
        on ends boundary of pipe {
            columns: normal: vector [1];
            inlet: (1 - normal[0]) * (u - fed) == 0;
            outlet: (1 + normal[0]) * (u - fed) == 0;
        }
        on begin start of pipe { first: u == shape; }
        scene right { only inside, ends.inlet, begin; }
        scene fed_at_the_outlet { only inside, ends.outlet, begin; }
        scene not_fed { only inside, begin; }",
    end: 1.0,
    exact: |x, t| (2.0 * (x - t)).sin() + 0.5 * (3.0 * (x - t)).cos(),
    told: &["fed_at_the_outlet", "not_fed"],
    hidden: &[],
};

const PLUME: Forward = Forward {
    name: "forward plume",
    text: "units: off; coordinates: x, t: time; fields: u;
        domains: river = 0 .. 1 times 0 .. 0.5;
        let shape = sqrt(0.02 / (0.02 + 0.08 * t)) * exp(-(x - 0.3 - t)^2 / (0.02 + 0.08 * t));
        on inside in river {
            balance: d(u, t) + d(u, x) == 0.02 * d(u, x, 2);
            wrong: d(u, t) + d(u, x) == -0.02 * d(u, x, 2);
        }
        on ends boundary of river { far: u == shape; }
        on begin start of river { first: u == shape; }
        scene right { only inside.balance, ends, begin; }
        scene unbegun { only inside.balance, ends; }
        scene gathering { only inside.wrong, ends, begin; }",
    end: 0.5,
    exact: |x, t| {
        let width = 0.02 + 0.08 * t;
        (0.02 / width).sqrt() * (-(x - 0.3 - t).powi(2) / width).exp()
    },
    told: &["unbegun", "gathering"],
    hidden: &[],
};

const BURGERS: Forward = Forward {
    name: "forward burgers",
    text: "units: off; coordinates: x, t: time; fields: u;
        domains: tube = 0 .. 1 times 0 .. 1;
        let shape = 0.5 * (1 - tanh((x - 0.3 - 0.5 * t) / 0.2));
        on inside in tube {
            balance: d(u, t) + u * d(u, x) == 0.05 * d(u, x, 2);
            wrong: d(u, t) + u * d(u, x) == -0.05 * d(u, x, 2);
        }
        on ends boundary of tube { held: u == shape; }
        on begin start of tube { first: u == shape; }
        scene right { only inside.balance, ends, begin; }
        scene unbegun { only inside.balance, ends; }
        scene backward { only inside.wrong, ends, begin; }",
    end: 1.0,
    exact: |x, t| 0.5 * (1.0 - ((x - 0.3 - 0.5 * t) / 0.2).tanh()),
    told: &["unbegun", "backward"],
    hidden: &[],
};

/// All of them.
pub(super) fn subjects() -> Vec<Subject> {
    [HEAT, WAVE, POISSON, ADVECTION, PLUME, BURGERS].into_iter().map(subject).collect()
}

/// What is right takes a second; what is spoiled takes all the time that it gets.
fn subject(forward: Forward) -> Subject {
    let told: Vec<_> = std::iter::once(Nothing).chain(forward.told.iter().map(|scene| Stated(scene))).collect();
    let hidden: Vec<_> = forward.hidden.iter().map(|scene| Stated(scene)).collect();
    let name = forward.name;
    let make = move |physics: Physics| experiment(&forward, physics);
    Subject { name, make: Box::new(make), cases: cases(&told, &hidden), patience: 0.4 }
}

fn experiment(forward: &Forward, physics: Physics) -> Result<Experiment, String> {
    let entry = read(forward.text)?;
    let scene = match physics {
        Physics::Stated(scene) => Some(scene.into()),
        Physics::Scene | Physics::Other => None,
    };
    let points = lattice(&line(0.0, 1.0, 21), &line(0.0, forward.end, 21));
    let values = points.as_chunks::<2>().0.iter().map(|&[x, y]| (forward.exact)(x, y)).collect();
    let truth = Truth { points, heads: vec![("u", values)], limit: Some(OFF), ..Truth::default() };
    let bind = move |_: &Samples, _: super::experiment::Told<'_>| {
        let request = Request { scene: scene.clone(), ..Request::default() };
        let problem = entry.prepare(&request).map_err(|error| error.to_string())?.problem;
        Ok(Ready { problem, carrier: Carrier::Auto, stated: Vec::new(), truth: truth.clone() })
    };
    Ok(Experiment { samples: Samples::default(), noise: 0.0, bind: Box::new(bind) })
}

/// An equation as the command line reads it from a file.
fn read(text: &str) -> Result<Entry, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let path = folder.path().join("forward.pde");
    fs::write(&path, text).map_err(|error| error.to_string())?;
    crate::entry(&path.to_string_lossy())
}
