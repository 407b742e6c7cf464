//! Equations that know a column along the record: a drive.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, scene};

use crate::{normals, of, solve};

nisp::pde! {
    /// A vessel that is filled as known, and loses more than by its own leak.
    mod vessel {
        units: off;
        coordinates: t;
        fields: u;
        sources: q;
        on inside { columns: V; balance: d(u, t) == V - u - q; }
        on samples { observe u; }
        scene lost { }
    }
}

const LENGTH: f64 = 10.0;
/// The drive goes up and down so fast, and so far.
const PACE: f64 = 40.0;
const SWING: f64 = 10.0;

fn loss(t: f64) -> f64 {
    0.5 + 0.3 * (1.3 * t).sin()
}

/// The level, `2 + cos(0.7 t)` and what the fast part of the drive adds to it, a quarter at most.
fn level(t: f64) -> f64 {
    let fast = ((PACE * t).sin() - PACE * (PACE * t).cos()) / (1.0 + PACE * PACE);
    2.0 + (0.7 * t).cos() + SWING * fast
}

fn drive(t: f64) -> f64 {
    2.0 + (0.7 * t).cos() - 0.7 * (0.7 * t).sin() + SWING * (PACE * t).sin() + loss(t)
}

/// Measurements with a noise that hides the fast part of the level ask for wider cells than the drive can do with.
#[test]
fn a_drive_is_followed_where_its_answer_is_lost_in_the_noise() {
    // Few rows, whose cells are those of all points, and so many that cells are chosen.
    for rows in [400, 6000] {
        let times: Vec<f64> = (0..rows).map(|row| LENGTH * f64::from(row) / f64::from(rows - 1)).collect();
        let mut normal = normals(5);
        let levels = times.iter().map(|&t| level(t) + 0.3 * normal()).collect();
        let mut problem = Problem::new(scene::<vessel::lost::Scene>());
        problem.set_group("inside", times.clone().into(), vec![times.iter().map(|&t| drive(t)).collect()]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![levels]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{rows} rows: {:?}", solution.verdict);
        let found = solution.evaluate_with_errors(&times);
        let q = of(&found, "q");
        let deviations = q.deviations.as_ref().unwrap();
        for ((&t, found), deviation) in times.iter().zip(&q.values).zip(deviations) {
            let off = (found - loss(t)).abs();
            assert!(off < 4.0 * deviation && off < 0.6, "{rows} rows: {found} at {t}, {deviation}");
        }
    }
}
