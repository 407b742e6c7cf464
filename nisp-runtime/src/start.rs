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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_root_is_no_start() {
        assert_eq!(level(|x| x.sqrt().is_finite()), 1.0);
        assert_eq!(level(|x| (-x).sqrt().is_finite()), -1.0);
        assert_eq!(level(f64::is_finite), 0.0);
    }
}
