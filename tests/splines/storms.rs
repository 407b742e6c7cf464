//! Rows that are not alike: storms beside outliers, a sensor that shook for a while, and gauges on a support that has settled.

use nisp::solve::driver::{Status, WarningKind};
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::correlated::{ROWS, levels, source, times, vessel, with};
use crate::{normals, of, simulated, solve, spoiled};

interpret! {
    /// A beam on two supports.
    mod beam {
        units: off;
        coordinates: x;
        fields: w;
        sources: q;
        domains: span = 0 .. 4;
        on inside in span { balance: 5 * d(w, x, 4) == q; }
        on ends boundary of span { held: w == 0; pinned: d(w, x, 2) == 0; }
        on gauges { observe w; }
        scene loaded { }
    }
}

/// Three storms over a small inflow.
fn inflow(t: f64) -> f64 {
    let storm = |at: f64| 5.0 * (-0.5 * ((t - at) / 3.0).powi(2)).exp();
    0.5 + 0.1 * (0.1 * t).sin() + [108.0, 220.0, 320.0].into_iter().map(storm).sum::<f64>()
}

/// The root mean square of what values are off, over that of the truth, and the share of them that are off by more than so many deviations.
fn off(solution: &mut Solution, name: &str, times: &[f64], truth: &[f64], deviations: f64) -> (f64, f64) {
    let found = solution.evaluate_with_errors(times);
    let found = of(&found, name);
    let errors = || found.values.iter().zip(truth).map(|(found, truth)| found - truth);
    let size = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    let beyond =
        errors().zip(found.deviations.as_ref().unwrap()).filter(|(error, own)| error.abs() > deviations * **own);
    (size(&mut errors()) / size(&mut truth.iter().copied()), beyond.count() as f64 / times.len() as f64)
}

/// A robust loss leaves out outliers, and not what storms did. A smooth inflow without them is a minimum, too.
#[test]
fn storms_are_no_outliers() {
    let times: Vec<f64> = (0..400).map(|row| 400.0 * f64::from(row) / 399.0).collect();
    let truth: Vec<f64> = times.iter().map(|&t| inflow(t)).collect();
    let heights = simulated(&times, [0.6], |t, [h]| [(inflow(t) - 0.8 * h) / 12.0]);
    for strays in [&[][..], &[30, 150, 270]] {
        let mut normal = normals(7);
        let mut rows: Vec<f64> = heights.iter().map(|[h]| h + 0.002 * normal()).collect();
        strays.iter().for_each(|&row| rows[row] += 0.5);
        let mut problem = Problem::new(spoiled::vessel::scene("filling"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![rows]).unwrap();
        problem.set_robust(true);
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{strays:?}: {:?}", solution.verdict);
        let said = solution.warnings.iter().find(|warning| warning.kind == WarningKind::LeftOut).unwrap();
        assert!(said.message.contains(&format!("{} of them", strays.len())), "{said}");
        let (error, beyond) = off(&mut solution, "q", &times, &truth, 4.0);
        assert!(error < 0.02 && beyond < 0.02, "{strays:?}: {error} {beyond}");
    }
}

/// A sensor that shook for a while: its rows count for less there, and quiet ones for as much as they know.
#[test]
fn noise_that_is_larger_in_parts_counts_there() {
    let mut normal = normals(4);
    let shakes = |row: usize| (100..180).contains(&row);
    let noise: Vec<f64> = (0..ROWS).map(|row| normal() * if shakes(row) { 0.08 } else { 0.01 }).collect();
    let mut solution = solve(&with(Problem::new(vessel::scene("all")), levels(), &noise), Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    assert!(
        solution.warnings.iter().any(|warning| warning.kind == WarningKind::UnevenNoise),
        "{:?}",
        solution.warnings
    );
    let truth: Vec<f64> = times().iter().map(|&t| source(t)).collect();
    let (_, beyond) = off(&mut solution, "f", &times(), &truth, 2.0);
    let quiet = 200..290;
    let (error, _) = off(&mut solution, "f", &times()[quiet.clone()], &truth[quiet], 2.0);
    assert!(error < 0.08 && beyond < 0.15, "{error} {beyond}");
}

/// A support that has settled leaves a misfit that is alike over a quarter of the beam. It was taken for noise of the gauges, and a load that is
/// the same everywhere for right.
#[test]
fn what_lasts_along_a_record_is_no_noise() {
    let places: Vec<f64> = (0..61).map(|i| 4.0 * f64::from(i) / 60.0).collect();
    // A uniform load with a wave of half of it: w = q / (24 EI) (x^4 - 2 l x^3 + l^3 x) and a / (EI k^4) sin(k x).
    let k = std::f64::consts::PI / 2.0;
    let height = |x: f64| (x.powi(4) - 8.0 * x.powi(3) + 64.0 * x) / 120.0 + 0.5 / (5.0 * k.powi(4)) * (k * x).sin();
    for (settled, status) in [(0.0, Status::Converged), (0.3, Status::Inconsistent)] {
        let mut normal = normals(2);
        let rows = places.iter().map(|&x| height(x) + settled * x / 4.0 + 0.002 * normal()).collect();
        let mut problem = Problem::new(beam::scene("loaded"));
        problem
            .set_group("inside", (0..=80).map(|i| f64::from(i) / 20.0).collect::<Vec<f64>>().into(), vec![])
            .unwrap();
        problem.set_group("ends", vec![0.0, 4.0].into(), vec![]).unwrap();
        problem.set_group("gauges", places.clone().into(), vec![rows]).unwrap();
        let solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, status, "{settled}: {:?}", solution.verdict);
    }
}
