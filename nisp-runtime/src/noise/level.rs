//! Noise that goes with the level of what is measured: of a counter, or of an instrument that is off by a share of what it shows.

use super::differences::{EIGHT, differences, of_eighth};
use crate::solve::vector::root_mean_square;

/// Powers of the level that the noise may go with: of counts the root, of readings the level itself.
const POWERS: [f64; 2] = [0.5, 1.0];
/// Shares of the variance that may be alike all along.
const ALIKE: [f64; 6] = [1e-3, 0.01, 0.03, 0.1, 0.3, 0.6];
/// Gain of the logarithm of the likelihood from which on noise goes with the level. By chance few gain so much.
const CLEAR: f64 = 6.0;
/// Misfits that are off by more deviations than these count as if they were off by so many: outliers are no noise.
const FAR: f64 = 4.0;
/// Neighbouring eighth differences share most of their values: so many count as one.
const SHARED: f64 = 6.0;
/// The values that speak for a law most are left out: so many, and one of so many. What hits few large values alone is no noise of all.
const FEW: usize = 2;
const MANY: usize = 30;
/// Measurements that say something of it, at least.
const LEAST: usize = 20;

/// How noisy each measurement is beside the others, in the mean square one; nothing where all are alike. From what an answer says there and
/// what it misses; along a record, where values are in order, also from what they differ by: where the noise is taken for much smaller than it
/// is, a source follows it, and nothing is missed.
pub(crate) fn of_answer(values: &[f64], misfits: &[f64], is_record: bool) -> Option<Vec<f64>> {
    let (level, size) = (root_mean_square(values.iter().copied()), root_mean_square(misfits.iter().copied()));
    if values.len() < LEAST || !(level > 0.0 && size > 0.0 && (level / size).is_finite()) {
        return None;
    }
    let measured: Vec<f64> = values.iter().zip(misfits).map(|(value, misfit)| value - misfit).collect();
    let laws = || POWERS.iter().flat_map(|power| ALIKE.iter().map(move |alike| (*power, *alike)));
    let variances = |(power, alike): (f64, f64)| {
        let of = |value: &f64| alike + (1.0 - alike) * (value / level).abs().powf(2.0 * power);
        values.iter().map(of).collect::<Vec<f64>>()
    };
    // The likeliest law and its gain, of misfits that are made of values as `of` makes variances, each value in so many of them.
    let likeliest = |misfits: &[f64], of: &dyn Fn(Vec<f64>) -> Vec<f64>, shared: usize| {
        let alike = likelihoods(&vec![1.0; misfits.len()], misfits);
        let gain = |own: &[f64]| {
            let likely = likelihoods(&of(own.to_vec()), misfits);
            let mut gains: Vec<f64> = likely.iter().zip(&alike).map(|(own, alike)| own - alike).collect();
            gains.sort_by(f64::total_cmp);
            gains.truncate(gains.len().saturating_sub(shared * FEW + gains.len() / MANY));
            gains.iter().sum::<f64>()
        };
        laws().map(&variances).map(|own| (gain(&own), own)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let missed = likeliest(misfits, &|own| own, 1).filter(|(gain, _)| *gain > CLEAR);
    let found = missed.or_else(|| {
        let differences: Vec<f64> = differences(&measured).collect();
        let (gain, own) = likeliest(&differences, &|own| of_eighth(&own), EIGHT + 1)?;
        (is_record && differences.len() >= LEAST && gain > SHARED * CLEAR).then_some((gain, own))
    });
    let (_, variances) = found?;
    let mean = variances.iter().sum::<f64>() / variances.len() as f64;
    Some(variances.iter().map(|variance| (variance / mean).sqrt()).collect())
}

/// By misfit, the logarithm of the likelihood of normal ones with such variances, up to a factor that all share and that is the likeliest.
fn likelihoods(variances: &[f64], misfits: &[f64]) -> Vec<f64> {
    let over: Vec<f64> = misfits.iter().zip(variances).map(|(misfit, variance)| misfit * misfit / variance).collect();
    let mean = over.iter().sum::<f64>() / over.len() as f64;
    let near = |square: &f64| square.min(FAR * FAR * mean);
    let size = over.iter().map(near).sum::<f64>() / over.len() as f64;
    over.iter().zip(variances).map(|(own, variance)| -0.5 * (near(own) / size + (size * variance).ln())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    fn course(count: usize) -> Vec<f64> {
        (0..count).map(|at| 1000.0 * (-5.0 * at as f64 / count as f64).exp() + 20.0).collect()
    }

    /// Noise of counts, and of readings with a floor: what was put in is found again, to a fifth where it is large.
    #[test]
    fn noise_that_goes_with_the_level_is_found() {
        let mut random = StdRng::seed_from_u64(3);
        let values = course(200);
        let laws: [fn(f64) -> f64; 2] = [f64::sqrt, |value| (0.03 * value).hypot(2.0)];
        for law in laws {
            let misfits: Vec<f64> = values.iter().map(|value| law(*value) * normal(&mut random)).collect();
            let found = of_answer(&values, &misfits, true).unwrap();
            let mean = root_mean_square(values.iter().map(|value| law(*value)));
            for (found, value) in found.iter().zip(&values) {
                assert!((0.5..1.6).contains(&(found * mean / law(*value))), "{value}: {found}");
            }
            assert!((root_mean_square(found.iter().copied()) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_that_is_alike_is_left_so() {
        let mut random = StdRng::seed_from_u64(4);
        for _ in 0..200 {
            let misfits: Vec<f64> = (0..100).map(|_| normal(&mut random)).collect();
            assert_eq!(of_answer(&course(100), &misfits, true), None);
        }
        assert_eq!(of_answer(&[0.0; 30], &[1.0; 30], true), None);
        assert_eq!(of_answer(&[1.0; 30], &[0.0; 30], true), None);
    }
}
