//! Answers that are kept as bytes and read back without their data, on every carrier.

#![allow(deprecated, reason = "an equation that reads one of its coordinates only is what a test is about")]

use std::time::Duration;

use nisp::local::Local;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Estimate, Problem, SavedAnswer, SavedError, SceneRef, Settings, Solution, recover, scene};

nisp::pde! {
    /// A pendulum with friction, pushed by something.
    mod swing {
        coordinates: t [ms];
        fields: q [mm];
        sources: f [m/s^2];
        parameters: c [1/s] = 0.2, w [1/s] in 0.5 .. 5 = 2 within 0.1;
        on motion { balance: d(q, t, 2) + c * d(q, t) + w^2 * q == f; }
        on samples { observe q; }
        let energy = d(q, t)^2 / 2 + w^2 * q^2 / 2;
        scene push { }
        scene rate { f = 0; learn w; }
    }
}

nisp::pde! {
    /// A long strip, over which nothing ties the scales of both coordinates together.
    mod strip {
        coordinates: x [m], y [m];
        fields: u [K];
        sources: s [K/m];
        parameters: a = 2;
        on inside { balance: d(u, y) + a * d(u, x) == s; }
        on probes { observe u; }
        scene drift { }
    }
}

nisp::pde! {
    /// A plate on springs.
    mod mat {
        coordinates: x [m], y [m];
        fields: w [mm];
        sources: p [Pa] >= 0;
        parameters: k [N/m^3] = 1e6;
        let tilt = grad(w);
        on plate { balance: k * w - 1e3 [N/m] * laplacian(w) == p; }
        on probes { observe w within 0.01 [mm]; }
        scene loads { }
    }
}

/// A number between -1/2 and 1/2 that looks like chance and is the same every time (splitmix64, Steele, Lea and Flood 2014).
fn noise(i: usize) -> f64 {
    let mut z = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// A decaying swing of 30 mm over three seconds, in ms and mm.
fn samples(count: usize) -> (Vec<f64>, Vec<f64>) {
    let at = |i: usize| 3000.0 * i as f64 / (count - 1) as f64;
    let q = |t: f64| 30.0 * (-0.1e-3 * t).exp() * (2e-3 * t).cos();
    (0..count).map(|i| (at(i), q(at(i)) + 0.5 * noise(i))).unzip()
}

fn swing(scene: SceneRef) -> Problem {
    let (times, values) = samples(90);
    let mut problem = Problem::new(scene);
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.into(), vec![values]).unwrap();
    if scene.schema.groups.iter().any(|group| group.is_beliefs()) {
        problem.set_parameter("w", 2.1).unwrap();
    } else {
        // With more friction than there is, something pushes.
        problem.set_parameter("c", 0.6).unwrap();
    }
    problem
}

fn solve(problem: &Problem, carrier: Carrier) -> Solution {
    let settings = Settings { carrier, budget: Some(Duration::from_secs(60)), threads: 2, ..Settings::default() };
    recover(problem, &settings, &mut |_| Flow::Continue).unwrap()
}

/// Values and deviations at points, of a solution and of what is read back from its bytes.
fn both(solution: &mut Solution, scene: SceneRef, points: &[f64]) -> [Vec<Estimate>; 2] {
    let bytes = solution.saved().unwrap().to_bytes();
    let read = SavedAnswer::from_bytes(&bytes).unwrap().open(scene).unwrap();
    [solution.evaluate_with_errors(points), read.evaluate(points)]
}

/// The same values to the last bit, and the same deviations to rounding.
fn agree(solution: &mut Solution, scene: SceneRef, points: &[f64]) {
    assert_eq!(solution.status, Status::Converged, "{:?} {:?}", solution.warnings, solution.verdict);
    let [own, read] = both(solution, scene, points);
    assert_eq!(own.len(), read.len());
    for (own, read) in own.iter().zip(&read) {
        assert_eq!((own.name, own.unit, own.source, &own.values), (read.name, read.unit, read.source, &read.values));
        let (own, read) = (own.deviations.as_ref().unwrap(), read.deviations.as_ref().unwrap());
        for (own, read) in own.iter().zip(read) {
            assert!(*own > 0.0 && (own / read - 1.0).abs() < 1e-8, "{own} and {read}");
        }
    }
}

#[test]
fn a_network_is_read_back() {
    for scene in [scene::<swing::push::Scene>(), scene::<swing::rate::Scene>()] {
        let mut solution = solve(&swing(scene), Carrier::Network);
        assert_eq!(solution.carrier, "network");
        agree(&mut solution, scene, &[0.0, 1.5, 777.0, 2999.0]);
    }
}

#[test]
fn splines_are_read_back() {
    for scene in [scene::<swing::push::Scene>(), scene::<swing::rate::Scene>()] {
        let mut solution = solve(&swing(scene), Carrier::Splines);
        assert_eq!(solution.carrier, "splines");
        agree(&mut solution, scene, &[0.0, 1.5, 777.0, 2999.0]);
    }
}

/// A plate over the unit square, pushed up to 10 mm in its middle and seen on a grid.
fn mat(scene: SceneRef) -> Solution {
    let axis = |i: usize| i as f64 / 20.0;
    let points: Vec<f64> = (0..441).flat_map(|i| [axis(i % 21), axis(i / 21)]).collect();
    let bump = |p: &[f64]| 10.0 * (std::f64::consts::PI * p[0]).sin() * (std::f64::consts::PI * p[1]).sin();
    let values = points.chunks(2).enumerate().map(|(i, p)| bump(p) + 0.02 * noise(i)).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("plate", points.clone().into(), vec![]).unwrap();
    problem.set_group("probes", points.into(), vec![values]).unwrap();
    let local = Local { cells: 8, coarser: 1, degree: 3, tests: 1, finer: 1, source_dimensions: 2, patches: None };
    solve(&problem, Carrier::Local(local))
}

#[test]
fn local_functions_are_read_back() {
    let scene = scene::<mat::loads::Scene>();
    let mut solution = mat(scene);
    assert_eq!(solution.carrier, "local functions");
    agree(&mut solution, scene, &[0.5, 0.5, 0.013, 0.97, 0.25, 1.0]);
}

#[test]
fn what_was_given_learned_and_said_stands_in_the_file() {
    let scene = scene::<swing::rate::Scene>();
    let mut solution = solve(&swing(scene), Carrier::Splines);
    let learned = solution.learned()[0].clone();
    let saved = SavedAnswer::from_bytes(&solution.saved().unwrap().to_bytes()).unwrap();
    assert_eq!(
        (saved.module(), saved.scene(), saved.status(), saved.carrier()),
        ("swing", "rate", "converged", "splines")
    );
    assert_eq!(saved.failed().count(), 0);
    let parameters = saved.parameters();
    let find = |name: &str| parameters.iter().find(|parameter| parameter.name == name).unwrap();
    assert!((find("c").value - 0.2).abs() < 1e-15 && !find("c").learned && find("c").unit == "1/s");
    assert_eq!((find("w").learned, find("w").value, find("w").deviation), (true, learned.value, learned.deviation));
    assert!(find("w").deviation.is_some());
    // Over the one coordinate the answer holds from the first to the last sample.
    let read = saved.open(scene).unwrap();
    assert!(read.contains(&[0.0]) && read.contains(&[3000.0]) && !read.contains(&[-1.0]) && !read.contains(&[3001.0]));
}

#[test]
fn what_is_no_answer_or_of_another_scene_is_refused() {
    let scene = scene::<swing::push::Scene>();
    let mut solution = solve(&swing(scene), Carrier::Splines);
    let bytes = solution.saved().unwrap().to_bytes();
    let error = |bytes: &[u8]| SavedAnswer::from_bytes(bytes).unwrap_err();
    assert_eq!(error(b"t [s],q [m]\n0,1\n"), SavedError::Foreign);
    assert_eq!(error(b"nisp answer 12\nwhatever"), SavedError::Version { found: "12".into() });
    for at in [20, bytes.len() / 2, bytes.len() - 1] {
        let mut bad = bytes.clone();
        bad[at] ^= 1;
        assert_eq!(error(&bad), SavedError::Damaged);
        assert_eq!(error(&bytes[..at]), SavedError::Damaged);
    }
    let saved = SavedAnswer::from_bytes(&bytes).unwrap();
    let other = saved.open(nisp::scene::<swing::rate::Scene>()).err().unwrap();
    assert!(matches!(&other, SavedError::Scene { saved, .. } if saved == "swing, scene push"), "{other}");
    let text = include_str!("saved.rs").split_once("mod swing").unwrap().1.split_once("\n}\n").unwrap().0;
    let changed = format!("mod swing{}", text.replace("q [mm]", "q [m]"));
    let changed = nisp_interpreter::read(&changed, "swing").unwrap().scenes[0];
    assert_eq!(saved.open(changed).err().unwrap(), SavedError::Changed("swing".into()));
}

/// What a saved answer says of an expression at points: values and deviations.
fn asked(solution: &mut Solution, expression: &str, points: &[f64]) -> Vec<Estimate> {
    let saved = SavedAnswer::from_bytes(&solution.saved().unwrap().to_bytes()).unwrap();
    let (answer, names) = nisp_interpreter::ask(&saved, expression).unwrap_or_else(|error| panic!("{error}"));
    let all = answer.evaluate(points);
    let find = |name: String| all.iter().find(|estimate| estimate.name == name).unwrap().clone();
    names.into_iter().map(find).collect()
}

/// That a derivative is what differences of values over `step` come to, to `tolerance` of the largest.
fn is_slope(slopes: &[f64], values: &[f64], step: f64, tolerance: f64) {
    let largest = slopes.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for (slope, values) in slopes.iter().zip(values.chunks_exact(2)) {
        let difference = (values[1] - values[0]) / (2.0 * step);
        assert!((slope - difference).abs() < tolerance * largest, "{slope} and {difference}");
    }
}

/// Points to both sides of each.
fn beside(points: &[f64], step: f64) -> Vec<f64> {
    points.iter().flat_map(|t| [t - step, t + step]).collect()
}

#[test]
fn derivatives_and_definitions_follow_from_the_values() {
    let points = [300.0, 1111.0, 2500.0];
    for carrier in [Carrier::Network, Carrier::Splines] {
        let mut solution = solve(&swing(scene::<swing::rate::Scene>()), carrier);
        let values = |solution: &mut Solution, name: &str, at: &[f64]| asked(solution, name, at).remove(0);
        // Millimetres and milliseconds: a slope in metres a second.
        let (q, v) = (values(&mut solution, "q", &points), values(&mut solution, "d(q, t)", &points));
        assert_eq!((q.unit.text, v.unit.text, v.name), ("mm", "m/s", "d(q, t)"));
        is_slope(&v.values, &values(&mut solution, "q", &beside(&points, 1.0)).values, 1.0, 1e-5);
        let a = values(&mut solution, "q_tt", &points);
        is_slope(&a.values, &values(&mut solution, "d(q, t)", &beside(&points, 1e-3)).values, 1e-6, 1e-5);
        // The closed form of the motion, within five deviations of the answer.
        for (at, t) in points.iter().enumerate() {
            let (t, decay) = (1e-3 * t, 0.03 * (-1e-4 * t).exp());
            let exact = -decay * (0.1 * (2.0 * t).cos() + 2.0 * (2.0 * t).sin());
            let deviation = v.deviations.as_ref().unwrap()[at];
            assert!((v.values[at] - exact).abs() < 5.0 * deviation && deviation < 0.01, "{} {exact}", v.values[at]);
        }
        // What is made of several parts moves as they do: all by learned `w` here and by the motion.
        let learned = solution.learned().remove(0);
        let w = values(&mut solution, "w", &points);
        let square = values(&mut solution, "w^2", &points);
        let energy = values(&mut solution, "energy", &points);
        for at in 0..points.len() {
            let deviation = |of: &Estimate| of.deviations.as_ref().unwrap()[at];
            let is_close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-7, "{a} and {b}");
            is_close(w.values[at], learned.value);
            is_close(deviation(&w), learned.deviation.unwrap());
            is_close(deviation(&square), 2.0 * learned.value * learned.deviation.unwrap());
            let expected = v.values[at].powi(2) / 2.0 + (w.values[at] * 1e-3 * q.values[at]).powi(2) / 2.0;
            is_close(energy.values[at], expected);
            assert!(deviation(&energy) > 0.0 && energy.unit.text == "m^2/s^2");
        }
        let twice = values(&mut solution, "-2 * q", &points);
        let of_twice = twice.deviations.unwrap();
        of_twice
            .iter()
            .zip(q.deviations.unwrap())
            .for_each(|(two, one)| assert!((two / (2e-3 * one) - 1.0).abs() < 1e-9));
    }
}

#[test]
fn local_functions_have_the_derivatives_that_their_splines_have() {
    let mut solution = mat(scene::<mat::loads::Scene>());
    let points = [0.31, 0.52, 0.77, 0.11];
    let tilt = asked(&mut solution, "tilt", &points);
    let names: Vec<&str> = tilt.iter().map(|estimate| estimate.name).collect();
    assert_eq!(names, ["tilt_x", "tilt_y"]);
    let pi = std::f64::consts::PI;
    for (at, point) in points.chunks(2).enumerate() {
        let (x, y) = (pi * point[0], pi * point[1]);
        for (estimate, exact) in tilt.iter().zip([x.cos() * y.sin(), x.sin() * y.cos()]) {
            let (exact, deviation) = (0.01 * pi * exact, estimate.deviations.as_ref().unwrap()[at]);
            let error = (estimate.values[at] - exact).abs();
            // Noise of 6 um, a hundred times the least, and what splines of degree three over an eighth leave.
            assert!(error < 3e-4 && deviation > 0.0 && deviation < 3e-4, "{error:e} {deviation:e}");
        }
    }
    let saved = solution.saved().unwrap();
    let error = |of: &str| nisp_interpreter::ask(&saved, of).err().unwrap().to_string();
    assert!(error("w_xxx").contains("order 2 is the highest"), "{}", error("w_xxx"));
    assert!(error("d(p, x)").contains("with a kink"), "{}", error("d(p, x)"));
}

#[test]
fn scales_that_an_equation_leaves_apart_are_not_tied_by_a_question() {
    let scene = scene::<strip::drift::Scene>();
    let points: Vec<f64> = (0..200).flat_map(|i| [20.0 * noise(i), 0.5 * noise(1000 + i)]).collect();
    let values = points.chunks(2).map(|p| (0.3 * p[0]).sin() + p[1]).collect();
    let groups: Vec<usize> = scene.schema.coordinates.iter().map(|c| c.scale_group).collect();
    assert_eq!(groups, [0, 1], "the equation ties nothing");
    let mut problem = Problem::new(scene);
    problem.set_group("inside", points.clone().into(), vec![]).unwrap();
    problem.set_group("probes", points.into(), vec![values]).unwrap();
    let settings = Settings { iterations: Some(20), threads: 1, ..Settings::default() };
    let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let at = [1.0, 0.1, -5.0, -0.2];
    let [both, xx, yy] = &asked(&mut solution, "laplacian(u), d(u, x, x), d(u, y, y)", &at)[..] else { panic!() };
    for (both, (xx, yy)) in both.values.iter().zip(xx.values.iter().zip(&yy.values)) {
        assert!((both - xx - yy).abs() < 1e-9 * (xx.abs() + yy.abs()), "{both} {xx} {yy}");
    }
    let slope = asked(&mut solution, "d(u, x)", &[1.001, 0.1, 0.999, 0.1]).remove(0).values;
    assert!(((slope[0] - slope[1]) / 0.002 - xx.values[0]).abs() < 1e-4 * xx.values[0].abs(), "{slope:?}");
}

#[test]
fn questions_that_cannot_be_answered_say_why() {
    let mut solution = solve(&swing(scene::<swing::rate::Scene>()), Carrier::Splines);
    let saved = solution.saved().unwrap();
    let error = |of: &str| nisp_interpreter::ask(&saved, of).err().unwrap().to_string();
    for (of, expected) in [
        ("q, energi", "did you mean `energy`"),
        ("q + t", "q"),
        ("d(q, x)", "`x`"),
        ("d(q,", "bracket"),
        ("partner(q)", "partner"),
        ("d(q, t, 7)", "order"),
    ] {
        assert!(error(of).contains(expected), "{of}: {}", error(of));
    }
    // The scene fixes `f`, which is an answer too.
    assert_eq!(asked(&mut solution, "f", &[100.0])[0].values, [0.0]);
}
