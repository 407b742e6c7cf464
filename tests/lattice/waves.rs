//! Records over which waves cross their domain several times: lattices have more cells along time than along lengths.

use super::some::pressed;
use super::*;

/// Modes of the bump below of which the next is less than 1e-8 of the first.
const MODES: u32 = 40;
/// Crossings of the string that the record lasts.
const CROSSINGS: f64 = 6.0;

/// A bump at three fifths of the string, a tenth of it wide.
fn bump(x: f64) -> f64 {
    (-((x - 0.6) / 0.06).powi(2)).exp()
}

/// The amplitudes of the bump's modes. The trapezoidal rule is exact for what vanishes at the ends.
fn amplitudes() -> Vec<f64> {
    let along = |mode: u32| {
        (1..1000).map(move |i| 1e-3 * f64::from(i)).map(move |x| bump(x) * (f64::from(mode) * PI * x).sin())
    };
    (1..=MODES).map(|mode| 2e-3 * along(mode).sum::<f64>()).collect()
}

#[test]
fn a_press_is_found_from_the_waves_that_it_sends_to_and_fro() {
    let amplitudes = amplitudes();
    let exact = |[x, t]: [f64; 2]| -> f64 {
        let modes = (1..).zip(&amplitudes).map(|(mode, size)| (f64::from(mode) * PI, size));
        modes.map(|(k, size)| size * (1.0 - (k * t).cos()) * (k * x).sin() / (k * k)).sum()
    };
    let mut problem = Problem::new(scene::<pressed::recover::Scene>());
    let along = |count: usize| (0..count).map(move |i| i as f64 / (count - 1) as f64);
    problem.set_group("inside", grid([28, 28], [1.0, CROSSINGS], false).into(), Vec::new()).unwrap();
    problem.set_group("begin", along(41).flat_map(|s| [s, 0.0]).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let walls: Vec<f64> = along(121).flat_map(|s| [0.0, CROSSINGS * s, 1.0, CROSSINGS * s]).collect();
    problem.set_group("walls", walls.into(), Vec::new()).unwrap();
    let probes: Vec<f64> =
        (1..20).flat_map(|i| along(121).flat_map(move |s| [0.05 * f64::from(i), CROSSINGS * s])).collect();
    let mut normal = normals(71);
    let clean: Vec<f64> = pairs(&probes).map(exact).collect();
    let noise = 0.01 * root_mean_square(clean.iter().copied());
    let measured = clean.iter().map(|value| value + noise * normal()).collect();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places: Vec<f64> = (0..=60).flat_map(|i| [f64::from(i) / 60.0, 1.0]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let off: Vec<f64> = found.iter().zip(pairs(&places)).map(|(found, [x, _])| (found - bump(x)).abs()).collect();
    let within =
        |times: f64| off.iter().zip(deviations.as_ref().unwrap()).filter(|(off, bar)| **off < times * **bar).count();
    let size = root_mean_square((0..=60).map(|i| bump(f64::from(i) / 60.0)));
    assert!(root_mean_square(off.iter().copied()) < 0.2 * size, "{off:?}");
    assert!(within(2.0) >= 50 && within(4.0) == 61, "{off:?} {deviations:?}");
}
