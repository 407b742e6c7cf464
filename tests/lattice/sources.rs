//! Sources from few or noisy measurements, or narrow ones: none is flattened, and none has bars that leave it out.

use super::*;

/// Places at random in a rectangle, not nearer to its edge than a fiftieth of its sides.
pub(super) fn scattered(count: usize, sides: [f64; 2], seed: u64) -> Vec<f64> {
    let mut normal = normals(seed);
    // A normal number is as likely to be on one side of a number as on the other: its distribution function is uniform.
    let mut uniform = || 0.5 * (1.0 + (normal() / 2f64.sqrt() * 0.9).tanh());
    (0..count).flat_map(|_| sides.map(|side| side * (0.02 + 0.96 * uniform()))).collect()
}

/// The deflection of a skin under a load of `5 pi^2` times it.
pub(super) fn bulge([x, y]: [f64; 2]) -> f64 {
    (PI * x).sin() * (2.0 * PI * y).sin()
}

/// So many values of that skin, with noise and places of two seeds.
pub(super) fn bulged(count: usize, noise: f64, [of_noise, of_places]: [u64; 2]) -> Problem {
    let mut normal = normals(of_noise);
    let samples = scattered(count, [1.0, 1.0], of_places);
    let measured = pairs(&samples).map(|place| bulge(place) + noise * normal()).collect();
    let mut problem = Problem::new(skin::scene("recover"));
    problem.set_group("inside", grid([28, 28], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge(40).into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    problem
}

/// Points of the edge of the unit square.
pub(super) fn edge(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64 / (count - 1) as f64).flat_map(|s| [s, 0.0, s, 1.0, 0.0, s, 1.0, s]).collect()
}

/// How far a source is off, over its size, and the share of it within two deviations.
pub(super) fn judged(
    solution: &mut Solution,
    name: &str,
    places: &[f64],
    exact: &dyn Fn([f64; 2]) -> f64,
) -> (f64, f64) {
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let (found, deviations) = values(solution, name, places);
    let off: Vec<f64> = found.iter().zip(pairs(places)).map(|(value, place)| value - exact(place)).collect();
    let within = off.iter().zip(deviations.unwrap()).filter(|(off, deviation)| off.abs() <= 2.0 * deviation).count();
    let size = root_mean_square(pairs(places).map(exact));
    (root_mean_square(off.iter().copied()) / size, within as f64 / off.len() as f64)
}

/// Of neighbouring measurements that lie far apart, noise and course are hard to tell. A load of `5 pi^2 sin(pi x) sin(2 pi y)`
/// makes a skin of a fifth of that over `pi^2`.
#[test]
fn a_load_from_thirty_values_is_no_noise() {
    for seed in 1..=4 {
        let mut solution = solve(&bulged(30, 0.01, [10 + seed, seed]));
        let places = grid([15, 15], [1.0, 1.0], false);
        let (off, within) = judged(&mut solution, "f", &places, &|place| 5.0 * PI * PI * bulge(place));
        assert!(off < 0.4 && within > 0.8, "seed {seed}: {off} off, {within} within");
    }
}

/// So many measurements that a lattice is chosen by some, and that all are linearised in turns; each fourth of them is lost.
#[test]
fn many_measurements_say_how_noisy_they_are() {
    let bulge = |[x, y]: [f64; 2]| (PI * x).sin() * (2.0 * PI * y).sin();
    let mut normal = normals(14);
    let samples = scattered(9000, [1.0, 1.0], 11);
    let mut value = |at: usize, place| if at % 4 == 1 { f64::NAN } else { bulge(place) + 0.05 * normal() };
    let measured = pairs(&samples).enumerate().map(|(at, place)| value(at, place)).collect();
    let mut problem = Problem::new(skin::scene("recover"));
    problem.set_group("inside", grid([28, 28], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge(40).into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    // Of 6750 values less some sixty that are used up: a deviation of 0.9 %.
    assert!(solution.warnings.is_empty(), "{:?}", solution.warnings);
    let noise = solution.terms().iter().find(|term| term.observation).unwrap().noise.unwrap();
    assert!((noise / 0.05 - 1.0).abs() < 0.03, "{noise}");
    let places = grid([15, 15], [1.0, 1.0], false);
    let (off, within) = judged(&mut solution, "f", &places, &|place| 5.0 * PI * PI * bulge(place));
    assert!(off < 0.1 && within > 0.8, "{off} off, {within} within");
}

/// Splines of a plate's deflection cannot follow every pattern of a load. That equations rule these out says nothing of how much
/// the load bends.
#[test]
fn what_equations_rule_out_does_not_flatten_a_load() {
    let bell = |[x, y]: [f64; 2]| {
        let part = |n: f64, middle: f64| (-(n * PI * 0.13).powi(2) / 2.0).exp() * (n * PI * middle).sin();
        move |n: f64, m: f64| part(n, 0.35) * part(m, 0.55) * (n * PI * x).sin() * (m * PI * y).sin()
    };
    let sum = |place: [f64; 2], of: &dyn Fn(f64) -> f64| -> f64 {
        let terms = (1..=14).flat_map(|n| (1..=14).map(move |m| (f64::from(n), f64::from(m))));
        terms.map(|(n, m)| bell(place)(n, m) * of((n * n + m * m) * PI * PI)).sum()
    };
    let samples = scattered(1000, [1.0, 1.0], 5);
    let exact: Vec<f64> = pairs(&samples).map(|place| sum(place, &|square| square.powi(-2))).collect();
    let size = root_mean_square(exact.iter().copied());
    let mut normal = normals(6);
    let measured = exact.iter().map(|w| w + 0.03 * size * normal()).collect();
    let mut problem = Problem::new(plate::scene("recover"));
    problem.set_group("inside", grid([35, 35], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge(40).into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    let places = grid([15, 15], [1.0, 1.0], false);
    let (off, within) = judged(&mut solution, "p", &places, &|place| sum(place, &|_| 1.0));
    assert!(off < 0.5 && within > 0.8, "{off} off, {within} within");
}

/// A spot of heat that moves is narrower than the first lattice can hold.
#[test]
fn lattices_become_as_fine_as_the_equations_ask() {
    let spot = |x: f64, t: f64| (-((x - 0.2 - 0.6 * t) / 0.06).powi(2)).exp();
    let heat = |[x, t]: [f64; 2]| {
        let away = (x - 0.2 - 0.6 * t) / 0.06;
        (2.0 * away * 0.6 / 0.06 - 0.05 * (4.0 * away * away - 2.0) / (0.06 * 0.06)) * spot(x, t)
    };
    let samples = grid([60, 60], [1.0, 1.0], true);
    let mut normal = normals(7);
    let measured = pairs(&samples).map(|[x, t]| spot(x, t) + 3e-3 * normal()).collect();
    let mut problem = Problem::new(lit::scene("recover"));
    problem.set_group("rod", grid([28, 28], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    let places = grid([25, 25], [1.0, 1.0], false);
    let (off, within) = judged(&mut solution, "q", &places, &heat);
    assert!(off < 0.2 && within > 0.8, "{off} off, {within} within");
}

/// A heater that is switched on and off: its edges are in waves that the cells cannot hold.
#[test]
fn a_switched_source_is_within_its_bars() {
    let (rate, on, off) = (0.05 * PI * PI, 0.35, 0.7);
    let since = |t: f64| (1.0 - (-rate * t.max(0.0)).exp()) / rate;
    let warm = |[x, t]: [f64; 2]| (PI * x).sin() * (since(t - on) - since(t - off));
    let heat = |[x, t]: [f64; 2]| if (on..off).contains(&t) { (PI * x).sin() } else { 0.0 };
    let samples = scattered(800, [1.0, 1.0], 9);
    let mut normal = normals(12);
    let measured = pairs(&samples).map(|place| warm(place) + 3e-3 * normal()).collect();
    let mut problem = Problem::new(lit::scene("recover"));
    problem.set_group("rod", grid([28, 28], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    let places = grid([40, 40], [1.0, 1.0], false);
    let (_, within) = judged(&mut solution, "q", &places, &heat);
    let (found, deviations) = values(&mut solution, "q", &places);
    let far = found.iter().zip(pairs(&places).map(heat)).zip(deviations.unwrap());
    let far = far.filter(|((found, exact), deviation)| (*found - exact).abs() > 4.0 * deviation).count();
    assert!(within > 0.93 && far <= 16, "{within} within, {far} of 1600 far outside");
}
