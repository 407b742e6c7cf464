//! Noise that is larger in some parts of a record than in others: a sensor that shook for a while, or one that was exchanged.

use std::ops::Range;

use super::differences::{EIGHT, differences, of_differences};
use super::fits::quantile;
use crate::ends::ends as ends_of;
use crate::solve::vector::root_mean_square;

/// Variance of an eighth difference of values of variance one.
const EIGHTH_SQUARED: f64 = 12870.0;
/// Rows of a block that says how noisy it is, at least, and blocks of a record, at most.
const ROWS: usize = 24;
const BLOCKS: usize = 64;
/// Neighbouring eighth differences share most of their values: so many count as one.
const SHARED: f64 = 6.0;
/// Variance of the logarithm of a deviation by the median of magnitudes, times the values that say so.
const BY_MEDIAN: f64 = 1.35;
/// Gain of the logarithm of the likelihood from which on a part is one, and what all parts together have to gain of what is missed.
const CUT: f64 = 5.0;
const CLEAR: f64 = 10.0;
/// Least ratio of the noise of two parts that matters.
const LEAST: f64 = 2.0;

/// How noisy each measurement is beside the others, in the mean square one; nothing where parts of the record are alike. Values are in order.
/// Both what they differ by and what an answer misses must say so: where a source changes within few rows they differ by more, and an answer
/// follows that.
pub(crate) fn along(measured: &[f64], misfits: &[f64]) -> Option<Vec<f64>> {
    let rows = ROWS.max(measured.len().div_ceil(BLOCKS));
    let count = measured.len() / rows;
    let block = |at: usize| at * measured.len() / count..(at + 1) * measured.len() / count;
    if count < 2 {
        return None;
    }
    let level = |at: usize| {
        let own = block(at);
        let end = (own.end + EIGHT / 2).min(measured.len());
        let found = of_differences(differences(&measured[own.start.saturating_sub(EIGHT / 2)..end]).collect())?;
        (found > 0.0).then(|| found.ln())
    };
    let levels: Vec<f64> = (0..count).map(level).collect::<Option<_>>()?;
    let mut ends: Vec<usize> =
        cut(&levels, rows as f64 / SHARED / BY_MEDIAN).into_iter().map(|end| block(end - 1).end).collect();
    let noisy = |part: Range<usize>| of_differences(differences(&measured[part]).collect());
    let rough: Vec<f64> = parts(&ends).into_iter().map(noisy).collect::<Option<_>>()?;
    // Blocks end beside where the noise changes.
    let found: Vec<f64> = differences(measured).collect();
    for (at, pair) in rough.windows(2).enumerate() {
        ends[at] = change(&found, ends[at], rows / 2 - 2, [pair[0], pair[1]]);
    }
    let parts = parts(&ends);
    let noisy: Vec<f64> = parts.iter().cloned().map(noisy).collect::<Option<_>>()?;
    let missed = |part: &Range<usize>| quantile(misfits[part.clone()].iter().map(|x| x.abs()).collect(), 0.5);
    let missed: Vec<f64> = parts.iter().map(missed).collect::<Option<_>>()?;
    // By how much one deviation for each part is likelier than one for all.
    let counts = || parts.iter().map(|part| part.len() as f64);
    let alike = (counts().zip(&missed).map(|(n, own)| n * own * own).sum::<f64>() / measured.len() as f64).sqrt();
    let gain = counts().zip(&missed).map(|(n, own)| n / BY_MEDIAN * (alike / own).ln()).sum::<f64>();
    let (least, largest) = ends_of(noisy.iter().copied());
    let each = parts.iter().zip(&noisy).flat_map(|(part, own)| std::iter::repeat_n(*own, part.len()));
    let mut noisiness: Vec<f64> = each.collect();
    let mean = root_mean_square(noisiness.iter().copied());
    noisiness.iter_mut().for_each(|own| *own /= mean);
    (gain > CLEAR && largest > LEAST * least).then_some(noisiness)
}

/// The rows of all parts that end there.
fn parts(ends: &[usize]) -> Vec<Range<usize>> {
    let starts = [0].into_iter().chain(ends.iter().copied());
    starts.zip(ends).map(|(from, end)| from..*end).collect()
}

/// The row nearest to an end, within so many rows of it, from which on these eighth differences are likelier of noise of the second deviation
/// than of the first.
fn change(found: &[f64], end: usize, within: usize, deviations: [f64; 2]) -> usize {
    let [first, second] =
        deviations.map(|own| move |row: usize| own.ln() + (found[row] / own).powi(2) / (2.0 * EIGHTH_SQUARED));
    let side = EIGHT / 2;
    let (from, to) = (end.saturating_sub(within + side), (end + within).saturating_sub(side).min(found.len()));
    // What it costs if the change is before a row, beside one before the first.
    let mut cost = 0.0;
    let costs = (from..to).map(|row| {
        let own = cost;
        cost += first(row) - second(row);
        (own, row)
    });
    costs.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(end, |(_, row)| row + side)
}

/// Where the parts end in which levels are alike, where each level is known to the inverse of such a variance: of all ways to cut them the
/// likeliest, if each part has to gain [`CUT`].
fn cut(levels: &[f64], known: f64) -> Vec<usize> {
    let cost = |own: &[f64]| {
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        CUT + 0.5 * known * own.iter().map(|level| (level - mean).powi(2)).sum::<f64>()
    };
    // By end: what the best parts up to there cost, and where the last of them begins.
    let mut best = vec![(0.0, 0)];
    for end in 1..=levels.len() {
        let from = (0..end).map(|from| (best[from].0 + cost(&levels[from..end]), from));
        best.extend(from.min_by(|a, b| a.0.total_cmp(&b.0)));
    }
    let mut ends = vec![levels.len()];
    while let Some(&end) = ends.last().filter(|end| best[**end].1 > 0) {
        ends.push(best[end].1);
    }
    ends.reverse();
    ends
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    fn record(seed: u64, count: usize, deviation: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let mut random = StdRng::seed_from_u64(seed);
        let at = |row: usize| row as f64 / count as f64;
        let misfits: Vec<f64> = (0..count).map(|row| deviation(at(row)) * normal(&mut random)).collect();
        (misfits.iter().enumerate().map(|(row, noise)| 9.0 * at(row).sin() + noise).collect(), misfits)
    }

    #[test]
    fn a_part_that_is_noisier_is_found() {
        for seed in 0..20 {
            let (values, misfits) = record(seed, 400, |at| if at < 0.5 { 0.1 } else { 1.0 });
            let found = along(&values, &misfits).unwrap();
            let ratio = found[350] / found[50];
            assert!((6.0..16.0).contains(&ratio), "{ratio}");
            assert!((root_mean_square(found) - 1.0).abs() < 1e-12);
        }
        let (values, misfits) = record(30, 400, |at| if (0.4..0.6).contains(&at) { 0.8 } else { 0.1 });
        let found = along(&values, &misfits).unwrap();
        assert!(found[200] > 4.0 * found[50] && found[200] > 4.0 * found[350]);
    }

    #[test]
    fn noise_that_is_alike_is_left_so() {
        for seed in 0..200 {
            let (values, misfits) = record(seed, 300, |_| 1.0);
            assert_eq!(along(&values, &misfits), None, "{seed}");
        }
    }

    /// Neither strays nor a source that changes within few rows, which an answer follows.
    #[test]
    fn strays_and_quick_changes_are_no_noise() {
        let (mut values, mut misfits) = record(1, 300, |_| 0.1);
        for at in [40, 170, 171] {
            values[at] += 20.0;
            misfits[at] += 20.0;
        }
        assert_eq!(along(&values, &misfits), None);
        let (mut values, misfits) = record(2, 300, |_| 0.1);
        values.iter_mut().enumerate().skip(150).for_each(|(row, value)| *value += (2.0 * row as f64).sin());
        assert_eq!(along(&values, &misfits), None);
    }
}
