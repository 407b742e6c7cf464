//! Whether a record is missed in one stretch of it, however well the rest is met.

use super::misfits::MISFIT;
use super::slow::chance;
use crate::noise::by_differences;

/// Rows of the shortest stretch; longer ones have twice as many each time, up to a quarter of the record.
const SHORTEST: usize = 16;
/// Misfits count as no more than so many deviations, so that a few outliers do not make a stretch.
const LARGEST: f64 = 3.0;
/// Deviations that chance may make of the worst of all stretches.
const CHANCE: f64 = 6.0;

/// The stretch of a record that is missed most.
pub(super) struct Stretch {
    /// Its first row, and the one after its last.
    pub(super) rows: (usize, usize),
    /// Its misfit over the noise (rms), no misfit counted as more than three deviations, and how much may be.
    pub(super) size: f64,
    pub(super) limit: f64,
}

/// The worst stretch of ordered misfits; nothing where the record is too short to have any. `values` are the data that are
/// missed, and `noise` is theirs. Data may be noisier in one part of a record than in others: differences of neighbours say so.
pub(super) fn worst(misfits: &[f64], values: &[f64], noise: f64) -> Option<Stretch> {
    let lengths = std::iter::successors(Some(SHORTEST), |length| Some(2 * length));
    let lengths = lengths.take_while(|length| 4 * length <= misfits.len());
    let starts = |length: usize| {
        let last = misfits.len() - length;
        (0..last).step_by(length / 2).chain([last]).map(move |start| (start, start + length))
    };
    let stretch = |(from, to): (usize, usize)| {
        // Where noise grows, a stretch on both sides of that is as noisy as the one behind it.
        let length = to - from;
        let beside = [from.saturating_sub(length)..from, from..to, to..(to + length).min(values.len())];
        let levels = beside.into_iter().filter_map(|rows| by_differences(&values[rows]));
        let level = levels.fold(noise, f64::max);
        let square: f64 = misfits[from..to].iter().map(|misfit| (misfit / level).abs().min(LARGEST).powi(2)).sum();
        let limit = MISFIT.max(chance(to - from, CHANCE));
        Stretch { rows: (from, to), size: (square / (to - from) as f64).sqrt(), limit }
    };
    let worse = |a: &Stretch, b: &Stretch| (a.size / a.limit).total_cmp(&(b.size / b.limit));
    lengths.flat_map(starts).map(stretch).max_by(worse).filter(|_| noise > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    /// Noise of deviation one about a slow course.
    fn record(seed: u64, count: usize) -> (Vec<f64>, Vec<f64>) {
        let mut random = StdRng::seed_from_u64(seed);
        let noise: Vec<f64> = (0..count).map(|_| normal(&mut random)).collect();
        let values = noise.iter().enumerate().map(|(row, noise)| 30.0 * (row as f64 / 200.0).sin() + noise).collect();
        (noise, values)
    }

    #[test]
    fn noise_misses_no_stretch() {
        for seed in 0..40 {
            let (misfits, values) = record(seed, 1000);
            let worst = worst(&misfits, &values, 1.0).unwrap();
            assert!(worst.size < worst.limit, "{seed}: {} of {}", worst.size, worst.limit);
        }
    }

    /// Twenty rows of a thousand: a twentieth of the square of all misfits.
    #[test]
    fn a_short_stretch_is_found_where_it_is() {
        let (mut misfits, mut values) = record(3, 1000);
        for row in 700..720 {
            misfits[row] += 4.0;
            values[row] += 4.0;
        }
        let worst = worst(&misfits, &values, 1.0).unwrap();
        assert!(worst.size > worst.limit);
        assert!(worst.rows.0 <= 708 && worst.rows.1 >= 712, "{:?}", worst.rows);
    }

    /// A long stretch that is a little noisier does not hide a short one that is missed.
    #[test]
    fn a_long_stretch_hides_no_short_one() {
        let (mut misfits, values) = record(6, 8000);
        misfits[..4000].iter_mut().for_each(|misfit| *misfit *= 1.3);
        misfits[6000..6020].iter_mut().for_each(|misfit| *misfit += 5.0);
        let worst = worst(&misfits, &values, 1.0).unwrap();
        assert!(worst.size > worst.limit && worst.rows.0 > 5900, "{:?}", worst.rows);
    }

    #[test]
    fn an_outlier_makes_no_stretch() {
        let (mut misfits, mut values) = record(4, 1000);
        misfits[300] += 1000.0;
        values[300] += 1000.0;
        let worst = worst(&misfits, &values, 1.0).unwrap();
        assert!(worst.size < worst.limit);
    }

    /// A sensor whose noise is four times as large in a part of the record.
    #[test]
    fn noise_may_vary_along_a_record() {
        let (mut misfits, mut values) = record(5, 1000);
        for row in 400..600 {
            values[row] += 3.0 * misfits[row];
            misfits[row] *= 4.0;
        }
        let worst = worst(&misfits, &values, 1.0).unwrap();
        assert!(worst.size < worst.limit);
    }
}
