//! What presses a drumhead, and its tension: values, edges, error bars, and what is said where they mean nothing.

use std::f64::consts::PI;

use nisp::solve::driver::{Flow, Status, WarningKind};
use nisp::{Problem, Solution, scene};

use crate::drum::*;
use crate::sessions::pressed_session;

#[test]
fn the_tension_of_an_inflated_drumhead_is_found() {
    let mut problem = Problem::new(scene::<drum::free::Scene>());
    bind(&mut problem, 0.0, 1.0, 0.0);
    let mut solution = solve(&problem, None, 2);
    let tension = &solution.learned()[0];
    assert_eq!(solution.status, Status::Converged);
    assert!((tension.value / T - 1.0).abs() < 1e-3, "{tension:?}");
    let deviation = tension.deviation.unwrap();
    assert!(deviation > 0.0 && deviation < 0.05 * T, "{deviation}");
}

#[test]
fn a_pressed_patch_is_found_with_its_force_and_its_edge() {
    let (f, a) = (12_000.0, 12.0);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, 0.0);
    let solution = solve(&problem, Some(PATCHES), 2);
    let points = disc(6000);
    let found = solution.evaluate(&points);
    let pressure = values(&found, "f");
    let force = force(&solution);
    assert!((force / true_force(f, a) - 1.0).abs() < 0.02, "{force}");
    let (mut both, mut either) = (0, 0);
    for (pressure, point) in pressure.iter().zip(points.chunks(2)) {
        let masks = (*pressure > 0.5 * f, point[0].hypot(point[1]) < a);
        both += usize::from(masks.0 && masks.1);
        either += usize::from(masks.0 || masks.1);
    }
    // Half a cell of the pressure's lattice around the edge.
    assert!(f64::from(both as u32) > 0.85 * f64::from(either as u32), "{both} {either}");
    let off = points.chunks(2).zip(values(&found, "w")).map(|(c, w)| (w - height(c[0].hypot(c[1]), f, a)).abs());
    assert!(off.sum::<f64>() / 6000.0 < 0.02, "mean error of the height in mm");
}

#[test]
fn error_bars_cover_the_truth_and_no_more() {
    let (f, a, noise) = (12_000.0, 12.0, 0.3);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, noise);
    let mut solution = solve(&problem, Some(PATCHES), 2);
    let points = disc(2000);
    let found = solution.evaluate_with_errors(&points);
    let of = |name: &str| {
        let estimate = found.iter().find(|estimate| estimate.name == name).unwrap();
        estimate.values.iter().zip(estimate.deviations.as_ref().unwrap()).zip(points.chunks(2))
    };
    let share = |within: Vec<bool>| within.iter().filter(|is| **is).count() as f64 / within.len() as f64;
    let height = |c: &[f64]| height(c[0].hypot(c[1]), f, a);
    let covered = share(of("w").map(|((w, sd), c)| (w - height(c)).abs() < 2.0 * sd).collect());
    assert!(covered > 0.8, "{covered} of the heights");
    // Fifteen hundred points know far more than one.
    assert!(of("w").all(|((_, sd), _)| *sd > 0.0 && *sd < noise));
    // Conditional on the patch: well inside it.
    let inside = of("f").filter(|(_, c)| c[0].hypot(c[1]) < 0.8 * a);
    let covered = share(inside.map(|((p, sd), _)| (p - f).abs() < 2.0 * sd && *sd < f).collect());
    assert!(covered > 0.8, "{covered} of the pressures");
}

/// Below a flat plate the membrane is flat, so that the pressure is that from below, over a wide area. The prior prefers fewer nodes.
#[test]
fn the_bars_of_a_plates_force_know_what_the_prior_took() {
    for a in [14.0, 20.0, 26.0] {
        for noise in [0.1, 0.3, 1.0] {
            let mut problem = Problem::new(scene::<drum::pressed::Scene>());
            problem.set_parameter("T", T).unwrap();
            bind(&mut problem, P, a, noise);
            let solution = solve(&problem, Some(PATCHES), 2);
            let (points, area) = (disc(6000), 1e-6 * PI * R * R / 6000.0);
            let deviation = solution.deviation_of_sum("f", &points, &vec![area; 6000]).unwrap();
            let off = force(&solution) - true_force(P, a);
            assert!(off.abs() < 2.5 * deviation, "{a} mm, {noise} mm: {off} +- {deviation}");
            assert!(deviation < 0.04 * true_force(P, a), "{a} mm, {noise} mm: {deviation}");
        }
    }
}

/// With tension and gas pressure larger by the same share the drumhead has the same shape, and what presses is larger by that share;
/// also where the more of pressure is another parameter's, which is zero.
#[test]
fn the_bars_of_a_force_hold_what_is_given_only_so_well() {
    const SHARE: f64 = 0.1;
    let (f, a) = (12_000.0, 12.0);
    for pressure in ["p", "hidden"] {
        let mut session = pressed_session(0.1);
        session.problem().set_uncertain(&[("T", SHARE * T), (pressure, SHARE * P)]).unwrap();
        let (points, area) = (disc(6000), 1e-6 * PI * R * R / 6000.0);
        for (frame, radius) in [a, a + 0.3].into_iter().enumerate() {
            bind(session.problem(), f, radius, 0.1);
            let solution = session.update(&mut |_| Flow::Continue).unwrap();
            assert_eq!(solution.iterations < 5, frame == 1);
            let deviation = solution.deviation_of_sum("f", &points, &vec![area; 6000]).unwrap();
            let expected = SHARE * true_force(f, radius);
            // Sixty-four draws know a deviation to a tenth.
            assert!((deviation / expected - 1.0).abs() < 0.25, "{pressure}, {frame}: {deviation} {expected}");
        }
    }
}

/// A camera that shows one half: what presses on the other is anybody's guess, and the deviations say so.
#[test]
fn what_no_cloud_saw_is_not_known() {
    let (f, a) = (12_000.0, 12.0);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, 0.0);
    let guesses = |solution: &Solution| solution.warnings.iter().any(|warning| warning.kind == WarningKind::Settled);
    let deviations = |solution: &mut Solution, points: &[f64]| {
        let found = solution.evaluate_with_errors(points);
        found.into_iter().find(|estimate| estimate.name == "f").unwrap().deviations.unwrap()
    };
    let (far, near) = ([-25.0, 0.0], [25.0, 0.0]);
    let mut whole = solve(&problem, Some(PATCHES), 2);
    assert!(!guesses(&whole), "{:?}", whole.warnings);
    let known = deviations(&mut whole, &[far, near].concat());
    let all = seen(f, a, ([0.0; 3], 0));
    set_cloud(&mut problem, all.chunks(3).filter(|c| c[0] > 0.0).flatten().copied().collect());
    let mut one_sided = solve(&problem, Some(PATCHES), 2);
    assert!(guesses(&one_sided), "{:?}", one_sided.warnings);
    let found = deviations(&mut one_sided, &[far, near].concat());
    assert!(found[0] > 0.5 * P && found[0] > 3.0 * known[0], "{found:?} {known:?}");
    assert!(found[1] < 2.0 * known[1], "{found:?} {known:?}");
}

/// A pressure of the contact takes over what a gas pressure a fifth too high leaves, and the surface fits.
#[test]
fn a_wrong_pressure_is_named_and_a_right_one_is_not_doubted() {
    for (given, passes) in [(P, true), (1.2 * P, false)] {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, 12_000.0, 12.0, 0.3);
        problem.set_parameter("p", given).unwrap();
        let solution = solve(&problem, Some(PATCHES), 2);
        let first = &solution.verdict.checks[0];
        assert_eq!((first.check, first.passed), ("given", passes), "{first:?}");
        assert!(passes || first.message.contains("`p` about"), "{first:?}");
    }
}

#[test]
fn the_answer_does_not_depend_on_the_threads() {
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, 12_000.0, 12.0, 0.0);
    let of = |threads| values(&solve(&problem, Some(PATCHES), threads).evaluate(&disc(50)), "f").to_vec();
    assert_eq!(of(1), of(3));
}
