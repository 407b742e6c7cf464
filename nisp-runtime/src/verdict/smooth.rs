//! Whether what is left of measurements over several coordinates has a smooth part: noise has none, and a fit takes away from
//! what chance makes of it.

use super::slow::deviations;

/// Degrees of the polynomials that are looked at, each after those below it.
const DEGREES: [usize; 4] = [1, 2, 4, 6];
/// Measurements for each polynomial, at least.
const MEASUREMENTS: usize = 10;

/// How much more of misfits polynomials of low degree describe than they would of noise, in standard deviations, and the share
/// of their square. `places` has `axes` coordinates for each misfit. Of an answer made from a share of the measurements, `used`, noise
/// has left a smooth part too: as much larger than that of all as they are more.
pub(super) fn excess(places: &[f64], axes: usize, misfits: &[f64], used: f64) -> (f64, f64) {
    let total: f64 = misfits.iter().map(|x| x * x).sum();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut squares: Vec<f64> = Vec::new();
    let mut counts = Vec::new();
    let scaled = scaled(places, axes);
    let exponents = exponents(axes, DEGREES[DEGREES.len() - 1]);
    for degree in 0..=DEGREES[DEGREES.len() - 1] {
        let own = exponents.iter().filter(|powers| powers.iter().sum::<usize>() == degree);
        let own: Vec<&Vec<usize>> = own.collect();
        if MEASUREMENTS * (basis.len() + own.len()) > misfits.len() {
            break;
        }
        for powers in own {
            if let Some(mode) = orthonormal(product(&scaled, powers), &basis) {
                squares.push(dot(&mode, misfits).powi(2));
                basis.push(mode);
            }
        }
        if DEGREES.contains(&degree) {
            counts.push(squares.len());
        }
    }
    let level = (total - squares.iter().sum::<f64>()) / (misfits.len() - squares.len()).max(1) as f64;
    if level <= 0.0 || total == 0.0 {
        return (0.0, 0.0);
    }
    let expected = if used < 1.0 { level * (1.0 + used.recip()) } else { level };
    let excesses = counts.into_iter().map(|count| {
        let smooth: f64 = squares[..count].iter().sum();
        (deviations(smooth / expected, count), (smooth - expected * count as f64) / total)
    });
    excesses.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0.0))
}

/// Every coordinate brought to [-1, 1], axis by axis.
pub(super) fn scaled(places: &[f64], axes: usize) -> Vec<Vec<f64>> {
    let axis = |at: usize| {
        let own: Vec<f64> = places.iter().skip(at).step_by(axes).copied().collect();
        let low = own.iter().copied().fold(f64::INFINITY, f64::min);
        let high = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let half = if high > low { (high - low) / 2.0 } else { 1.0 };
        own.into_iter().map(|x| (x - low) / half - 1.0).collect()
    };
    (0..axes).map(axis).collect()
}

/// Degrees by each axis up to a total.
fn exponents(axes: usize, most: usize) -> Vec<Vec<usize>> {
    (0..axes).fold(vec![Vec::new()], |all, _| {
        let longer = all.iter().flat_map(|powers: &Vec<usize>| {
            (0..=most - powers.iter().sum::<usize>()).map(|power| [powers.as_slice(), &[power]].concat())
        });
        longer.collect()
    })
}

/// A product of Chebyshev's polynomials, one for each axis, at all points.
fn product(axes: &[Vec<f64>], powers: &[usize]) -> Vec<f64> {
    let mut values = vec![1.0; axes[0].len()];
    for (axis, &power) in axes.iter().zip(powers) {
        values.iter_mut().zip(axis).for_each(|(value, &x)| *value *= chebyshev(x, power));
    }
    values
}

/// Chebyshev's polynomial of a degree, by the recurrence from degree to degree.
fn chebyshev(x: f64, degree: usize) -> f64 {
    let (mut value, mut next) = (1.0, x);
    for _ in 0..degree {
        (value, next) = (next, 2.0 * x * next - value);
    }
    value
}

/// What a function has beside those before it, with unit length; nothing if that is rounding.
fn orthonormal(mut mode: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let before = dot(&mode, &mode);
    // Twice is enough.
    for other in basis.iter().chain(basis) {
        let along = dot(&mode, other);
        mode.iter_mut().zip(other).for_each(|(value, other)| *value -= along * other);
    }
    let after = dot(&mode, &mode);
    if after <= 1e-12 * before {
        return None;
    }
    mode.iter_mut().for_each(|value| *value /= after.sqrt());
    Some(mode)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    fn scattered(random: &mut StdRng, count: usize) -> (Vec<f64>, Vec<f64>) {
        let places = (0..2 * count).map(|_| random.random::<f64>()).collect();
        (places, (0..count).map(|_| normal(random)).collect())
    }

    /// The largest of four normal numbers stays below five, but for one time in a million.
    #[test]
    fn noise_has_no_smooth_part() {
        for seed in 0..30 {
            let (places, misfits) = scattered(&mut StdRng::seed_from_u64(seed), 600);
            let (excess, _) = excess(&places, 2, &misfits, 1.0);
            assert!(excess < 5.0, "{seed}: {excess}");
        }
    }

    /// A plane fitted to each twentieth value is off by more than one fitted to all.
    #[test]
    fn an_answer_from_a_share_may_be_off_as_a_share_is() {
        let (mut by_share, mut by_all) = (0, 0);
        for seed in 0..30 {
            let (places, mut misfits) = scattered(&mut StdRng::seed_from_u64(seed), 4000);
            let rows = |step: usize| (0..4000).step_by(step).flat_map(|at| [1.0, places[2 * at], places[2 * at + 1]]);
            let design = nalgebra::DMatrix::from_row_iterator(200, 3, rows(20));
            let some = nalgebra::DVector::from_iterator(200, misfits.iter().step_by(20).copied());
            let plane = design.svd(true, true).solve(&some, 0.0).unwrap();
            let fitted = nalgebra::DMatrix::from_row_iterator(4000, 3, rows(1)) * plane;
            misfits.iter_mut().zip(fitted.iter()).for_each(|(misfit, fitted)| *misfit -= fitted);
            by_share += usize::from(excess(&places, 2, &misfits, 0.05).0 > 5.0);
            by_all += usize::from(excess(&places, 2, &misfits, 1.0).0 > 5.0);
        }
        assert!(by_share == 0 && by_all > 10, "{by_share} {by_all}");
    }

    /// Three hundredths of the noise's square, all in a few modes.
    #[test]
    fn a_smooth_misfit_far_below_the_noise_is_seen() {
        for seed in 0..30 {
            let (places, mut misfits) = scattered(&mut StdRng::seed_from_u64(seed), 2500);
            misfits
                .iter_mut()
                .zip(places.chunks(2))
                .for_each(|(misfit, at)| *misfit += 0.35 * (3.0 * at[0]).sin() * at[1]);
            let (excess, share) = excess(&places, 2, &misfits, 1.0);
            assert!(excess > 5.0 && share < 0.1, "{seed}: {excess} {share}");
        }
    }

    #[test]
    fn places_on_a_line_have_fewer_modes() {
        let places: Vec<f64> = (0..200).flat_map(|i| [f64::from(i), 1.0]).collect();
        let misfits: Vec<f64> = (0..200).map(|i| f64::from(i * i % 7) - 2.0).collect();
        assert!(excess(&places, 2, &misfits, 1.0).0.is_finite());
    }
}
