//! Rows that are in a record twice: no noise comes again digit by digit.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Values of a stretch that is found again, at least; every stretch of twice as many is.
const LONG: usize = 8;
/// How many such stretches chance makes, at most.
const CHANCE: f64 = 1e-6;

/// Rows that are there twice, at least, and what share of all they must be.
const FEWEST: usize = 8;
const SHARE: f64 = 0.1;

/// How many of several columns' rows are there before, at the same places and with the same digits; nothing where they are few, or where
/// a sensor has so few steps that it shows the same now and then.
pub(super) fn copies(places: &[f64], axes: usize, columns: &[Vec<f64>]) -> Option<usize> {
    let bits = |values: &mut dyn Iterator<Item = f64>| values.map(f64::to_bits).collect::<Vec<u64>>();
    let own = |at: usize| bits(&mut columns.iter().map(|column| column[at]));
    let count = columns.first()?.len();
    let mut rows = HashSet::new();
    let mut values = HashSet::new();
    for at in 0..count {
        let place = places[at * axes..][..axes].iter().copied();
        rows.insert(bits(&mut place.chain(columns.iter().map(|column| column[at]))));
        values.insert(own(at));
    }
    let twice = count - rows.len();
    (twice >= FEWEST && twice as f64 >= SHARE * count as f64 && 2 * values.len() > rows.len()).then_some(twice)
}

/// The longest stretch of values that an earlier one repeats, and where that begins. Values of a sensor with few steps may come again by chance;
/// a course without noise comes again where it has a period.
pub(super) fn repeated(values: &[f64], noise: f64) -> Option<(Range<usize>, usize)> {
    let step = step(values)?;
    if noise <= step {
        return None;
    }
    let bits = |at: usize| -> [u64; LONG] { std::array::from_fn(|next| values[at + next].to_bits()) };
    // What a sensor at rest shows is there as long as it rests.
    let is_still = |at: usize| values[at..at + LONG].iter().all(|value| *value == values[at]);
    let mut known = HashMap::new();
    let mut longest = (0..0, 0);
    let mut at = 0;
    while at + LONG <= values.len() {
        if is_still(at) {
            at += 1;
            continue;
        }
        let Some(&first) = known.get(&bits(at)) else {
            // One of every few stretches is kept, and all are compared with them.
            if let Some(before) = (at + 1).checked_sub(LONG).filter(|before| before % LONG == 0 && !is_still(*before)) {
                known.entry(bits(before)).or_insert(before);
            }
            at += 1;
            continue;
        };
        let after = values[at..].iter().zip(&values[first..at]).take_while(|(a, b)| a == b).count();
        let before = values[..at].iter().rev().zip(values[..first].iter().rev()).take_while(|(a, b)| a == b).count();
        let found = at - before..at + after;
        at = found.end;
        if found.len() > longest.0.len() {
            longest = (found, first - before);
        }
    }
    let count = (values.len() as f64).powi(2);
    (count * alike(values, step).powi(longest.0.len() as i32) < CHANCE).then_some(longest)
}

/// The least difference between two values.
fn step(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).reduce(f64::min)
}

/// How often two second differences are the same, in steps.
fn alike(values: &[f64], step: f64) -> f64 {
    let mut bends: Vec<i64> = values.windows(3).map(|y| ((y[2] - 2.0 * y[1] + y[0]) / step).round() as i64).collect();
    bends.sort_unstable();
    let squares: f64 = bends.chunk_by(|a, b| a == b).map(|same| (same.len() as f64).powi(2)).sum();
    squares / (bends.len() as f64).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_behind_itself_is_there_twice() {
        let places: Vec<f64> = (0..60).map(|at| f64::from(at % 30)).collect();
        let values: Vec<f64> = (0..60).map(|at| (f64::from(at % 30) * 1.7).sin()).collect();
        assert_eq!(copies(&places, 1, std::slice::from_ref(&values)), Some(30));
        // Measured again, a value has other digits, but where its sensor has few.
        let again: Vec<f64> = values.iter().enumerate().map(|(at, value)| value + 1e-3 * (at as f64).cos()).collect();
        assert_eq!(copies(&places, 1, &[again]), None);
        assert_eq!(copies(&places, 1, &[values.iter().map(|value| (2.0 * value).round()).collect()]), None);
    }

    fn noisy(at: usize) -> f64 {
        (0.05 * at as f64).sin() + 0.02 * (17.0 * (at * at) as f64).sin()
    }

    #[test]
    fn rows_that_were_pasted_twice_are_found() {
        let values: Vec<f64> = (0..200).chain(150..400).map(noisy).collect();
        assert_eq!(repeated(&values, 0.02), Some((200..250, 150)));
        assert_eq!(repeated(&(0..450).map(noisy).collect::<Vec<f64>>(), 0.02), None);
    }

    #[test]
    fn a_sensor_of_few_steps_repeats_itself_by_chance() {
        let coarse = |at: usize| (50.0 * noisy(at)).round() / 50.0;
        let values: Vec<f64> = (0..450).map(coarse).collect();
        assert_eq!(repeated(&values, 0.021), None);
        // A stretch that is long enough is no chance.
        let values: Vec<f64> = (0..200).chain(100..400).map(coarse).collect();
        assert_eq!(repeated(&values, 0.021), Some((200..300, 100)));
    }

    #[test]
    fn a_course_without_noise_may_have_a_period() {
        let values: Vec<f64> = (0..400).map(|at| (std::f64::consts::TAU * f64::from(at % 40) / 40.0).sin()).collect();
        assert_eq!(repeated(&values, 1e-17), None);
    }
}
