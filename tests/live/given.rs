//! Numbers that are given wrongly, and bounds.

use nisp::{FixedLagSmoother, LagSettings, Problem, Smoothed};
use nisp_interpreter::interpret;

use crate::{noise, smoothed, smoother};

interpret! {
    /// Two tanks, the second of which nothing flows into but from the first.
    mod tanks {
        units: off;
        coordinates: t;
        fields: upper, lower;
        sources: u;
        parameters: k = 0.5, c = 0.3;
        on first { fed: d(upper, t) == u - k * (upper - lower); }
        on second { flows: d(lower, t) == k * (upper - lower) - c * lower; }
        on samples { observe upper, lower; }
        scene recover { }
    }
}

interpret! {
    /// A level that is fed, and never drawn from.
    mod fed {
        units: off;
        coordinates: t;
        fields: y;
        sources: u >= 0;
        on tank { balance: d(y, t) + 0.5 * y == u; }
        on samples { observe y; }
        scene recover { }
    }
}

/// The lower level is `2 + 0.5 sin(0.7 t) + 0.2 cos(1.9 t)`. The second equation says the upper one, for k = 0.5 and c = 0.3.
fn levels(t: f64) -> [f64; 2] {
    let lower = 2.0 + 0.5 * (0.7 * t).sin() + 0.2 * (1.9 * t).cos();
    let rate = 0.35 * (0.7 * t).cos() - 0.38 * (1.9 * t).sin();
    [(rate + 0.8 * lower) / 0.5, lower]
}

/// The answers to 1500 rows with noise of a hundredth, with a `k` that is given.
fn answers(k: f64, seed: u64) -> Vec<Smoothed> {
    let mut problem = Problem::new(tanks::scene("recover"));
    problem.set_parameter("k", k).unwrap();
    let (mut smoother, mut noise) = (FixedLagSmoother::new(problem, LagSettings::default()).unwrap(), noise(seed));
    let mut found = Vec::new();
    for at in 0..1500 {
        let t = 0.05 * f64::from(at);
        found.extend(smoother.push(t, &levels(t).map(|level| level + 0.01 * noise())).unwrap());
    }
    found.extend(smoother.finish().unwrap());
    found
}

#[test]
fn a_number_that_is_a_fifth_off_is_doubted_from_the_first_row_on() {
    for (k, seed) in [(0.6, 1), (0.4, 2)] {
        let found = answers(k, seed);
        assert_eq!(found.len(), 1500);
        assert!(found.iter().all(|found| found.given > Smoothed::GIVEN && !found.is_sound()), "{k}");
        assert!(found.iter().all(|found| found.doubt.as_ref().is_some_and(|doubt| doubt.contains("`k`"))), "{k}");
    }
}

#[test]
fn numbers_that_are_right_are_not_doubted_however_long_the_record_is() {
    for seed in 3..6 {
        let found = answers(0.5, seed);
        let most = found.iter().map(|found| found.given).fold(0.0, f64::max);
        assert!(most < Smoothed::GIVEN && found.iter().all(|found| found.doubt.is_none()), "{most}");
    }
}

/// What is fed is `level + cos(t)`: the equation's answer to it, but for what has died away.
fn fed_by(level: f64) -> Vec<(f64, f64)> {
    let mut noise = noise(4);
    let times = (0..1200).map(|at| 0.05 * f64::from(at));
    times.map(|t| (t, 2.0 * level + (0.5 * t.cos() + t.sin()) / 1.25 + 0.01 * noise())).collect()
}

/// A source that touches its bound again and again is never beyond it.
#[test]
fn sources_keep_their_bounds() {
    let found = smoothed(&mut smoother(fed::scene("recover"), LagSettings::default()), &fed_by(1.0));
    assert!(found.iter().all(|found| found.heads[1].0 >= 0.0));
    let is_off = |found: &&Smoothed| (found.heads[1].0 - 1.0 - found.at.cos()).abs() > 5.0 * found.heads[1].1;
    let (off, sound) = (found.iter().filter(is_off).count(), found.iter().filter(|found| found.is_sound()).count());
    assert!(off < 12 && sound > 1150, "{off} rows are off, and {sound} sound");
}

/// Rows that speak of a source far beyond its bound contradict it.
#[test]
fn rows_that_contradict_a_bound_are_not_called_sound() {
    let found = smoothed(&mut smoother(fed::scene("recover"), LagSettings::default()), &fed_by(0.0));
    let beyond = found.iter().filter(|found| found.at.cos() < -0.5 && found.is_sound()).count();
    assert_eq!(beyond, 0);
}
