//! Where solvers of local functions start, and when they start again.
//!
//! A rough source under little noise and a plain one under much noise may both be most likely among their neighbours; where
//! neighbouring measurements lie far apart, what these say of the noise leads to the second. The other start begins with less noise
//! and rougher sources, and the evidence chooses.

use crate::noise::{Noise, ObservationNoise};

/// Values of all heads in natural sizes: their offsets first, others where a logarithm or a root has no value there.
const LEVELS: [f64; 5] = [0.0, 1.0, -1.0, 0.1, -0.1];
/// How far from a level there must be values too: at the end of a root there is no slope.
const AROUND: f64 = 1e-3;

/// Measurements that are enough for one start, where they miss the answer by no more than they should.
pub(crate) const ENOUGH: usize = 200;
/// Noise that may hide a source, as a share of the spread of the data.
const LOUD: f64 = 0.05;
/// The same beside what neighbouring measurements say.
const MISSED: f64 = 2.0;
/// Noise of the second start beside what neighbouring measurements say.
pub(crate) const QUIETER: f64 = 0.1;
/// Roughness of the second start's sources beside the natural one.
pub(crate) const ROUGHER: f64 = 30.0;

/// Whether the noise of an answer may hide a source: measurements are few and it is a part of what they vary by, or it is larger than
/// neighbouring measurements say. `count` says how many measurements there are of an observation, and `size` its noise.
pub(crate) fn may_hide(
    noise: &Noise,
    count: impl Fn(&ObservationNoise) -> usize,
    size: impl Fn(&ObservationNoise) -> f64,
) -> bool {
    let is_few = noise.observations.iter().map(count).sum::<usize>() <= ENOUGH;
    let is_loud = |found: &ObservationNoise| size(found) > LOUD * found.spread;
    let is_missed = |found: &ObservationNoise| !found.is_exact() && size(found) > MISSED * found.deviation;
    noise.observations.iter().any(|found| is_few && is_loud(found) || is_missed(found))
}

/// The first level of all heads around which a problem `has_value`; zero if there is none.
pub(crate) fn level(mut has_value: impl FnMut(f64) -> bool) -> f64 {
    let mut is_inside = |level: &f64| has_value(level - AROUND) && has_value(level + AROUND);
    LEVELS.into_iter().find(|level| is_inside(level)).unwrap_or(0.0)
}

/// Steps of a head either way, in natural sizes, by which is told what it does.
pub(crate) const EITHER_WAY: [f64; 3] = [-1e-3, 0.0, 1e-3];
/// Difference of the changes either way, over the changes, that is none.
const ALIKE: f64 = 1e-3;

/// Whether steps cannot move a head, because all rows that it changes, or all rows of data, change alike either way, as a square does
/// at zero. By term, whether it is an observation, and its rows at the head's values of [`EITHER_WAY`].
pub(crate) fn sleeps(terms: &[(bool, [Vec<f64>; 3])]) -> bool {
    let largest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let changed: Vec<(bool, bool)> = terms
        .iter()
        .map(|(is_data, [less, own, more])| (*is_data, largest(less, more), largest(own, more).max(largest(own, less))))
        .filter(|(_, _, change)| *change > 0.0)
        .map(|(is_data, apart, change)| (is_data, apart <= ALIKE * change))
        .collect();
    let all_are = |wanted: &dyn Fn(bool) -> bool| {
        let mut own = changed.iter().filter(|(is_data, _)| wanted(*is_data)).peekable();
        own.peek().is_some() && own.all(|(_, is_even)| *is_even)
    };
    all_are(&|is_data| is_data) || all_are(&|_| true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_sleeps_at_zero_and_nowhere_else() {
        let term = |is_data: bool, of: &dyn Fn(f64) -> f64| (is_data, EITHER_WAY.map(|step| vec![of(step), 2.0]));
        assert!(sleeps(&[term(false, &|x| 3.0 - x * x)]));
        assert!(sleeps(&[term(true, &|x| x * x), term(false, &|x| x)]));
        assert!(!sleeps(&[term(true, &f64::cos), term(true, &f64::sin)]));
        assert!(!sleeps(&[term(false, &|x| (1.0 + x).powi(2))]));
        assert!(!sleeps(&[term(false, &|_| 1.0)]));
    }

    #[test]
    fn the_end_of_a_root_is_no_start() {
        assert_eq!(level(|x| x.sqrt().is_finite()), 1.0);
        assert_eq!(level(|x| (-x).sqrt().is_finite()), -1.0);
        assert_eq!(level(f64::is_finite), 0.0);
    }
}
