//! Whether what is left of a record has a slow course: noise has none, and a fit takes away from what chance makes of it.

use std::sync::Arc;

use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection};

/// Modes from here on, as a share of all, are taken for noise.
const FAST: f64 = 0.5;
/// Numbers of slow modes that are looked at: twice as many each time, from these on.
const FEWEST: usize = 4;

/// How much more power the slow modes of ordered misfits have than noise would give them, in standard deviations, and the share
/// of all power that is too much. The level of noise is that of the fast modes; a fit that follows its data leaves the slow ones
/// below it.
pub(super) fn excess(misfits: &[f64]) -> (f64, f64) {
    above(misfits, 0.0)
}

/// The same where noise has a variance of `least` at least, as slow as it may be.
pub(super) fn above(misfits: &[f64], least: f64) -> (f64, f64) {
    let powers = powers(misfits);
    let fast = &powers[(FAST * powers.len() as f64) as usize..];
    let total: f64 = powers.iter().sum();
    let level = (fast.iter().sum::<f64>() / fast.len().max(1) as f64).max(least);
    if level == 0.0 || total == 0.0 {
        return (0.0, 0.0);
    }
    let counts = std::iter::successors(Some(FEWEST), |count| Some(2 * count));
    let excesses = counts.take_while(|count| 4 * count <= misfits.len()).map(|count| {
        let slow: f64 = powers[..count].iter().sum();
        (deviations(slow / level, count), (slow - level * count as f64) / total)
    });
    excesses.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0.0))
}

/// Squares of the coefficients of cosines with 0, 1, 2, ... half waves (discrete cosine transform, orthonormal): of noise, each
/// has the noise's variance for its mean. By a Fourier transform of every other value from the first on, then of those between
/// them from the last back (Makhoul 1980).
fn powers(values: &[f64]) -> Vec<f64> {
    if values.is_empty() {
        return Vec::new();
    }
    let count = values.len();
    let there = values.iter().step_by(2);
    let back = values.iter().skip(1).step_by(2).rev();
    let mut waves: Vec<Complex<f64>> = there.chain(back).map(|&value| value.into()).collect();
    // Any length by lengths that are powers of two: of all of them a planner would have a kernel compiled for each small prime.
    let padded = Radix4::new((2 * count).next_power_of_two(), FftDirection::Forward);
    BluesteinsAlgorithm::new(count, Arc::new(padded)).process(&mut waves);
    let power = |(mode, wave): (usize, Complex<f64>)| {
        let turn = Complex::cis(-std::f64::consts::PI * mode as f64 / (2 * count) as f64);
        (turn * wave).re.powi(2) * if mode == 0 { 1.0 } else { 2.0 } / count as f64
    };
    waves.into_iter().enumerate().map(power).collect()
}

/// A chi squared of so many degrees of freedom in standard deviations of a normal number (Wilson and Hilferty 1931).
pub(super) fn deviations(square: f64, freedom: usize) -> f64 {
    let part = 2.0 / (9.0 * freedom as f64);
    ((square / freedom as f64).cbrt() - (1.0 - part)) / part.sqrt()
}

/// Root mean square of so many normal numbers of deviation one that so many deviations of chance allow.
pub(super) fn chance(count: usize, deviations: f64) -> f64 {
    let part = 2.0 / (9.0 * count.max(1) as f64);
    (1.0 - part + deviations * part.sqrt()).max(0.0).powf(1.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..count).map(|_| normal(&mut random)).collect()
    }

    /// The sums of the definition, for lengths that are powers of two, primes and neither.
    #[test]
    fn powers_are_those_of_the_definition() {
        for count in [1, 2, 3, 4, 7, 12, 64, 97, 200] {
            let values = noise(1, count);
            for (mode, found) in powers(&values).into_iter().enumerate() {
                let wave = |(at, value): (usize, &f64)| {
                    value * (std::f64::consts::PI * mode as f64 * (at as f64 + 0.5) / count as f64).cos()
                };
                let sum: f64 = values.iter().enumerate().map(wave).sum();
                let exact = sum * sum * if mode == 0 { 1.0 } else { 2.0 } / count as f64;
                assert!((found - exact).abs() < 1e-11 * count as f64, "{count}, {mode}: {found} {exact}");
            }
        }
        assert!(powers(&[]).is_empty());
    }

    /// The largest of five normal numbers stays below four, but for one time in six thousand.
    #[test]
    fn noise_has_no_slow_course() {
        for seed in 0..50 {
            let (excess, _) = excess(&noise(seed, 200));
            assert!(excess < 4.0, "{seed}: {excess}");
        }
    }

    /// A wave of amplitude 0.7 has a quarter of the noise's power, a hundred times that of a mode, in one or two modes.
    #[test]
    fn a_wave_below_the_noise_is_seen() {
        for seed in 0..20 {
            let mut values = noise(seed, 400);
            values.iter_mut().enumerate().for_each(|(at, value)| *value += 0.7 * (0.05 * at as f64).sin());
            let (excess, share) = excess(&values);
            assert!(excess > 4.0 && share > 0.02, "{seed}: {excess} {share}");
        }
    }

    /// Chi squared over its degrees of freedom has mean 1 and deviation sqrt(2 / n).
    #[test]
    fn chance_allows_less_to_many() {
        let exact = |count: f64| (1.0 + 4.0 * (2.0 / count).sqrt()).sqrt();
        assert!((chance(10_000, 4.0) - exact(1e4)).abs() < 1e-3);
        assert!(chance(4, 4.0) > 2.3 && chance(4, 4.0) < 2.8);
    }
}
