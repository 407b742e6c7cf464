//! Records that are not as they were measured: averaged along the rows, fitted by moving parabolas, or filled between measured rows.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};

use crate::correlated::{ROWS, levels, vessel, with};
use crate::{normals, solve};

/// Noise of single rows, a hundredth of the range.
fn noise(seed: u64) -> Vec<f64> {
    let mut normal = normals(seed);
    (0..ROWS).map(|_| 0.03 * normal()).collect()
}

/// The answer to the record of a vessel that something was done to.
fn answer(treated: impl Fn(&[f64]) -> Vec<f64>, seed: u64) -> Solution {
    let measured: Vec<f64> = levels().iter().zip(noise(seed)).map(|(level, noise)| level + noise).collect();
    let problem = with(Problem::new(vessel::scene("all")), treated(&measured), &[0.0; ROWS]);
    solve(&problem, Carrier::Splines)
}

/// Every row the weighted sum of those before it; before the first, that one.
fn weighted(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let sum = |row: usize| weights.iter().enumerate().map(|(at, weight)| weight * values[row.saturating_sub(at)]).sum();
    (0..values.len()).map(sum).collect()
}

fn assert_filtered(solution: &Solution, word: &str) {
    let message = solution.verdict.failed().find(|check| check.check == "filtered").map(|check| &check.message);
    assert_eq!(solution.status, Status::Inconsistent);
    assert!(message.is_some_and(|message| message.contains(word)), "{message:?}");
}

#[test]
fn rows_as_they_were_measured_are_right() {
    for seed in 1..4 {
        let solution = answer(<[f64]>::to_vec, seed);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    }
}

#[test]
fn running_means_are_named_with_their_length() {
    for (seed, length) in [(1, 3), (2, 5), (3, 8)] {
        let means = |values: &[f64]| weighted(values, &vec![1.0 / length as f64; length]);
        assert_filtered(&answer(means, seed), &format!("running means of {length}:"));
    }
}

/// Seven rows by parabolas: the weights of Savitzky and Golay's table I (1964).
#[test]
fn moving_parabolas_are_named() {
    let weights = [-2.0, 3.0, 6.0, 7.0, 6.0, 3.0, -2.0].map(|weight| weight / 21.0);
    assert_filtered(&answer(|values| weighted(values, &weights), 1), "over 7 rows (Savitzky-Golay)");
}

#[test]
fn rows_between_measured_ones_are_named() {
    let filled = |values: &[f64]| {
        let value = |row: usize| {
            let (first, share) = (row / 4 * 4, (row % 4) as f64 / 4.0);
            let last = (first + 4).min(ROWS / 4 * 4 - 4);
            (1.0 - share) * values[first] + share * values[last]
        };
        (0..ROWS).map(value).collect()
    };
    assert_filtered(&answer(filled, 1), "only one of 4 rows of `h` was measured");
}
