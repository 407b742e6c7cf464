//! Answers that are kept as bytes and read back without their data, on every carrier.

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
        scene push { }
        scene rate { f = 0; learn w; }
    }
}

nisp::pde! {
    /// A plate on springs.
    mod mat {
        coordinates: x [m], y [m];
        fields: w [mm];
        sources: p [Pa] >= 0;
        parameters: k [N/m^3] = 1e6;
        on plate { balance: k * w - 1e3 [N/m] * laplacian(w) == p; }
        on probes { observe w within 0.01 [mm]; }
        scene loads { }
    }
}

/// A disturbance that looks like noise and is the same every time.
fn noise(i: usize) -> f64 {
    ((12.9898 * i as f64).sin() * 43758.5453).fract() - 0.5
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

#[test]
fn local_functions_are_read_back() {
    let scene = scene::<mat::loads::Scene>();
    let axis = |i: usize| i as f64 / 20.0;
    let points: Vec<f64> = (0..441).flat_map(|i| [axis(i % 21), axis(i / 21)]).collect();
    let bump = |p: &[f64]| 10.0 * (std::f64::consts::PI * p[0]).sin() * (std::f64::consts::PI * p[1]).sin();
    let values = points.chunks(2).enumerate().map(|(i, p)| bump(p) + 0.02 * noise(i)).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("plate", points.clone().into(), vec![]).unwrap();
    problem.set_group("probes", points.into(), vec![values]).unwrap();
    let local =
        Local { cells: 8, coarser: 1, degree: 3, tests: 1, finer: 1, source_dimensions: 2, patches: None };
    let mut solution = solve(&problem, Carrier::Local(local));
    assert_eq!(solution.carrier, "local functions");
    agree(&mut solution, scene, &[0.5, 0.5, 0.013, 0.97, 0.25, 1.0]);
}

#[test]
fn what_was_given_learned_and_said_stands_in_the_file() {
    let scene = scene::<swing::rate::Scene>();
    let mut solution = solve(&swing(scene), Carrier::Splines);
    let learned = solution.learned()[0].clone();
    let saved = SavedAnswer::from_bytes(&solution.saved().unwrap().to_bytes()).unwrap();
    assert_eq!((saved.module(), saved.scene(), saved.status(), saved.carrier()), ("swing", "rate", "converged", "splines"));
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
