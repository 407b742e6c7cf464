//! Scalars that are learned beside a free source: told by a motion that the source cannot have made, or by nothing.

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Check, Problem, Settings, Solution, recover};
use nisp_interpreter::interpret;

use crate::{normals, settings, solve};

interpret! {
    /// A damped oscillator of which neither the spring nor the force is known.
    mod spring {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        parameters: c > 0 = 1, k > 0 = 10;
        on motion { balance: d(x, t, 2) + c * d(x, t) + k * x == f; }
        on samples { observe x; }
        scene rings { learn c, k; }
    }
}

interpret! {
    /// An oscillator under an unknown force, of which the spring is not known.
    mod stiff {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        parameters: c = 0.6, k > 0 = 30;
        on motion { balance: d(x, t, 2) + c * d(x, t) + k * x == f; }
        on samples { observe x; }
        scene unknown { learn k; }
    }
}

const DAMPING: f64 = 0.6;
const STIFFNESS: f64 = 16.0;

fn solved(motion: impl Fn(f64) -> f64) -> Solution {
    solve(&measured(motion), Carrier::Splines)
}

fn measured(motion: impl Fn(f64) -> f64) -> Problem {
    let mut normal = normals(11);
    let times: Vec<f64> = (0..200).map(|i| 0.06 * f64::from(i)).collect();
    let measured = times.iter().map(|&t| motion(t) + 0.01 * normal()).collect();
    let mut problem = Problem::new(spring::scene("rings"));
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.into(), vec![measured]).unwrap();
    problem
}

fn leaning(solution: &Solution) -> Vec<(&'static str, bool)> {
    let checks = solution.verdict.checks.iter().filter(|check| check.check == "leaning");
    checks.map(|check| (check.term, check.passed)).collect()
}

/// The ringing dies away as spring and damper say, and no smooth force makes it.
#[test]
fn a_spring_is_told_by_its_ringing() {
    let frequency = (STIFFNESS - DAMPING * DAMPING / 4.0).sqrt();
    let mut solution = solved(|t| (-DAMPING * t / 2.0).exp() * (frequency * t).cos());
    assert_eq!(leaning(&solution), [("c", true), ("k", true)]);
    for (learned, exact) in solution.learned().iter().zip([DAMPING, STIFFNESS]) {
        assert!((learned.value / exact - 1.0).abs() < 0.02, "{learned:?} is not {exact}");
    }
}

/// A slow force moves the spring as it would move a softer one, were it smaller.
#[test]
fn a_spring_that_a_slow_force_moves_is_not_told() {
    let mut solution = solved(|t| (0.7 * t).sin() + 0.3 * (1.1 * t).cos());
    assert_eq!(solution.status, Status::Inconsistent);
    // Neither how far scalars move with a larger source nor their own bars call them known.
    let is_of_scalars = |check: &&Check| ["leaning", "determined"].contains(&check.check) && "ck".contains(check.term);
    assert!(solution.verdict.failed().any(|check| is_of_scalars(&check)), "{:?}", solution.verdict.checks);
    assert!(solution.learned().iter().all(|learned| learned.deviation.is_none()), "bars where nothing is told");
}

/// A run that ends early has not been asked what its scalars rest on, and does not call them known.
#[test]
fn a_spring_of_a_run_that_ended_early_is_not_told() {
    let problem = measured(|t| (0.7 * t).sin() + 0.3 * (1.1 * t).cos());
    let whole = solve(&problem, Carrier::Splines).iterations;
    for iterations in [whole / 8, whole / 4] {
        let settings = Settings { iterations: Some(iterations), ..settings(Carrier::Splines) };
        let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
        assert_eq!(solution.status, Status::Budget);
        let open: Vec<&str> = solution.verdict.failed().filter(|c| c.check == "determined").map(|c| c.term).collect();
        assert!(open.contains(&"c") && open.contains(&"k"), "after {iterations} steps of {whole}: {open:?}");
    }
}

/// A network does not tell how far scalars move with larger sources. Its own bars tell.
#[test]
fn a_network_says_whether_a_spring_is_told() {
    let is_known = |motion: &dyn Fn(f64) -> f64| {
        let solution = solve(&measured(motion), Carrier::Network);
        let mut checks = solution.verdict.checks.iter();
        checks.find(|check| (check.check, check.term) == ("determined", "k")).map(|check| check.passed)
    };
    let frequency = (STIFFNESS - DAMPING * DAMPING / 4.0).sqrt();
    assert_eq!(is_known(&|t| (-DAMPING * t / 2.0).exp() * (frequency * t).cos()), Some(true));
    assert_eq!(is_known(&|t| (0.7 * t).sin() + 0.3 * (1.1 * t).cos()), Some(false));
}

/// A stiff spring under smooth forces, whose course no third order of smoothness describes: bars that say so, or none.
#[test]
fn a_spring_beside_smooth_forces_is_not_called_known_wrongly() {
    let times: Vec<f64> = (0..301).map(|i| f64::from(i) / 30.0).collect();
    for seed in 1..5 {
        let mut normal = normals(seed);
        // Waves of random lengths: a process with the spectrum of a Gaussian, of length one.
        let waves: Vec<[f64; 3]> = (0..40).map(|_| [normal(), normal(), normal()]).collect();
        let force = |t: f64| waves.iter().map(|[pace, a, b]| a * (pace * t).sin() + b * (pace * t).cos()).sum::<f64>();
        let course = crate::simulated(&times, [0.0, 0.0], |t, [x, v]| [v, force(t) - DAMPING * v - 20.0 * x]);
        let measured = course.iter().map(|[x, _]| x + 2e-3 * normal()).collect();
        let mut problem = Problem::new(stiff::scene("unknown"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        let learned = solution.learned().swap_remove(0);
        if let Some(deviation) = learned.deviation {
            assert!((learned.value - 20.0).abs() < 4.0 * deviation, "{seed}: {learned:?}, {:?}", solution.status);
        }
    }
}
