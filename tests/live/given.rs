//! Numbers that are given wrongly.

use nisp::{FixedLagSmoother, LagSettings, Problem, Smoothed, scene};

use crate::noise;

nisp::pde! {
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

/// The lower level is `2 + 0.5 sin(0.7 t) + 0.2 cos(1.9 t)`. The second equation says the upper one, for k = 0.5 and c = 0.3.
fn levels(t: f64) -> [f64; 2] {
    let lower = 2.0 + 0.5 * (0.7 * t).sin() + 0.2 * (1.9 * t).cos();
    let rate = 0.35 * (0.7 * t).cos() - 0.38 * (1.9 * t).sin();
    [(rate + 0.8 * lower) / 0.5, lower]
}

/// The answers to 1500 rows with noise of a hundredth, with a `k` that is given.
fn answers(k: f64, seed: u64) -> Vec<Smoothed> {
    let mut problem = Problem::new(scene::<tanks::recover::Scene>());
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
