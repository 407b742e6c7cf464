//! Equations that know a column along the record: a drive.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
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
        let mut problem = Problem::new(vessel::scene("lost"));
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

interpret! {
    /// A coil and a wheel: the current answers to the voltage within an eighth of the time between two rows.
    mod motor {
        units: off;
        coordinates: t;
        fields: i, w;
        sources: load;
        on inside {
            columns: V;
            coil: 0.0025 * d(i, t) == V - i - w;
            wheel: d(w, t) == i - load;
        }
        on samples { observe i, w; }
    }
}

/// A voltage is switched, and the current is elsewhere before the next row. States follow from a load of one by exponentials, after
/// each switch with constants of their own: `w' = i - 1`, `0.0025 i' = V - i - w`.
#[test]
fn a_switched_voltage_moves_a_current_between_two_rows() {
    const EACH: u32 = 40;
    const STEP: f64 = 0.02;
    let volts = |row: u32| if (row / EACH).is_multiple_of(2) { 3.0 } else { 5.0 };
    // Roots of 0.0025 r^2 + r + 1, and the rest state (1, V - 1).
    let roots = [1.0, -1.0].map(|sign: f64| (-1.0 + sign * (1.0f64 - 0.01).sqrt()) / 0.005);
    let mut state = [1.0, 2.0];
    let mut normal = normals(3);
    let (mut times, mut rows) = (Vec::new(), [Vec::new(), Vec::new(), Vec::new()]);
    for row in 0..6 * EACH {
        let v = volts(row);
        times.push(STEP * f64::from(row));
        rows[0].push(state[0] + 0.01 * normal());
        rows[1].push(state[1] + 0.01 * normal());
        rows[2].push(v);
        // w = V - 1 + a e^(r1 t) + b e^(r2 t), and i = 1 + w'.
        let (off, slope) = (state[1] - (v - 1.0), state[0] - 1.0);
        let b = (slope - roots[0] * off) / (roots[1] - roots[0]);
        let parts = [off - b, b];
        let grown = [0, 1].map(|k| parts[k] * (roots[k] * STEP).exp());
        state = [1.0 + roots[0] * grown[0] + roots[1] * grown[1], v - 1.0 + grown[0] + grown[1]];
    }
    let [i, w, v] = rows;
    let mut problem = Problem::new(motor::scene("all"));
    problem.set_group("inside", times.clone().into(), vec![v]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![i, w]).unwrap();
    let mut solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let found = solution.evaluate_with_errors(&times);
    let load = of(&found, "load");
    let off: Vec<f64> = load.values.iter().map(|found| (found - 1.0).abs()).collect();
    let bars = load.deviations.as_ref().expect("a sound answer has error bars");
    assert!(off.iter().sum::<f64>() < 0.05 * off.len() as f64, "{off:?}");
    let beyond = off.iter().zip(bars).filter(|(off, bar)| **off > 4.0 * **bar).count();
    assert!(20 * beyond < off.len(), "{beyond}");
}
