//! Records that went wrong on their way: rows that were written twice, sensors that were moved or changed their range.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};

use crate::correlated::{ROWS, places, times, with};
use crate::steps::swing;
use crate::{normals, solve};

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
