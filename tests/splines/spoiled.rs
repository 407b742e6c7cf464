//! Records that went wrong on their way: rows that were written twice, sensors that were moved or changed their range.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::correlated::{ROWS, places, source, times, with};
use crate::steps::swing;
use crate::{normals, of, simulated, solve};

interpret! {
    /// A vessel that drains, with a gauge of its height.
    pub(crate) mod vessel {
        units: off;
        coordinates: t;
        fields: h;
        sources: q;
        on motion { content: 12 * d(h, t) == q - 0.8 * h; }
        on samples { observe h; }
        scene filling { }
    }
}

interpret! {
    /// The swing, of whose records some values are strays.
    mod bounded {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        on motion { balance: 1.5 * d(x, t, 2) + 0.8 * d(x, t) + 4 * x == f; }
        on samples { observe x with huber(3); }
        scene loaded { }
    }
}

/// Noise of single rows.
const NOISE: f64 = 0.005;

/// The answer to the record of a swing that something was done to.
fn answer(spoil: impl Fn(&mut Vec<f64>)) -> Solution {
    let mut normal = normals(3);
    let mut measured: Vec<f64> = places().iter().map(|place| place + NOISE * normal()).collect();
    spoil(&mut measured);
    solve(&with(Problem::new(swing::scene("loaded")), measured, &[0.0; ROWS]), Carrier::Splines)
}

fn assert_named(solution: &Solution, check: &str, word: &str) {
    let failed: Vec<_> = solution.verdict.failed().collect();
    assert_eq!(solution.status, Status::Inconsistent);
    assert!(failed.iter().any(|failed| failed.check == check && failed.message.contains(word)), "{failed:?}");
}

#[test]
fn rows_that_are_there_twice_are_named() {
    let twice = |rows: &mut Vec<f64>| rows.copy_within(100..140, 200);
    let solution = answer(twice);
    for said in ["40 rows of `x`", "leave out what was written or pasted once more"] {
        assert_named(&solution, "repeated", said);
    }
}

#[test]
fn a_sensor_that_stands_still_is_named_whatever_its_share_and_value() {
    for (first, last, value) in [(120, ROWS, 0.123), (0, 200, 0.123), (150, ROWS, 0.0), (0, 150, -999.0)] {
        let dead = |rows: &mut Vec<f64>| {
            // Away from zero, where a swing may be.
            rows.iter_mut().for_each(|row| *row += 2.0);
            rows[first..last].fill(value);
        };
        assert_named(&answer(dead), "held", &format!("`x` stands still in {} of {ROWS} rows", last - first));
    }
}

#[test]
fn a_sensor_that_is_read_more_often_than_it_measures_is_named() {
    let polled = |rows: &mut Vec<f64>| rows.chunks_mut(4).for_each(|rows| rows.fill(rows[0]));
    assert_named(&answer(polled), "polled", "each value of `x` stands in about 4.0 rows");
}

#[test]
fn a_record_that_jumps_is_no_force() {
    for moved in [0.5, -0.5] {
        let later = |rows: &mut Vec<f64>| rows[ROWS / 2..].iter_mut().for_each(|row| *row += moved);
        // From the row at 9.933 to that at 10.
        assert_named(&answer(later), "jolt", "at t = 9.9");
    }
}

/// A blow moves a swing smoothly: the answer to an impulse in closed form.
#[test]
fn a_blow_is_a_force() {
    const IMPULSE: f64 = 1.0;
    let (decay, start) = (0.8_f64 / 3.0, times()[ROWS / 2]);
    let turning = (4.0 / 1.5 - decay * decay).sqrt();
    let swung = |t: f64| IMPULSE / (1.5 * turning) * (-decay * t).exp() * (turning * t).sin();
    let struck = |rows: &mut Vec<f64>| {
        rows.iter_mut().zip(times()).for_each(|(row, t)| *row += swung((t - start).max(0.0)));
    };
    let solution = answer(struck);
    assert!(solution.verdict.failed().all(|check| check.check != "jolt"), "{:?}", solution.verdict);
}

/// A vessel's heights leap where its gauge changes its range, and the inflow would be a peak between two rows. Heights behind that row are off,
/// and the inflow with them. An inflow that is switched bends the heights.
#[test]
fn a_first_order_record_that_leaps_is_named() {
    let times: Vec<f64> = (0..300).map(|row| 0.3 * f64::from(row)).collect();
    let heights = |inflow: fn(f64) -> f64| simulated(&times, [0.4], |t, [h]| [(inflow(t) - 0.8 * h) / 12.0]);
    let filled = |inflow: fn(f64) -> f64, read: fn(usize, f64) -> f64| {
        let mut normal = normals(5);
        let rows = heights(inflow).into_iter().enumerate();
        let measured = rows.map(|(row, [h])| read(row, h) + 0.002 * normal()).collect();
        let mut problem = Problem::new(vessel::scene("filling"));
        problem.set_group("motion", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let wave = |t: f64| 0.5 + 0.3 * (0.13 * t).sin();
    assert_eq!(filled(wave, |_, h| h).status, Status::Converged);
    let rescaled = filled(wave, |row, h| if row < 150 { h } else { 1.2 * h });
    assert_named(&rescaled, "jolt", "`h` leaps from t = 44.7");
    let moved = filled(wave, |row, h| if row < 70 { h } else { h - 0.1 });
    assert_named(&moved, "jolt", "`q` makes up for it there alone");
    let switched = filled(|t| if t < 40.0 { 0.3 } else { 0.9 }, |_, h| h);
    assert!(switched.verdict.failed().all(|check| check.check != "jolt"), "{:?}", switched.verdict);
}

/// Strays of eighty deviations, one of 25 rows: under Huber's loss each pulls as a row of three deviations does.
#[test]
fn strays_are_no_noise_under_hubers_loss() {
    let mut normal = normals(4);
    let mut measured: Vec<f64> = places().iter().map(|place| place + NOISE * normal()).collect();
    measured.iter_mut().skip(7).step_by(25).for_each(|row| *row += 80.0 * NOISE);
    let mut solution = solve(&with(Problem::new(bounded::scene("loaded")), measured, &[0.0; ROWS]), Carrier::Splines);
    let noise = solution.terms().iter().find_map(|term| term.noise).unwrap();
    assert!((0.8..1.25).contains(&(noise / NOISE)), "{noise}");
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let found = solution.evaluate(&times());
    let squares = of(&found, "f").values.iter().zip(times()).map(|(f, t)| (f - source(t)).powi(2));
    let error = (squares.sum::<f64>() / ROWS as f64).sqrt();
    assert!(error < 0.1 * 3.0, "{error}");
}
