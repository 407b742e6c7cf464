//! What splines say of sources that a record tells little of: some are open in one direction, some cannot be told from none.

use nisp::solve::driver::{Status, WarningKind};
use nisp::{Carrier, Problem, SceneRef, Solution};
use nisp_interpreter::interpret;

use crate::{normals, solve};

interpret! {
    /// A source that is known by its effect on a leak only: multiples of exp(-3 t) have none.
    mod leak {
        units: off;
        coordinates: t;
        fields: v;
        sources: f;
        parameters: f0 = 0;
        on motion { balance: d(v, t) + v == d(f, t) + 3 * f; }
        on samples { observe v; }
        on start { known: f == f0; }
        scene recover { }
        scene free { without start.known; }
    }
}

interpret! {
    /// A mass under a force.
    mod mass {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        on motion { balance: d(x, t, 2) == f; }
        on samples { observe x; }
        scene recover { }
    }
}

/// Times from 0 to 4.
fn times(count: usize) -> Vec<f64> {
    (0..count).map(|i| 4.0 * i as f64 / (count - 1) as f64).collect()
}

/// A record of a course with noise of some deviation.
fn record(scene: SceneRef, count: usize, noise: f64, course: impl Fn(f64) -> f64) -> Problem {
    let mut normal = normals(3);
    let measured = times(count).into_iter().map(|t| course(t) + noise * normal()).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("motion", times(300).into(), vec![]).unwrap();
    problem.set_group("samples", times(count).into(), vec![measured]).unwrap();
    problem
}

/// The leak under f = sin 2t: v' + v = 2 cos 2t + 3 sin 2t.
fn leaking(t: f64) -> f64 {
    1.4 * (2.0 * t).sin() - 0.8 * (2.0 * t).cos()
}

fn said(solution: &Solution, kind: WarningKind) -> Vec<&str> {
    solution.warnings.iter().filter(|warning| warning.kind == kind).map(|warning| &warning.message[..]).collect()
}

#[test]
fn a_condition_that_closes_a_direction_is_named_with_it() {
    let mut problem = record(leak::scene("recover"), 400, 0.003, leaking);
    problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged);
    let said = said(&solution, WarningKind::Settled);
    let [said] = said[..] else { panic!("{said:?}") };
    assert!(said.starts_with("`f` rests on the condition `start.known: f == f0`"), "{said}");
    let rate = said.split("exp(").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((rate.parse::<f64>().unwrap() + 3.0).abs() < 0.3, "{said}");
}

#[test]
fn a_direction_that_nothing_closes_is_open() {
    let solution = solve(&record(leak::scene("free"), 400, 0.003, leaking), Carrier::Splines);
    let said = said(&solution, WarningKind::Undetermined);
    assert!(said.iter().any(|said| said.starts_with("the data do not determine `f`: a multiple of exp(")), "{said:?}");
}

#[test]
fn a_force_that_drowns_in_noise_is_not_called_found() {
    // Two thousandths of what the noise hides.
    let mut solution = solve(&record(mass::scene("recover"), 40, 1.0, |t| -0.002 * (3.0 * t).sin()), Carrier::Splines);
    assert_eq!(solution.status, Status::Inconsistent);
    let failed: Vec<&str> = solution.verdict.failed().map(|check| check.check).collect();
    assert_eq!(failed, ["noise", "told"]);
    assert!(solution.evaluate_with_errors(&times(5)).iter().all(|estimate| estimate.deviations.is_none()));
}

#[test]
fn a_force_that_stands_out_is_found() {
    let mut solution = solve(&record(mass::scene("recover"), 40, 0.01, |t| -(3.0 * t).sin()), Carrier::Splines);
    assert_eq!(solution.status, Status::Converged);
    let found = solution.evaluate_with_errors(&times(41));
    let force = found.iter().find(|estimate| estimate.name == "f").unwrap();
    let bars = force.deviations.as_ref().unwrap();
    let off = times(41)
        .into_iter()
        .zip(force.values.iter().zip(bars))
        .filter(|(t, (value, bar))| (**value - 9.0 * (3.0 * *t).sin()).abs() > 2.0 * **bar);
    assert!(off.count() <= 6);
}
