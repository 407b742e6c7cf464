//! Records over which waves cross their domain several times: lattices have more cells along time than along lengths.

use nisp_interpreter::interpret;

use super::*;

interpret! {
    /// A string at rest that something begins to press.
    pub mod pressed {
        coordinates: x [m], t [s];
        fields: u [mm];
        sources: q(x) [mm/s^2];
        parameters: c [m/s] = 1;
        on inside { motion: d(u, t, 2) == c^2 * d(u, x, 2) + q; }
        on begin { flat: u == 0; still: d(u, t) == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// Modes of the source below of which the next is less than 1e-8 of the first.
const MODES: u32 = 40;
/// Crossings of the string that the record lasts.
const CROSSINGS: f64 = 3.0;

/// A press at three fifths of the string and a lift at a quarter.
fn press(x: f64) -> f64 {
    (-((x - 0.6) / 0.1).powi(2)).exp() - 0.5 * (-((x - 0.25) / 0.06).powi(2)).exp()
}

/// The amplitudes of the source's modes. The trapezoidal rule is exact for what vanishes at the ends.
fn amplitudes() -> Vec<f64> {
    let places = || (1..1000).map(|i| 1e-3 * f64::from(i));
    let of = |mode: u32| 2e-3 * places().map(|x| press(x) * (f64::from(mode) * PI * x).sin()).sum::<f64>();
    (1..=MODES).map(of).collect()
}

#[test]
fn a_press_is_found_from_waves_that_run_to_and_fro() {
    let amplitudes = amplitudes();
    let exact = |[x, t]: [f64; 2]| -> f64 {
        let modes = (1..).map(|mode| f64::from(mode) * PI).zip(&amplitudes);
        modes.map(|(k, size)| size * (1.0 - (k * t).cos()) * (k * x).sin() / (k * k)).sum()
    };
    let mut problem = Problem::new(pressed::scene("recover"));
    let along = |count: usize| (0..count).map(move |i| i as f64 / (count - 1) as f64);
    problem.set_group("inside", grid([28, 28], [1.0, CROSSINGS], false).into(), Vec::new()).unwrap();
    problem.set_group("begin", along(201).flat_map(|s| [s, 0.0]).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let walls: Vec<f64> = along(401).flat_map(|s| [0.0, CROSSINGS * s, 1.0, CROSSINGS * s]).collect();
    problem.set_group("walls", walls.into(), Vec::new()).unwrap();
    let probes: Vec<f64> =
        (0..15).flat_map(|i| along(100).flat_map(move |s| [0.05 + 0.9 * f64::from(i) / 14.0, CROSSINGS * s])).collect();
    let mut normal = normals(71);
    let clean: Vec<f64> = pairs(&probes).map(exact).collect();
    let noise = 0.03 * root_mean_square(clean.iter().copied());
    let measured = clean.iter().map(|value| value + noise * normal()).collect();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    // Held ends do not move, whatever presses on them.
    let places: Vec<f64> = (3..=57).flat_map(|i| [f64::from(i) / 60.0, 1.0]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let off: Vec<f64> = found.iter().zip(pairs(&places)).map(|(found, [x, _])| (found - press(x)).abs()).collect();
    let bars = deviations.unwrap();
    let within = |times: f64| off.iter().zip(&bars).filter(|(off, bar)| **off < times * **bar).count();
    let size = root_mean_square(pairs(&places).map(|[x, _]| press(x)));
    let error = root_mean_square(off.iter().copied());
    assert!(error < 0.15 * size, "{error} of {size}");
    assert!(within(2.0) >= 44 && within(4.0) == 55, "{off:?} {bars:?}");
}
