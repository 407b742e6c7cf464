//! Noise that neighbouring rows share: a sensor that drifts, or that is slow.

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, Solution, recover, resume};
use nisp_interpreter::interpret;

use crate::steps::swing;
use crate::{normals, of, settings, simulated, solve};

interpret! {
    /// A vessel that drains, and what flows into it.
    pub(crate) mod vessel {
        units: off;
        coordinates: t;
        fields: h;
        sources: f;
        on motion { level: 2 * d(h, t) == f - h; }
        on samples { observe h; }
    }
}

pub(crate) const ROWS: usize = 300;

pub(crate) fn times() -> Vec<f64> {
    (0..ROWS).map(|row| row as f64 / 15.0).collect()
}

pub(crate) fn source(t: f64) -> f64 {
    3.0 + 1.2 * (0.9 * t).sin() + 0.8 * (1.7 * t + 1.0).cos()
}

/// Noise of which a row has so much from the row before.
fn noise(seed: u64, deviation: f64, shared: f64) -> Vec<f64> {
    let mut normal = normals(seed);
    let mut own = normal();
    let next = |_| {
        let now = own;
        own = shared * own + (1.0 - shared * shared).sqrt() * normal();
        deviation * now
    };
    (0..ROWS).map(next).collect()
}

pub(crate) fn with(mut problem: Problem, truth: Vec<f64>, noise: &[f64]) -> Problem {
    let measured = truth.iter().zip(noise).map(|(truth, noise)| truth + noise).collect();
    problem.set_group("motion", times().into(), vec![]).unwrap();
    problem.set_group("samples", times().into(), vec![measured]).unwrap();
    problem
}

pub(crate) fn levels() -> Vec<f64> {
    simulated(&times(), [2.0], |t, [h]| [(source(t) - h) / 2.0]).iter().map(|[h]| *h).collect()
}

pub(crate) fn places() -> Vec<f64> {
    simulated(&times(), [0.5, 0.0], |t, [x, v]| [v, (source(t) - 0.8 * v - 4.0 * x) / 1.5])
        .iter()
        .map(|[x, _]| *x)
        .collect()
}

/// Mean error of the source, and the shares of it beyond two and four deviations.
fn missed(solution: &mut Solution) -> (f64, [f64; 2]) {
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let estimates = solution.evaluate_with_errors(&times());
    let found = of(&estimates, "f");
    let bars = found.deviations.as_ref().expect("a sound answer has error bars");
    let off: Vec<f64> = times().iter().zip(&found.values).map(|(t, found)| (found - source(*t)).abs()).collect();
    let share = |deviations: f64| off.iter().zip(bars).filter(|(off, bar)| **off > deviations * **bar).count() as f64;
    (off.iter().sum::<f64>() / ROWS as f64, [2.0, 4.0].map(|deviations| share(deviations) / ROWS as f64))
}

/// A source that follows the noise is several times as far off: noise of single rows that changes as fast makes as much of it.
#[test]
fn noise_that_rows_share_is_not_followed() {
    for seed in 1..4 {
        for shared in [0.6, 0.9] {
            let noise = noise(seed, 0.02, shared);
            let vessel = with(Problem::new(vessel::scene("all")), levels(), &noise);
            let (off, [two, four]) = missed(&mut solve(&vessel, Carrier::Splines));
            assert!(off < 0.06 && two < 0.15 && four < 0.01, "vessel {seed} {shared}: {off} {two} {four}");
            let swing = with(Problem::new(swing::scene("loaded")), places(), &noise);
            let (_, [two, four]) = missed(&mut solve(&swing, Carrier::Splines));
            assert!(two < 0.15 && four < 0.01, "swing {seed} {shared}: {two} {four}");
        }
    }
}

/// Noise through a Butterworth filter of second order with its corner at a tenth of the highest frequency that rows show, by the bilinear
/// transform: `k = tan(pi / 20)`.
fn filtered(seed: u64, deviation: f64) -> Vec<f64> {
    let mut normal = normals(seed);
    let k = (std::f64::consts::PI / 20.0).tan();
    let whole = 1.0 + 2.0_f64.sqrt() * k + k * k;
    let (gain, one, two) = (k * k / whole, 2.0 * (k * k - 1.0) / whole, (1.0 - 2.0_f64.sqrt() * k + k * k) / whole);
    let (mut put, mut out) = ([0.0; 2], [0.0; 2]);
    let mut next = |_| {
        let own = normal();
        let now = gain * (own + 2.0 * put[0] + put[1]) - one * out[0] - two * out[1];
        (put, out) = ([own, put[0]], [now, out[0]]);
        now
    };
    let all: Vec<f64> = (0..ROWS + 50).map(&mut next).collect();
    let own = &all[50..];
    let size = (own.iter().map(|x| x * x).sum::<f64>() / ROWS as f64).sqrt();
    own.iter().map(|x| deviation / size * x).collect()
}

/// What a filter leaves of noise looks like a source, which nothing but the smoothness of what is left betrays.
#[test]
fn rows_that_were_filtered_are_doubted() {
    for seed in 1..4 {
        let noise = filtered(seed, 0.05);
        let vessel = with(Problem::new(vessel::scene("all")), levels(), &noise);
        let swing = with(Problem::new(swing::scene("loaded")), places(), &noise);
        for problem in [vessel, swing] {
            let solution = solve(&problem, Carrier::Splines);
            let failed: Vec<&str> = solution.verdict.failed().map(|check| check.check).collect();
            assert_eq!(solution.status, Status::Inconsistent, "{seed}");
            assert!(failed.contains(&"filtered"), "{seed}: {failed:?}");
        }
    }
}

/// The steps are tried again with noise that rows share. Wherever they are stopped, they go on with the same bits.
#[test]
fn a_run_is_resumed_while_noise_may_be_shared() {
    let problem = with(Problem::new(vessel::scene("all")), levels(), &noise(2, 0.02, 0.9));
    let whole = solve(&problem, Carrier::Splines);
    let all = settings(Carrier::Splines);
    for part in 1..8 {
        let (stop, mut steps) = (whole.iterations * part / 8, 0);
        let part = recover(&problem, &all, &mut |_| {
            steps += 1;
            if steps == stop { Flow::Stop } else { Flow::Continue }
        });
        let part = part.unwrap();
        assert_eq!(part.status, Status::Interrupted);
        let resumed = resume(&problem, &all, &part.checkpoint, &mut |_| Flow::Continue).unwrap();
        let values = |solution: &Solution| of(&solution.evaluate(&times()), "f").values.clone();
        assert_eq!(values(&resumed), values(&whole), "stopped after {stop}");
    }
}

interpret! {
    /// A vessel that drains at an unknown rate, and what is known to flow into it.
    mod drain {
        units: off;
        coordinates: t;
        fields: h;
        parameters: a > 0 = 1, k > 0 = 1;
        on motion { columns: f; level: a * d(h, t) == f - k * h; }
        on samples { observe h; }
        scene rates { learn a, k; }
    }
}

/// Where nothing is sought but rates, neighbours may be alike over a row or two: bars count it. A course that is wrong all along is none.
#[test]
fn rates_are_learned_from_rows_that_share_a_little_noise() {
    let rates = |seed: u64, shared: f64, drift: f64| {
        let measured = levels().into_iter().zip(noise(seed, 0.05, shared)).zip(times());
        let measured = measured.map(|((level, noise), t)| level + noise + drift * (0.4 * t).sin()).collect();
        let mut problem = Problem::new(drain::scene("rates"));
        problem.set_group("motion", times().into(), vec![times().into_iter().map(source).collect()]).unwrap();
        problem.set_group("samples", times().into(), vec![measured]).unwrap();
        solve(&problem, Carrier::Splines)
    };
    for (shared, longer) in [(0.0, 1.0), (0.4, 1.3)] {
        let mut squares = Vec::new();
        for seed in 1..7 {
            let mut solution = rates(seed, shared, 0.0);
            assert_eq!(solution.status, Status::Converged, "{shared}, {seed}: {:?}", solution.verdict);
            let learned = solution.learned();
            assert!(learned[1].deviation.unwrap() > longer * 0.9e-3, "{shared}: {learned:?}");
            squares.extend(
                learned
                    .iter()
                    .zip([2.0, 1.0])
                    .map(|(own, exact)| ((own.value - exact) / own.deviation.unwrap()).powi(2)),
            );
        }
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!((0.4..1.7).contains(&rms), "{shared}: {rms}");
    }
    assert_eq!(rates(1, 0.0, 0.06).status, Status::Inconsistent);
}
