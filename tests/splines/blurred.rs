//! Equations that know a measured column: they hold no better than that is known.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, of, simulated, solve};

interpret! {
    /// A room that is heated as a meter says, and loses heat to air of a temperature that a sensor says.
    mod room {
        units: off;
        coordinates: t;
        fields: u;
        sources: gain;
        parameters: capacity > 0 = 3, loss > 0 = 0.5;
        on inside {
            columns: heat, outside;
            balance: capacity * d(u, t) == heat + gain - loss * (u - outside);
        }
        on samples { observe u; }
        scene losing { gain = 0; learn loss; }
        scene gaining { }
    }
}

interpret! {
    /// A joint that a motor turns against a load; the motor's current is measured.
    mod joint {
        units: off;
        coordinates: t;
        fields: q;
        sources: load;
        on inside { columns: current; balance: 0.12 * d(q, t, 2) + 0.4 * d(q, t) == 5 * current - load; }
        on samples { observe q; }
    }
}

const ROWS: usize = 300;
const LENGTH: f64 = 40.0;
const CAPACITY: f64 = 3.0;
const LOSS: f64 = 0.6;

fn heat(t: f64) -> f64 {
    6.0 + 2.0 * (0.9 * t).sin() + (2.3 * t).cos()
}

fn outside(t: f64) -> f64 {
    3.0 * (0.4 * t).cos()
}

fn gain(t: f64) -> f64 {
    2.0 + (0.5 * t).sin()
}

fn times() -> Vec<f64> {
    (0..ROWS).map(|row| LENGTH * row as f64 / (ROWS - 1) as f64).collect()
}

/// A solved room, whose columns have a noise, and its truth.
fn solved(mut problem: Problem, (seed, noise): (u64, f64), gain: impl Fn(f64) -> f64) -> Solution {
    let times = times();
    let mut normal = normals(seed);
    let balance = |t: f64, [u]: [f64; 1]| [(heat(t) + gain(t) - LOSS * (u - outside(t))) / CAPACITY];
    let states = simulated(&times, [8.0], balance);
    let mut noisy = |value: &dyn Fn(usize) -> f64, noise: f64| -> Vec<f64> {
        (0..ROWS).map(|row| value(row) + noise * normal()).collect()
    };
    let columns = vec![noisy(&|row| heat(times[row]), noise), noisy(&|row| outside(times[row]), noise)];
    let measured = noisy(&|row| states[row][0], 0.01);
    problem.set_group("inside", times.clone().into(), columns).unwrap();
    problem.set_group("samples", times.into(), vec![measured]).unwrap();
    solve(&problem, Carrier::Splines)
}

/// The level follows the true heat, and not what the meter says of it.
#[test]
fn a_loss_is_found_beside_noisy_columns() {
    for seed in 1..4 {
        let mut solution = solved(Problem::new(room::scene("losing")), (seed, 0.3), |_| 0.0);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
        let [found] = &solution.learned()[..] else { panic!("one number is learned") };
        let deviation = found.deviation.expect("a sound answer has error bars");
        assert!((found.value - LOSS).abs() < 3.0 * deviation && deviation < 0.01, "{found:?}");
    }
}

/// Noise of a column is no motion of a source.
#[test]
fn a_source_beside_noisy_columns_is_covered() {
    for seed in 1..4 {
        let mut problem = Problem::new(room::scene("gaining"));
        problem.set_parameter("loss", LOSS).unwrap();
        let mut solution = solved(problem, (seed, 0.3), gain);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
        let estimates = solution.evaluate_with_errors(&times());
        let found = of(&estimates, "gain");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        let off: Vec<f64> = times().iter().zip(&found.values).map(|(t, found)| (found - gain(*t)).abs()).collect();
        let beyond = off.iter().zip(bars).filter(|(off, bar)| **off > 2.0 * **bar).count();
        assert!(beyond < ROWS / 5, "{seed}: {beyond}");
        assert!(off.iter().sum::<f64>() < 0.15 * ROWS as f64, "{seed}: {off:?}");
    }
}

/// What a wrong capacity leaves goes up and down with the heat, which noise of the meter does not.
#[test]
fn noise_of_columns_excuses_no_wrong_parameter() {
    let mut problem = Problem::new(room::scene("losing"));
    problem.set_parameter("capacity", 1.2 * CAPACITY).unwrap();
    let solution = solved(problem, (1, 0.3), |_| 0.0);
    assert_eq!(solution.status, Status::Inconsistent);
    let failed: Vec<_> = solution.verdict.failed().map(|check| (check.check, check.group)).collect();
    assert!(failed.contains(&("pattern", "inside")), "{failed:?}");
}

/// Of a motion that is known far better than the current that drives it: with exact equations, the source would take the noise of
/// the current for a fast course of its own.
#[test]
fn a_load_beside_a_noisy_current_is_covered() {
    for seed in 1..4 {
        let mut normal = normals(seed);
        let times: Vec<f64> = (0..800).map(|row| 0.005 * f64::from(row)).collect();
        // The angle sin(2 t) and the load; the current follows from both.
        let load = |t: f64| (1.3 * t).cos();
        let current = |t: f64| (-0.48 * (2.0 * t).sin() + 0.8 * (2.0 * t).cos() + load(t)) / 5.0;
        let mut noisy = |value: &dyn Fn(f64) -> f64, noise: f64| -> Vec<f64> {
            times.iter().map(|t| value(*t) + noise * normal()).collect()
        };
        let columns = vec![noisy(&current, 0.01)];
        let measured = noisy(&|t| (2.0 * t).sin(), 4e-4);
        let mut problem = Problem::new(joint::scene("all"));
        problem.set_group("inside", times.clone().into(), columns).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
        let estimates = solution.evaluate_with_errors(&times);
        let found = of(&estimates, "load");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        let off = times.iter().zip(&found.values).map(|(t, found)| (found - load(*t)).abs());
        let beyond = off.zip(bars).filter(|(off, bar)| *off > 2.0 * **bar).count();
        assert!(beyond < times.len() / 5, "{seed}: {beyond}");
    }
}
