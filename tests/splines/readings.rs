//! Sensors that are off by a share of what they show, and counters.

use nisp::solve::driver::{Flow, Status, WarningKind};
use nisp::{Carrier, Problem, Solution, recover, resume};
use nisp_interpreter::interpret;

use crate::{normals, of, settings, solve};

interpret! {
    /// What a body takes in of a drug, and what it loses again.
    mod body {
        units: off;
        coordinates: t;
        fields: c;
        sources: u;
        on change { mass: d(c, t) == u - 0.25 * c; }
        on samples { observe c; }
        scene recover { }
    }
}

const ROWS: usize = 200;

fn times() -> Vec<f64> {
    (0..ROWS).map(|row| 24.0 * row as f64 / (ROWS - 1) as f64).collect()
}

/// `c = 40 t exp(-t / 2)`, which rises and dies away by three decades, and what is taken in for it.
fn truth(t: f64) -> (f64, f64) {
    let c = 40.0 * t * (-t / 2.0).exp();
    (c, 40.0 * (1.0 - t / 2.0) * (-t / 2.0).exp() + 0.25 * c)
}

/// The record with a noise of such a deviation where the level is `c`.
fn record(seed: u64, deviation: impl Fn(f64) -> f64) -> Problem {
    let mut normal = normals(seed);
    let measured = times().into_iter().map(|t| truth(t).0).map(|c| c + deviation(c) * normal()).collect();
    let mut problem = Problem::new(body::scene("recover"));
    problem.set_group("change", times().into(), vec![]).unwrap();
    problem.set_group("samples", times().into(), vec![measured]).unwrap();
    problem
}

/// Error of the source beside it, root mean squares, and the share of places that are more than two deviations off.
fn off(solution: &mut Solution) -> (f64, f64) {
    let estimates = solution.evaluate_with_errors(&times());
    let found = of(&estimates, "u");
    let deviations = found.deviations.as_ref().unwrap();
    let exact: Vec<f64> = times().into_iter().map(|t| truth(t).1).collect();
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let error = square(&mut found.values.iter().zip(&exact).map(|(found, exact)| found - exact));
    let beyond = found.values.iter().zip(&exact).zip(deviations);
    let beyond = beyond.filter(|((found, exact), deviation)| (*found - *exact).abs() > 2.0 * *deviation).count();
    ((error / square(&mut exact.iter().copied())).sqrt(), beyond as f64 / ROWS as f64)
}

fn is_uneven(solution: &Solution) -> bool {
    solution.warnings.iter().any(|warning| warning.kind == WarningKind::UnevenNoise)
}

/// Noise of 3 % of the reading, and of counts that are tenths: as one size for all it would hide all but the largest values.
#[test]
fn each_value_counts_by_how_noisy_it_is() {
    for seed in 1..4 {
        let laws: [fn(f64) -> f64; 2] = [|c| 0.03 * c, |c| 0.3 * c.max(0.01).sqrt()];
        for (law, most) in laws.into_iter().zip([0.06, 0.12]) {
            let mut solution = solve(&record(seed, law), Carrier::Splines);
            assert_eq!(solution.status, Status::Converged, "{seed}");
            assert!(is_uneven(&solution), "{seed}");
            let (error, beyond) = off(&mut solution);
            assert!(error < most && beyond < 0.2, "{seed}: {error}, {beyond}");
        }
        assert!(!is_uneven(&solve(&record(seed, |_| 0.3), Carrier::Splines)), "{seed}");
    }
}

/// Wherever the steps are stopped, before or after values count by their noise, they go on with the same bits.
#[test]
fn a_run_is_resumed_while_values_count_by_their_noise() {
    let problem = record(1, |c| 0.03 * c);
    let all = settings(Carrier::Splines);
    let mut steps = 0;
    let whole = recover(&problem, &all, &mut |_| {
        steps += 1;
        Flow::Continue
    });
    let whole = whole.unwrap();
    for part in 1..8 {
        let (stop, mut taken) = (steps * part / 8, 0);
        let part = recover(&problem, &all, &mut |_| {
            taken += 1;
            if taken == stop { Flow::Stop } else { Flow::Continue }
        });
        let part = part.unwrap();
        assert_eq!(part.status, Status::Interrupted);
        let resumed = resume(&problem, &all, &part.checkpoint, &mut |_| Flow::Continue).unwrap();
        let values = |solution: &Solution| of(&solution.evaluate(&times()), "u").values.clone();
        assert_eq!(values(&resumed), values(&whole), "stopped after {stop}");
        assert!(is_uneven(&resumed));
    }
}
