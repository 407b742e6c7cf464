//! Sources beside a field that nothing measures and that may begin anywhere: their level is open along the time that it takes to rest.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, simulated, solve};

interpret! {
    /// A heated room whose wall nobody measures.
    mod room {
        units: off;
        coordinates: t;
        fields: air, wall;
        sources: heat;
        on inside { quick: 40 * d(air, t) == heat - 20 * (air - wall); slow: 400 * d(wall, t) == 20 * (air - wall) - 5 * wall; }
        on samples { observe air; }
        scene heating { }
    }
}

const ROWS: usize = 300;
const LENGTH: f64 = 40.0;

fn heat(t: f64) -> f64 {
    90.0 + 40.0 * (0.9 * t).sin() + 25.0 * (2.3 * t).cos()
}

fn drifting(t: f64) -> f64 {
    100.0 + 50.0 * (0.1 * t + 1.0).sin() + 15.0 * (0.9 * t).sin()
}

/// Wherever the wall begins, the heat is another one by a course that dies away as slowly as the wall's warmth does. Drawn to zero along
/// it, all of the heat was more than four deviations off.
#[test]
fn a_level_that_a_hidden_state_leaves_open_is_covered() {
    assert!(covered(heat) > 0.9);
}

/// A heat that drifts over the record more than it varies beside that. How it drifts is open too: taken for as small as its faster waves
/// are, all of it was more than four deviations off.
#[test]
fn a_drift_that_a_hidden_state_leaves_open_is_covered() {
    assert!(covered(drifting) > 0.9);
}

/// The share of a heat that is within two deviations.
fn covered(heat: fn(f64) -> f64) -> f64 {
    let times: Vec<f64> = (0..ROWS).map(|row| LENGTH * row as f64 / (ROWS - 1) as f64).collect();
    let slope = |t: f64, [air, wall]: [f64; 2]| {
        let through = 20.0 * (air - wall);
        [(heat(t) - through) / 40.0, (through - 5.0 * wall) / 400.0]
    };
    let mut normal = normals(1);
    let air: Vec<f64> = simulated(&times, [17.0, 13.0], slope).iter().map(|[air, _]| air + 0.03 * normal()).collect();
    let mut problem = Problem::new(room::scene("heating"));
    problem.set_group("inside", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![air]).unwrap();
    let mut solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let estimates = solution.evaluate_with_errors(&times);
    let found = of(&estimates, "heat");
    let bars = found.deviations.as_ref().expect("a sound answer has error bars");
    let off = |row: usize| (found.values[row] - heat(times[row])).abs();
    let within = (0..ROWS).filter(|&row| off(row) < 2.0 * bars[row]).count();
    within as f64 / ROWS as f64
}
