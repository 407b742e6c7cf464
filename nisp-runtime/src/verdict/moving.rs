//! Records that went through a moving average: their spectrum is zero where the average lets nothing pass, which no noise does by itself.

use super::root_mean_square;

/// The differences that are looked at: a signal that is sampled well has next to none.
const ORDER: usize = 3;
/// Rows that are looked at, at least and at most.
const LEAST: usize = 20;
const MOST: usize = 400;
/// Longest running mean, and longest parabola on each side, in rows.
const LONGEST: usize = 25;
const WIDEST: usize = 10;
/// Rows on each side that show how large differences are about a row, at least, and the smallest that they may be there, as a share of all.
const NEARBY: usize = 8;
const FAINT: f64 = 1e-3;
/// Correlations of neighbouring rows' noise that are tried where nothing was averaged.
const CORRELATIONS: [f64; 8] = [0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98];
/// Variance of the signal's own differences over that of the noise of a row: tried by tens, and up to where noise is seen.
const SIGNALS: std::ops::RangeInclusive<i32> = -6..=4;
const SEEN: f64 = 10.0;
/// What digits of numbers leave of a row, as a share of the noise's variance.
const DIGITS: f64 = 1e-6;

/// A moving average of equal weights, or by parabolas (Savitzky and Golay 1964).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Average {
    Mean(usize),
    Parabola(usize),
}

/// The average that a record went through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub(super) average: Average,
    /// By how much it is likelier than any other average, and than none: a logarithm.
    pub(super) gain: f64,
    /// Standard deviation of the noise that it left.
    pub(super) deviation: f64,
    /// Rows that say so.
    pub(super) of: usize,
}

impl Average {
    /// Rows that are averaged.
    pub(super) fn rows(self) -> usize {
        match self {
            Self::Mean(rows) | Self::Parabola(rows) => rows,
        }
    }

    /// The weights of the rows.
    fn weights(self) -> Vec<f64> {
        match self {
            Self::Mean(rows) => vec![1.0 / rows as f64; rows],
            Self::Parabola(rows) => {
                let side = (rows / 2) as f64;
                let all = (2.0 * side + 3.0) * (2.0 * side + 1.0) * (2.0 * side - 1.0);
                let weight =
                    |at: usize| 3.0 * (3.0 * side * (side + 1.0) - 1.0 - 5.0 * (at as f64 - side).powi(2)) / all;
                (0..rows).map(weight).collect()
            }
        }
    }
}

/// A model of differences, by how likely they are.
#[derive(Clone, Copy)]
struct Fit {
    likelihood: f64,
    signal: f64,
    /// Variance of the noise of a row, before it was averaged.
    variance: f64,
}

/// The average that evenly spaced values went through, where that is likelier than noise that dies away along the rows.
pub(super) fn of(values: &[f64]) -> Option<Moving> {
    let values = &values[..values.len().min(MOST)];
    if values.len() < LEAST {
        return None;
    }
    let (differences, scale) = evened(differenced(values))?;
    let none = |correlation: f64| {
        let own = [1.0, -correlation];
        fit(&convolved(&differences, &own)[1..], &own, &[1.0])
    };
    let none = CORRELATIONS.iter().filter_map(|&own| none(own)).map(|fit| fit.likelihood).fold(f64::MIN, f64::max);
    let means = (2..=LONGEST).map(Average::Mean);
    let averages = means.chain((2..=WIDEST).map(|side| Average::Parabola(2 * side + 1)));
    let averages = averages.filter(|average| 4 * average.rows() < differences.len());
    let mut fits: Vec<(Average, Fit)> =
        averages.filter_map(|own| Some((own, fit(&differences[1..], &[1.0], &own.weights())?))).collect();
    fits.sort_by(|a, b| b.1.likelihood.total_cmp(&a.1.likelihood));
    let (average, best) = *fits.first()?;
    let next = fits.get(1).map_or(none, |(_, next)| next.likelihood.max(none));
    let left: f64 = average.weights().iter().map(|w| w * w).sum();
    let gain = best.likelihood - next;
    (best.signal <= SEEN).then_some(Moving {
        average,
        gain,
        deviation: scale * (left * best.variance).sqrt(),
        of: values.len(),
    })
}

/// The likeliest mixture of a signal and noise, of which both went through a filter and an average.
fn fit(differences: &[f64], filter: &[f64], average: &[f64]) -> Option<Fit> {
    let signal = covariance(&convolved_whole(filter, average));
    let mut noise = covariance(&convolved_whole(&differenced_impulse(), average));
    noise.resize(noise.len().max(signal.len()), 0.0);
    let digits = covariance(&differenced_impulse());
    noise.iter_mut().zip(&digits).for_each(|(own, digits)| *own += DIGITS * digits);
    let fits = SIGNALS.filter_map(|power| {
        let share = 10.0_f64.powi(power);
        let mut all = noise.clone();
        all.iter_mut().zip(&signal).for_each(|(all, own)| *all += share * own);
        let (likelihood, variance) = likelihood(differences, &all)?;
        Some(Fit { likelihood, signal: share, variance })
    });
    fits.max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))
}

/// How likely values are whose covariance depends on their distance alone and ends with it, but for its size; a logarithm, and that size.
fn likelihood(values: &[f64], covariance: &[f64]) -> Option<(f64, f64)> {
    let width = covariance.len();
    // The last rows of the Cholesky factor, each from its diagonal to the left, and what they leave of the values.
    let mut factor = vec![0.0; width * values.len()];
    let mut own = vec![0.0; values.len()];
    let mut diagonal = 0.0;
    for i in 0..values.len() {
        let (before, row) = factor.split_at_mut(i * width);
        let row = &mut row[..width];
        let mut left = values[i];
        for d in (0..width.min(i + 1)).rev() {
            let other = if d == 0 { &[] } else { &before[(i - d) * width..][..width - d] };
            let sum: f64 = if d == 0 {
                row[1..].iter().map(|x| x * x).sum()
            } else {
                other[1..].iter().zip(&row[d + 1..]).map(|(a, b)| a * b).sum()
            };
            row[d] = covariance[d] - sum;
            if d > 0 {
                row[d] /= other[0];
                left -= row[d] * own[i - d];
            }
        }
        row[0] = Some(row[0].sqrt()).filter(|root| *root > 0.0)?;
        own[i] = left / row[0];
        diagonal += row[0].ln();
    }
    let size = own.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
    Some((-0.5 * values.len() as f64 * size.ln() - diagonal, size)).filter(|found| found.0.is_finite())
}

/// Covariances of white noise of variance one through a filter, by distance.
fn covariance(filter: &[f64]) -> Vec<f64> {
    (0..filter.len()).map(|lag| filter.iter().zip(&filter[lag..]).map(|(a, b)| a * b).sum()).collect()
}

/// Values over their root mean square in the rows about each, where noise may go with the level of what is measured, and the root mean square of all;
/// nothing where all are zero.
fn evened(values: Vec<f64>) -> Option<(Vec<f64>, f64)> {
    let scale = root_mean_square(values.iter().copied());
    let reach = NEARBY.max(values.len() / 8);
    let about = |at: usize| &values[at.saturating_sub(reach)..(at + reach + 1).min(values.len())];
    let size = |at: usize| root_mean_square(about(at).iter().copied()).max(FAINT * scale);
    (scale > 0.0).then(|| ((0..values.len()).map(|at| values[at] / size(at)).collect(), scale))
}

fn differenced(values: &[f64]) -> Vec<f64> {
    (0..ORDER).fold(values.to_vec(), |own, _| own.windows(2).map(|pair| pair[1] - pair[0]).collect())
}

/// What differences make of a single value.
fn differenced_impulse() -> Vec<f64> {
    (0..ORDER).fold(vec![1.0], |own, _| convolved_whole(&own, &[1.0, -1.0]))
}

/// Values through a filter of two weights; the first as it is.
fn convolved(values: &[f64], [own, last]: &[f64; 2]) -> Vec<f64> {
    (0..values.len()).map(|i| if i == 0 { values[0] } else { own * values[i] + last * values[i - 1] }).collect()
}

/// Two filters, one after the other.
fn convolved_whole(first: &[f64], second: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; first.len() + second.len() - 1];
    for (i, a) in first.iter().enumerate() {
        second.iter().enumerate().for_each(|(j, b)| all[i + j] += a * b);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    /// A slow signal with noise at every row.
    fn record(count: usize, seed: u64, correlation: f64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut own = normal(&mut random);
        let mut next = |at: usize| {
            own = correlation * own + (1.0 - correlation * correlation).sqrt() * normal(&mut random);
            20.0 * (0.05 * at as f64).sin() + own
        };
        (0..count).map(&mut next).collect()
    }

    fn averaged(values: &[f64], average: Average) -> Vec<f64> {
        let weights = average.weights();
        values.windows(weights.len()).map(|own| own.iter().zip(&weights).map(|(y, w)| y * w).sum()).collect()
    }

    #[test]
    fn averages_are_found_by_what_they_let_not_pass() {
        for average in
            [Average::Mean(3), Average::Mean(5), Average::Mean(12), Average::Parabola(7), Average::Parabola(11)]
        {
            for seed in 0..4 {
                let found = of(&averaged(&record(200, seed, 0.0), average)).unwrap();
                let deviation = average.weights().iter().map(|w| w * w).sum::<f64>().sqrt();
                assert_eq!(found.average, average);
                assert!(found.gain > 10.0 && (found.deviation / deviation - 1.0).abs() < 0.2, "{found:?} {deviation}");
            }
        }
    }

    /// Readings that are a share off: most of the noise is in a few rows.
    #[test]
    fn noise_that_goes_with_the_level_is_no_average() {
        for seed in 20..60 {
            let mut random = StdRng::seed_from_u64(seed);
            let values: Vec<f64> =
                (0..80).map(|at| (-0.1 * at as f64).exp() * (1.0 + 0.05 * normal(&mut random))).collect();
            let found = of(&values);
            assert!(found.is_none_or(|found| found.gain < 8.0), "{seed} {found:?}");
        }
    }

    #[test]
    fn noise_that_was_not_averaged_is_no_average() {
        for correlation in [0.0, 0.4, 0.75, 0.9] {
            for seed in 10..20 {
                for count in [30, 60, 400] {
                    let found = of(&record(count, seed, correlation));
                    assert!(found.is_none_or(|found| found.gain < 8.0), "{correlation} {seed} {count} {found:?}");
                }
            }
        }
    }

    /// A parabola, and a straight line, pass a moving parabola as they are (Savitzky and Golay 1964).
    #[test]
    fn parabolas_pass_a_moving_parabola() {
        let values: Vec<f64> = (0..30).map(|at| 3.0 - at as f64 + 0.1 * (at * at) as f64).collect();
        let found = averaged(&values, Average::Parabola(9));
        assert!(found.iter().zip(&values[4..]).all(|(found, own)| (found - own).abs() < 1e-10));
    }

    #[test]
    fn a_likelihood_is_that_of_the_whole_matrix() {
        use nalgebra::{DMatrix, DVector};
        let (values, by_distance) = (record(12, 1, 0.0), [2.0, -0.7, 0.3]);
        let matrix = DMatrix::from_fn(12, 12, |i, j: usize| by_distance.get(i.abs_diff(j)).copied().unwrap_or(0.0));
        let vector = DVector::from_vec(values.clone());
        let size = vector.dot(&matrix.clone().lu().solve(&vector).unwrap()) / 12.0;
        let expected = -6.0 * size.ln() - 0.5 * matrix.determinant().ln();
        let found = likelihood(&values, &by_distance).unwrap();
        assert!((found.0 - expected).abs() < 1e-9 && (found.1 / size - 1.0).abs() < 1e-9);
    }
}
