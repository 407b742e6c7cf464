//! Sessions: from one answer to the next.

use std::time::Duration;

use nisp::local::Local;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, Session, Settings, scene};

use crate::drum::*;

/// The disc that presses grows and then weighs more, frame by frame, and is exchanged for a larger one: the forces that a session
/// finds are right, and all answers but the first, and one that may be lost, follow from the one before.
#[test]
fn a_session_follows_what_presses() {
    let mut session = pressed_session(0.1);
    let frames =
        [(12_000.0, 12.0), (12_000.0, 12.7), (12_800.0, 12.7), (13_600.0, 12.7), (13_600.0, 12.0), (9_000.0, 16.0)];
    let mut followed = 0;
    for (at, (f, a)) in frames.into_iter().enumerate() {
        bind(session.problem(), f, a, 0.1);
        let solution = session.update(&mut |_| Flow::Continue).unwrap();
        assert!(solution.is_sound() && solution.status == Status::Converged, "{at}: {:?}", solution.verdict);
        followed += usize::from(solution.iterations < 5);
        let points = disc(20_000);
        let area = 1e-6 * std::f64::consts::PI * R * R / 20_000.0;
        let weights = vec![area; 20_000];
        let force = area * values(&solution.evaluate(&points), "f").iter().sum::<f64>();
        let real = true_force(f, a);
        // A single answer is off by as much: a twentieth of what presses.
        assert!((force - real).abs() < 0.27, "{at}: {force} N of {real}");
        let deviation = solution.deviation_of_sum("f", &points, &weights);
        assert!(deviation.is_some_and(|deviation| (1e-3..0.2).contains(&deviation)), "{at}: {deviation:?}");
    }
    assert!((4..6).contains(&followed), "{followed}");
}

/// A disc that is put on and taken away from one frame to the next is seen at once, and a frame under a pressure that is none leaves no
/// trace in the next one.
#[test]
fn a_session_follows_leaps() {
    let mut session = pressed_session(0.1);
    let area = 1e-6 * std::f64::consts::PI * R * R / 20_000.0;
    for (number, (f, given)) in
        [(12_000.0, P), (0.0, P), (12_000.0, P), (12_000.0, 20.0 * P), (12_000.0, P), (0.0, P)].into_iter().enumerate()
    {
        bind(session.problem(), f, 12.0, 0.1);
        session.problem().set_parameter("p", given).unwrap();
        let solution = session.update(&mut |_| Flow::Continue).unwrap();
        assert_eq!(solution.status == Status::Converged, given == P, "{number}: {:?}", solution.verdict);
        if given == P {
            let force = area * values(&solution.evaluate(&disc(20_000)), "f").iter().sum::<f64>();
            assert!((force - true_force(f, 12.0)).abs() < 0.27, "{number}: {force} N");
        }
    }
}

/// A wrong pressure in the middle of a session is named, by the answer from nothing that it leads to and by those that go on
/// from there; the right one is not.
#[test]
fn a_session_doubts_what_a_single_answer_doubts() {
    let mut session = pressed_session(0.3);
    for (number, (given, passes)) in [(P, true), (P, true), (1.2 * P, false), (1.2 * P, false)].into_iter().enumerate()
    {
        bind(session.problem(), 12_000.0, 12.0, 0.3);
        session.problem().set_parameter("p", given).unwrap();
        let solution = session.update(&mut |_| Flow::Continue).unwrap();
        let first = &solution.verdict.checks[0];
        assert_eq!((first.check, first.passed), ("given", passes), "{number}: {first:?}");
        assert_eq!(solution.status == Status::Converged, passes, "{number}");
        assert_eq!(solution.iterations < 5, number % 2 == 1, "{number}: {:?}", solution.verdict);
    }
}

/// New clouds are brought into the units and scales that the first one led to: terms keep their natural sizes to the last bit. A
/// session that begins with such a cloud finds others.
#[test]
fn a_session_keeps_its_scaling() {
    let sizes = |session: &mut Session| -> Vec<f64> {
        let terms = session.update(&mut |_| Flow::Continue).unwrap().terms();
        terms.iter().map(|term| term.size).collect()
    };
    let mut session = pressed_session(0.1);
    let first = sizes(&mut session);
    bind(session.problem(), 12_400.0, 12.3, 0.1);
    let followed = sizes(&mut session);
    assert!(session.solution().unwrap().iterations < 5, "sought anew");
    assert_eq!(followed, first);
    let mut anew = pressed_session(0.1);
    bind(anew.problem(), 12_400.0, 12.3, 0.1);
    assert_ne!(sizes(&mut anew), first);
}

/// A session with the pressed drumhead, its first cloud as noisy as this.
pub(crate) fn pressed_session(noise: f64) -> Session {
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, 12_000.0, 12.0, noise);
    let local =
        Local { cells: 24, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 2, patches: Some(PATCHES) };
    let settings = Settings {
        carrier: Carrier::Local(local),
        iterations: Some(40),
        budget: Some(Duration::from_secs(300)),
        threads: 2,
        ..Settings::default()
    };
    Session::new(problem, settings).unwrap()
}
