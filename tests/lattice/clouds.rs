//! Sources and parameters from clouds of a surface that nobody told the place of.

use nisp::solve::driver::WarningKind;
use nisp_interpreter::interpret;

use super::sources::{edge, judged, scattered};
use super::*;

interpret! {
    /// A square skin that a load lifts, and never lowers.
    pub mod lifted {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f >= 0;
        on inside { balance: laplacian(u) + f == 0; }
        on surface { seen: chamfer [x, y, u]; }
        on edge { held: u == 0; }
        scene recover { }
    }
}

interpret! {
    /// A square skin of unknown tension that a known load lifts.
    pub mod tense {
        units: off;
        coordinates: x, y;
        fields: u;
        parameters: T > 0 = 1;
        on inside { balance: T * laplacian(u) + 0.4 == 0; }
        on surface { seen: chamfer [x, y, u]; }
        on edge { held: u == 0; }
        scene tension { learn T; }
    }
}

interpret! {
    /// A wire that a load pulls down, seen from the side.
    pub mod wire {
        units: off;
        coordinates: x;
        fields: w;
        sources: f;
        on inside { balance: d(w, x, 2) == f; seen: chamfer [x, w]; }
        on ends { held: w == 0; }
        scene recover { }
    }
}

/// The skin's height over the unit square: slopes reach a half.
fn height([x, y]: [f64; 2]) -> f64 {
    0.15 * (PI * x).sin() * (PI * y).sin()
}

/// `-laplacian` of it.
fn load(place: [f64; 2]) -> f64 {
    2.0 * PI * PI * height(place)
}

/// Points of a surface, off by so much in all directions.
fn cloud(height: impl Fn([f64; 2]) -> f64, count: usize, noise: f64) -> Vec<[f64; 3]> {
    let mut normal = normals(7);
    let places = scattered(count, [1.0, 1.0], 8);
    let point = |place: [f64; 2]| [place[0], place[1], height(place)].map(|x| x + noise * normal());
    pairs(&places).map(point).collect()
}

fn problem(scene: SceneRef, cloud: &[[f64; 3]]) -> Problem {
    let mut problem = Problem::new(scene);
    problem.set_group("inside", grid([26, 26], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("surface", grid([26, 26], [1.0, 1.0], true).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge(41).into(), Vec::new()).unwrap();
    problem.set_cloud("surface", "seen", cloud.as_flattened().to_vec()).unwrap();
    problem
}

/// How far the load is off at some places, over its size, and the share of it within two deviations.
fn off_and_within(solution: &mut Solution) -> (f64, f64) {
    judged(solution, "f", &grid([15, 15], [1.0, 1.0], false), &load)
}

#[test]
fn a_load_is_found_from_a_cloud_with_bars_that_hold() {
    let mut solution = solve(&problem(lifted::scene("recover"), &cloud(height, 2000, 0.01)));
    let (off, within) = off_and_within(&mut solution);
    assert!(off < 0.2 && within > 0.85, "{off} {within}");
}

/// One point in twenty is off by half a side.
#[test]
fn strays_are_no_noise() {
    let mut points = cloud(height, 2000, 0.01);
    points.iter_mut().step_by(20).enumerate().for_each(|(at, point)| point[2] += if at % 2 == 0 { 0.5 } else { -0.5 });
    let mut solution = solve(&problem(lifted::scene("recover"), &points));
    let (off, within) = off_and_within(&mut solution);
    assert!(off < 0.2 && within > 0.85, "{off} {within}");
}

/// Of the half that no point shows, the answer says that it guesses.
#[test]
fn where_no_cloud_is_bars_are_wide() {
    let seen: Vec<[f64; 3]> = cloud(height, 2000, 0.01).into_iter().filter(|point| point[0] < 0.5).collect();
    let mut solution = solve(&problem(lifted::scene("recover"), &seen));
    assert!(solution.warnings.iter().any(|warning| warning.kind == WarningKind::Settled), "{:?}", solution.warnings);
    let (_, within) = off_and_within(&mut solution);
    assert!(within > 0.8, "{within}");
    let (_, deviations) = values(&mut solution, "f", &[0.25, 0.5, 0.75, 0.5]);
    let deviations = deviations.unwrap();
    assert!(deviations[1] > 2.0 * deviations[0], "{deviations:?}");
}

/// A load from below lifts the skin, and the cloud lies a twentieth of a side under its edge.
#[test]
fn a_cloud_in_another_place_is_noticed() {
    let mut points = cloud(height, 2000, 0.01);
    points.iter_mut().for_each(|point| point[2] -= 0.05);
    let settings = Settings { budget: Some(Duration::from_secs(5)), ..settings() };
    let problem = problem(lifted::scene("recover"), &points);
    let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let missed = solution.verdict.checks.iter().find(|check| check.check == "distance").unwrap();
    assert!(!missed.passed && solution.status != Status::Converged, "{missed:?}");
}

/// A load of .4 lifts a skin of tension 2 by `0.2 phi`, where `-laplacian phi = 1`: a double series of sines.
#[test]
fn a_tension_is_learned_from_a_cloud() {
    let phi = |[x, y]: [f64; 2]| {
        let odd = || (1..60).step_by(2).map(f64::from);
        let term = |m: f64, n: f64| (m * PI * x).sin() * (n * PI * y).sin() / (m * n * (m * m + n * n));
        16.0 / PI.powi(4) * odd().flat_map(|m| odd().map(move |n| term(m, n))).sum::<f64>()
    };
    let mut solution = solve(&problem(tense::scene("tension"), &cloud(|at| 0.2 * phi(at), 3000, 1e-3)));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let found = &solution.learned()[0];
    let off = (found.value - 2.0).abs();
    assert!(off < 0.02 && off < 3.0 * found.deviation.unwrap(), "{found:?}");
}

/// The wire under `f = 0.1 pi^2 sin(pi x)`, as a noisy cloud that lies so much too high.
fn hanging(lift: f64) -> Problem {
    let mut normal = normals(7);
    let places: Vec<f64> = (0..400).map(|at| f64::from(at) / 399.0).collect();
    let point = |x: &f64| [*x, lift - 0.1 * (PI * x).sin()].map(|x| x + 1e-3 * normal());
    let cloud: Vec<f64> = places.iter().flat_map(point).collect();
    let mut problem = Problem::new(wire::scene("recover"));
    problem.set_group("inside", places.into(), Vec::new()).unwrap();
    problem.set_group("ends", vec![0.0, 1.0].into(), Vec::new()).unwrap();
    problem.set_cloud("inside", "seen", cloud).unwrap();
    problem
}

/// A curve in a plane shows its load as a surface in space does.
#[test]
fn a_load_is_found_from_a_curve_with_bars_that_hold() {
    let mut solution = solve(&hanging(0.0));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let inner: Vec<f64> = (1..40).map(|at| f64::from(at) / 40.0).collect();
    let truth = |x: f64| 0.1 * PI * PI * (PI * x).sin();
    let found = solution.evaluate_with_errors(&inner).into_iter().find(|estimate| estimate.name == "f").unwrap();
    let deviations = found.deviations.unwrap();
    let off: Vec<f64> = inner.iter().zip(&found.values).map(|(x, found)| (found - truth(*x)).abs()).collect();
    let within = off.iter().zip(&deviations).filter(|(off, deviation)| **off < 2.0 * **deviation).count();
    assert!(off.iter().all(|off| *off < 0.3) && within > 30, "{within}, {off:?}");
}

/// A cloud that lies off from where its ends are held asks for a load that bends the wire there, and finds one.
#[test]
fn a_load_that_bends_the_wire_at_its_ends_is_noticed() {
    for lift in [-0.01, 0.01] {
        let solution = solve(&hanging(lift));
        let named = solution.verdict.failed().any(|check| check.check == "edge" && check.term == "f");
        assert!(named && solution.status == Status::Inconsistent, "{:?}", solution.verdict);
    }
}

/// A network follows the noise of a cloud, and steps that end early leave no time to tell.
#[test]
fn a_source_without_bars_is_not_called_right() {
    let by_network = Settings { carrier: Carrier::Network, iterations: Some(100), ..Settings::default() };
    let early = Settings { iterations: Some(12), ..Settings::default() };
    for settings in [by_network, early] {
        let solution = recover(&hanging(0.0), &settings, &mut |_| Flow::Continue).unwrap();
        let told = solution.verdict.checks.iter().find(|check| check.check == "told").unwrap();
        assert!(!told.passed && told.message.contains("error bars"), "{told:?}");
    }
}
