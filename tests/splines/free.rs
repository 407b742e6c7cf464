//! Fields that nothing pins: equations take derivatives of them alone, so that any constant may be added.

use nisp::solve::driver::{Status, WarningKind};
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// A cart whose speed is measured. Its way is of no use to anything, and no condition says where it starts.
    mod cart {
        coordinates: t [s];
        fields: v [m/s], s [m];
        sources: f [N];
        parameters: m [kg] = 2, c [N s/m] = 0.6;
        on motion { push: m * d(v, t) + c * v == f; way: d(s, t) == v; }
        on samples { observe v; }
        scene push { }
    }
}

#[test]
fn a_field_off_by_any_constant_takes_nothing_from_the_rest() {
    let times: Vec<f64> = (0..500).map(|row| f64::from(row) / 50.0).collect();
    let speed = |t: f64| 1.2 * (0.8 * t).sin() + 0.5 * (2.3 * t).sin();
    let force = |t: f64| 2.0 * (0.96 * (0.8 * t).cos() + 1.15 * (2.3 * t).cos()) + 0.6 * speed(t);
    let mut normal = normals(5);
    let measured = times.iter().map(|&t| speed(t) + 0.02 * normal()).collect();
    let mut problem = Problem::new(cart::scene("push"));
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let found = of(&solution.evaluate(&times), "f").values.clone();
    let square = |value: &dyn Fn(usize) -> f64| (0..times.len()).map(|row| value(row).powi(2)).sum::<f64>();
    let off = (square(&|row| found[row] - force(times[row])) / square(&|row| force(times[row]))).sqrt();
    assert!(off < 0.05, "{off}");
    let free = solution.warnings.iter().find(|warning| warning.kind == WarningKind::Undetermined);
    let free = free.expect("nothing says where the way starts");
    assert!(free.message.contains("do not determine `s`: a constant"), "{}", free.message);
}

interpret! {
    /// A rotor whose speed is measured. Nothing says how far its shaft is twisted at first, and the torque balances that.
    mod rotor {
        units: off;
        coordinates: t;
        fields: w, p;
        sources: f;
        on shaft { turn: d(w, t) == f - 2 * p - 0.2 * w; twist: d(p, t) == w; }
        on start { rest: p == 0; }
        on samples { observe w; }
        scene turned { }
        scene twisted { without start.rest; }
    }
}

/// A twist of `c` more and a torque of `2 c` more turn the rotor alike: no bar of the torque can hold that.
#[test]
fn a_source_with_an_open_mean_is_not_called_right() {
    let times: Vec<f64> = (0..400).map(|row| f64::from(row) / 40.0).collect();
    let speed = |t: f64| 1.2 * (0.8 * t).sin() + 0.5 * (2.3 * t).sin();
    let mut normal = normals(8);
    let measured: Vec<f64> = times.iter().map(|&t| speed(t) + 0.01 * normal()).collect();
    for (scene, is_settled) in [(rotor::scene("turned"), true), (rotor::scene("twisted"), false)] {
        let mut problem = Problem::new(scene);
        problem.set_group("shaft", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured.clone()]).unwrap();
        if is_settled {
            problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
        }
        let solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status == Status::Converged, is_settled, "{:?}", solution.verdict);
        let is_open = solution.verdict.failed().any(|check| (check.check, check.term) == ("determined", "f"));
        assert_eq!(is_open, !is_settled, "{:?}", solution.verdict);
    }
}
