//! Whether what an answer leaves of data over time is noise: noise has no rhythm.
//!
//! The sum of squares hardly feels an oscillation that was smoothed away, because it spreads over all samples; the
//! periodogram has it in one place.

use std::f64::consts::TAU;

use crate::noise::{ObservationNoise, in_order, is_exact};

/// An oscillation that noise would not show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swing {
    /// Periods over the record.
    pub(crate) periods: usize,
    pub(crate) amplitude: f64,
}

/// Amplitude of a rhythm over the noise below which it does not matter.
pub(crate) const FAINT: f64 = 0.1;
/// Longest gap of a record that counts as evenly sampled, beside the mean.
const LONGEST: f64 = 2.0;

/// Frequencies that are looked at, at most: what is smoothed away is slow beside the sampling.
const MOST: usize = 200;

/// Chance of taking noise for a swing: small, because what a fit leaves of noise stands out more than noise does.
const CHANCE: f64 = 1e-5;

/// The strongest oscillation of values that are evenly spaced, or nearly so, if it stands out of noise (Fisher 1929, Tests of
/// significance in harmonic analysis: ordinates of the periodogram over the variance are exponential numbers).
pub(crate) fn strongest(values: &[f64]) -> Option<Swing> {
    let count = values.len() as f64;
    let variance = values.iter().map(|x| x * x).sum::<f64>() / count;
    let frequencies = (values.len().saturating_sub(1) / 2).min(MOST);
    let square = |periods: usize| {
        // Goertzel (1958): the sum of `values[k] exp(i turn k)` by a recurrence of two terms.
        let turn = 2.0 * (TAU * periods as f64 / count).cos();
        let (last, before) = values.iter().fold((0.0, 0.0), |(last, before), x| (x + turn * last - before, last));
        last * last + before * before - turn * last * before
    };
    let (square, periods) = (1..=frequencies)
        .map(|k| (square(k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(square, _)| *square > 0.0)?;
    let chance = frequencies as f64 * (-square / (count * variance)).exp();
    (chance < CHANCE).then(|| Swing { periods, amplitude: 2.0 * square.sqrt() / count })
}

/// An oscillation in what is left of a noisy record, if that is evenly sampled.
pub(crate) fn rhythm(times: &[f64], residuals: &[f64], noise: ObservationNoise) -> Option<Swing> {
    let is_record = times.len() == residuals.len() && is_even(times) && !is_exact(noise.deviation, noise.spread);
    is_record.then(|| strongest(&in_order(times, residuals))).flatten()
}

/// True where no gap is much longer than the others.
fn is_even(times: &[f64]) -> bool {
    let sorted = in_order(times, times);
    let longest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let whole = sorted.last().zip(sorted.first()).map_or(0.0, |(last, first)| last - first);
    longest <= LONGEST * whole / (sorted.len().max(2) - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    #[test]
    fn a_record_with_a_gap_is_not_even() {
        let even: Vec<f64> = (0..50).rev().map(|i| 0.1 * f64::from(i) + 0.02 * f64::from(i % 3)).collect();
        assert!(is_even(&even) && is_even(&[]) && is_even(&[1.0]));
        let gap: Vec<f64> = even.iter().map(|t| if *t > 2.0 { t + 1.0 } else { *t }).collect();
        assert!(!is_even(&gap));
    }

    #[test]
    fn noise_has_no_rhythm_and_a_weak_sine_has() {
        let mut random = StdRng::seed_from_u64(3);
        let mut noise: Vec<f64> = (0..400).map(|_| normal(&mut random)).collect();
        assert_eq!(strongest(&noise), None);
        // A fifth more variance than noise has: little that the sum of squares would tell.
        noise.iter_mut().enumerate().for_each(|(i, x)| *x += 0.6 * (TAU * 7.0 * i as f64 / 400.0).cos());
        let found = strongest(&noise).unwrap();
        assert_eq!(found.periods, 7);
        assert!((found.amplitude - 0.6).abs() < 0.25, "{found:?}");
    }

    #[test]
    fn nothing_has_no_rhythm_either() {
        assert_eq!(strongest(&[]), None);
        assert_eq!(strongest(&[1.0]), None);
        assert_eq!(strongest(&[0.0; 30]), None);
    }
}
