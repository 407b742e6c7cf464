//! Sources that depend on some of the coordinates only: bars are no longer than what the cells cannot hold asks for, and a source that
//! varies along another coordinate too is noticed.

use nisp_interpreter::interpret;

use super::sources::scattered;
use super::*;

interpret! {
    /// A string at rest that something begins to press.
    pub mod pressed {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        on inside { motion: d(u, t, 2) == d(u, x, 2) + q; }
        on begin { flat: u == 0; still: d(u, t) == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

interpret! {
    /// A rod that is warmed evenly all the time.
    pub mod steady {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        on inside { flow: d(u, t) == 0.1 * d(u, x, 2) + q; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// A rod or a string of length 1 over two units of time, with noise of a share of how much its 600 values vary.
pub(super) fn rod(scene: SceneRef, share: f64, exact: impl Fn([f64; 2]) -> f64) -> Problem {
    let mut normal = normals(21);
    let samples = scattered(600, [1.0, 2.0], 22);
    let values: Vec<f64> = pairs(&samples).map(exact).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let noise = share * root_mean_square(values.iter().map(|value| value - mean));
    let measured = values.iter().map(|value| value + noise * normal()).collect();
    measured_rod(scene, samples, measured)
}

/// A rod or a string of length 1 over two units of time that begins at rest and is held at its ends, with values of probes.
pub(super) fn measured_rod(scene: SceneRef, probes: Vec<f64>, values: Vec<f64>) -> Problem {
    let mut problem = Problem::new(scene);
    let along = |count: usize| (0..count).map(move |i| i as f64 / (count - 1) as f64);
    problem.set_group("inside", grid([32, 32], [1.0, 2.0], false).into(), Vec::new()).unwrap();
    problem.set_group("begin", along(41).flat_map(|s| [s, 0.0]).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let walls: Vec<f64> = along(41).flat_map(|s| [0.0, 2.0 * s, 1.0, 2.0 * s]).collect();
    problem.set_group("walls", walls.into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![values]).unwrap();
    problem
}

/// A press of `pi^2 (sin(pi x) - sin(3 pi x) / 3)` lifts the string by waves that swing once and three times as fast. Such waves say
/// that there are hardly any of four cells. Bars of a load with edges are a third of it.
#[test]
fn a_smooth_source_has_no_bars_of_one_with_edges() {
    let mode = |n: f64, [x, t]: [f64; 2]| (n * PI * x).sin() * (1.0 - (n * PI * t).cos()) / (n * n);
    let exact = |place| mode(1.0, place) - mode(3.0, place) / 3.0;
    let source = |x: f64| PI * PI * ((PI * x).sin() - (3.0 * PI * x).sin() / 3.0);
    let mut solution = solve(&rod(pressed::scene("recover"), 1e-3, exact));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places: Vec<f64> = (1..100).flat_map(|i| [0.01 * f64::from(i), 1.0]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let off = root_mean_square(found.iter().zip(pairs(&places)).map(|(found, [x, _])| found - source(x)));
    let bars = root_mean_square(deviations.unwrap().into_iter());
    let size = root_mean_square(pairs(&places).map(|[x, _]| source(x)));
    assert!(off < 2.0 * bars && bars < 0.05 * size, "{off} {bars} {size}");
}

/// A warmth of `sin(pi x) (1 + 0.12 cos 20t)`, of which a source over `x` alone has the first part. What is left of the values is as large
/// as their noise at most, and no polynomial of low degree.
#[test]
fn a_source_that_varies_along_another_coordinate_too_is_noticed() {
    let (rate, frequency) = (0.1 * PI * PI, 20.0);
    let swing = |t: f64| {
        (rate * (frequency * t).cos() + frequency * (frequency * t).sin()) / (rate * rate + frequency * frequency)
    };
    let exact = |share: f64| {
        move |[x, t]: [f64; 2]| {
            let decay = (-rate * t).exp();
            (PI * x).sin() * ((1.0 - decay) / rate + share * (swing(t) - swing(0.0) * decay))
        }
    };
    let even = solve(&rod(steady::scene("recover"), 0.01, exact(0.0)));
    assert_eq!(even.status, Status::Converged, "{:?}", even.verdict.checks);
    let swings = solve(&rod(steady::scene("recover"), 0.01, exact(0.12)));
    let check = swings.verdict.checks.iter().find(|check| check.check == "pattern").unwrap();
    assert!(!check.passed && check.message.contains("neighbours"), "{check:?}");
    assert_eq!(swings.status, Status::Inconsistent);
}
