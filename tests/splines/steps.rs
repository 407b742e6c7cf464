//! Sources that step: one roughness along all of a record is too small at the step and too large elsewhere.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, simulated, solve};

interpret! {
    /// A vessel that drains, filled through a valve.
    mod vessel {
        coordinates: t [s];
        fields: h [m];
        sources: f [m/s];
        parameters: drain [s] = 2;
        on motion { level: d(h, t) == f - h / drain; }
        on samples { observe h; }
        scene filling { }
    }
}

interpret! {
    /// A cart on a spring, pushed by what a load cell measures.
    mod cart {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        parameters: m > 0 = 1;
        on motion { balance: m * d(x, t, 2) + 2 * d(x, t) + 6 * x == f; }
        on samples { observe x; observe f; }
        scene pushed { learn m; }
    }
}

interpret! {
    /// A mass on a spring, moved by what nobody measures.
    pub mod swing {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        on motion { balance: 1.5 * d(x, t, 2) + 0.8 * d(x, t) + 4 * x == f; }
        on samples { observe x; }
        scene loaded { }
    }
}

interpret! {
    /// An oven whose loss nobody knows, and a heater that is switched.
    mod oven {
        units: off;
        coordinates: t;
        fields: T;
        sources: P;
        parameters: loss > 0 = 0.1;
        on motion { balance: d(T, t) == P - loss * T; }
        on samples { observe T; }
        scene heated { learn loss; }
    }
}

/// When the valve opens and closes, and how much comes through it.
const OPEN: [(f64, f64, f64); 2] = [(2.0, 3.5, 1.0), (6.0, 6.4, 0.6)];

fn inflow(t: f64) -> f64 {
    OPEN.iter().filter(|(from, to, _)| (*from..*to).contains(&t)).map(|(.., flow)| flow).sum()
}

/// The level by superposition: what comes in from a time on fills the vessel to `drain` times as much, exponentially.
fn level(t: f64) -> f64 {
    let since = |from: f64| 2.0 * (1.0 - (-(t - from).max(0.0) / 2.0).exp());
    OPEN.iter().map(|(from, to, flow)| flow * (since(*from) - since(*to))).sum()
}

/// As many unknowns as exact values would let the inflow go to and fro all along the record, since values at the rows do not
/// see it.
#[test]
fn exact_values_tell_a_valve_that_opens_and_closes() {
    let times: Vec<f64> = (0..600).map(|row| f64::from(row) / 59.0).collect();
    let mut problem = Problem::new(vessel::scene("filling"));
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![times.iter().map(|&t| level(t)).collect()]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let estimates = solution.evaluate(&times);
    let found = of(&estimates, "f");
    let is_near_a_step = |t: f64| OPEN.iter().any(|(from, to, _)| (t - from).abs() < 0.2 || (t - to).abs() < 0.2);
    for (&t, found) in times.iter().zip(&found.values).filter(|(t, _)| !is_near_a_step(**t)) {
        assert!((found - inflow(t)).abs() < 1e-3, "t = {t}: {found} for {}", inflow(t));
    }
}

#[test]
fn a_valve_that_opens_and_closes_is_covered() {
    let times: Vec<f64> = (0..600).map(|row| f64::from(row) / 60.0).collect();
    let mut normal = normals(11);
    let measured = times.iter().map(|&t| level(t) + 0.001 * normal()).collect();
    let mut problem = Problem::new(vessel::scene("filling"));
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
    let mut solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let estimates = solution.evaluate_with_errors(&times);
    let found = of(&estimates, "f");
    let bars = found.deviations.as_ref().expect("a sound answer has error bars");
    let misses: Vec<f64> = (0..times.len()).map(|row| found.values[row] - inflow(times[row])).collect();
    let within = |deviations: f64| {
        let covered = misses.iter().zip(bars).filter(|(miss, bar)| miss.abs() <= deviations * **bar).count();
        covered as f64 / times.len() as f64
    };
    assert!(within(2.0) > 0.93 && within(4.0) > 0.995, "{} {}", within(2.0), within(4.0));
    // Away from the steps the inflow is known far better than one roughness for all of the record would say.
    let quiet: Vec<f64> =
        (0..times.len()).filter(|&row| (8.0..9.5).contains(&times[row])).map(|row| bars[row]).collect();
    let typical = quiet.iter().sum::<f64>() / quiet.len() as f64;
    assert!(typical < 0.02, "{typical}");
}

/// Where between two rows the force steps is what the cart says.
#[test]
fn a_measured_force_may_step_between_two_rows() {
    const ROWS: usize = 300;
    const MASS: f64 = 1.7;
    let times: Vec<f64> = (0..ROWS).map(|row| row as f64 / 15.0).collect();
    // Steps seven twentieths of the way from a row to the next.
    let force = |t: f64| if (15.0 * t - 8.35).rem_euclid(82.0) < 41.0 - 1e-9 { 4.0 } else { -1.0 };
    let states = simulated(&times, [0.0; 2], |t, [x, v]| [v, (force(t + 1e-9) - 2.0 * v - 6.0 * x) / MASS]);
    for seed in 1..4 {
        let mut normal = normals(seed);
        let x = states.iter().map(|state| state[0] + 0.005 * normal()).collect();
        let f = times.iter().map(|&t| force(t) + 0.08 * normal()).collect();
        let mut problem = Problem::new(cart::scene("pushed"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![x, f]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{seed}: {:?}", solution.verdict);
        let learned = solution.learned()[0].clone();
        assert!((learned.value / MASS - 1.0).abs() < 0.02, "{learned:?}");
        let estimates = solution.evaluate_with_errors(&times);
        let found = of(&estimates, "f");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        let rows = (0..ROWS).filter(|&row| (found.values[row] - force(times[row])).abs() > 2.0 * bars[row]);
        assert!(rows.count() < ROWS / 10);
    }
}

/// A load that switches to and fro, seen through what it moves. As far as the motion tells it may be smooth, but steps are in its bars: those
/// of smooth loads had up to a fourteenth of it beyond four deviations.
#[test]
fn a_load_that_switches_is_within_its_bars() {
    let load = |t: f64| if (1.9 * t + 0.4).sin() > 0.2 { 1.2 } else { -0.8 };
    let times: Vec<f64> = (0..300).map(|row| 20.0 * f64::from(row) / 299.0).collect();
    let states = simulated(&times, [0.0; 2], |t, [x, v]| [v, (load(t) - 0.8 * v - 4.0 * x) / 1.5]);
    let mut off = Vec::new();
    for seed in 1..6 {
        let mut normal = normals(seed);
        let measured = states.iter().map(|[x, _]| x + 0.025 * normal()).collect();
        let mut problem = Problem::new(swing::scene("loaded"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{seed}: {:?}", solution.verdict);
        let estimates = solution.evaluate_with_errors(&times);
        let found = of(&estimates, "f");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        off.extend((0..times.len()).map(|row| (found.values[row] - load(times[row])).abs() / bars[row]));
    }
    let beyond = |most: f64| off.iter().filter(|off| **off > most).count() as f64 / off.len() as f64;
    assert!(beyond(2.0) < 0.15 && beyond(4.0) < 0.01, "{} {}", beyond(2.0), beyond(4.0));
}

/// A row of the oven brings 480 times the noise, and the heater is switched between two of them: cells as wide as rows are apart cannot follow.
/// What each switch brings relaxes exponentially.
#[test]
fn a_heater_that_switches_between_two_rows_is_found_with_the_loss_beside_it() {
    const LOSS: f64 = 0.057;
    const HEAT: f64 = 48.0;
    let times: Vec<f64> = (0..400).map(f64::from).collect();
    let switches = || (0..5).map(|turn| 80.0 * f64::from(turn) + 13.37).flat_map(|on| [(on, HEAT), (on + 32.0, -HEAT)]);
    let heat = |t: f64| switches().filter(|(at, _)| *at <= t).map(|(_, heat)| heat).sum::<f64>();
    let warm = |t: f64| {
        let by = |(at, heat): (f64, f64)| heat / LOSS * -(-LOSS * (t - at).max(0.0)).exp_m1();
        50.0 * (-LOSS * t).exp() + switches().map(by).sum::<f64>()
    };
    for seed in 1..4 {
        let mut normal = normals(seed);
        let mut problem = Problem::new(oven::scene("heated"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        let measured = times.iter().map(|&t| warm(t) + 0.1 * normal()).collect();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{seed}: {:?}", solution.verdict);
        let learned = solution.learned()[0].clone();
        assert!((learned.value / LOSS - 1.0).abs() < 0.01, "{learned:?}");
        let estimates = solution.evaluate_with_errors(&times);
        let found = of(&estimates, "P");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        let rows = (0..400).filter(|&row| (found.values[row] - heat(times[row])).abs() > 2.0 * bars[row]);
        assert!(rows.count() < 40);
    }
}
