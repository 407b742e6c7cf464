//! Noise that is not the same all along a record: it grows with time, a sensor is worse in a part of it, or what is large is noisier
//! than what is small.

use super::misfits::Misfits;
use super::root_mean_square;
use crate::noise::{EIGHT, by_differences, differences, in_order, of_differences};

/// Parts of a record at most.
const PARTS: usize = 4;
/// Sizes of values that are told apart at most.
const SIZES: usize = 16;
/// Rows of a part that say how noisy it is, at least.
const FEW: usize = 25;

/// The root mean square of the noise of a record whose parts are unlike, whichever of two ways to part it shows more; nothing of short
/// records, and over several coordinates. The median over the whole record, by which noise is judged otherwise, is that of its quieter
/// parts.
pub(super) fn noise(left: &Misfits) -> Option<f64> {
    let of = |&column: &usize| {
        let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
        let values = in_order(&left.places, &values);
        Some(by_parts(&values)?.max(by_size(&values)?))
    };
    let columns = left.term.columns.iter().filter(|_| left.is_record()).map(of);
    columns.collect::<Option<Vec<f64>>>().filter(|levels| !levels.is_empty()).map(root_mean_square)
}

/// Parts that are long enough to say how noisy they are; nothing of fewer than two.
fn parts(rows: usize, most: usize) -> Option<usize> {
    Some((rows / FEW).min(most)).filter(|parts| *parts > 1)
}

/// The same for values in their order: the parts are those of the record.
fn by_parts(values: &[f64]) -> Option<f64> {
    let parts = parts(values.len(), PARTS)?;
    let rows = |part: usize| part * values.len() / parts..(part + 1) * values.len() / parts;
    let levels = (0..parts).map(|part| by_differences(&values[rows(part)]));
    levels.collect::<Option<Vec<f64>>>().map(root_mean_square)
}

/// The same by how large the values are, as finely as they say: what dies away is hardly ever as large as it was.
fn by_size(values: &[f64]) -> Option<f64> {
    let parts = parts(values.len(), SIZES)?;
    let sizes = values.windows(EIGHT + 1).map(|near| root_mean_square(near.iter().copied()));
    let mut sorted: Vec<(f64, f64)> = sizes.zip(differences(values)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rows = |part: usize| part * sorted.len() / parts..(part + 1) * sorted.len() / parts;
    let level = |part: usize| of_differences(sorted[rows(part)].iter().map(|(_, difference)| *difference).collect());
    (0..parts).map(level).collect::<Option<Vec<f64>>>().map(root_mean_square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    /// How far the root mean square of noise of these deviations is off what is found of it by parts, and by the whole.
    fn off(count: usize, deviation: impl Fn(f64) -> f64) -> [f64; 2] {
        let seeds = 0..60;
        let ratios = seeds.map(|seed| {
            let mut random = StdRng::seed_from_u64(seed);
            let at = |row: usize| row as f64 / count as f64;
            let noise: Vec<f64> = (0..count).map(|row| deviation(at(row)) * normal(&mut random)).collect();
            let size = root_mean_square(noise.iter().copied());
            let values: Vec<f64> = noise.iter().enumerate().map(|(row, noise)| 9.0 * at(row).sin() + noise).collect();
            [by_parts(&values).unwrap(), by_differences(&values).unwrap()].map(|found| size / found)
        });
        let all: Vec<[f64; 2]> = ratios.collect();
        [0, 1].map(|way| all.iter().map(|ratios| ratios[way]).sum::<f64>() / all.len() as f64)
    }

    #[test]
    fn noise_of_a_part_is_noise() {
        let [parts, whole] = off(200, |at| if at < 0.5 { 0.2 } else { 1.0 });
        assert!((parts - 1.0).abs() < 0.1 && whole > 1.6, "{parts} {whole}");
        let [parts, whole] = off(200, |at| 0.1 + 1.8 * at);
        assert!((parts - 1.0).abs() < 0.1 && whole > 1.3, "{parts} {whole}");
    }

    /// Half of so many rows is as few as says anything.
    #[test]
    fn noise_of_a_half_of_few_rows_is_noise() {
        let [parts, whole] = off(60, |at| if at < 0.5 { 0.2 } else { 1.0 });
        assert!((parts - 1.0).abs() < 0.25 && whole > 1.5, "{parts} {whole}");
    }

    /// A tenth of each value, of a wave that passes zero many times: no part of the record is noisier than another.
    #[test]
    fn noise_that_is_a_share_of_a_wave_is_noise() {
        let mut ratios = [0.0; 2];
        for seed in 0..40 {
            let mut random = StdRng::seed_from_u64(seed);
            let wave: Vec<f64> =
                (0..300).map(|row| (0.06 * f64::from(row)).sin() * (-0.01 * f64::from(row)).exp()).collect();
            let noise: Vec<f64> = wave.iter().map(|value| 0.1 * value * normal(&mut random)).collect();
            let values: Vec<f64> = wave.iter().zip(&noise).map(|(value, noise)| value + noise).collect();
            let size = root_mean_square(noise.iter().copied());
            let found = [by_size(&values).unwrap(), by_differences(&values).unwrap()];
            ratios.iter_mut().zip(found).for_each(|(ratio, found)| *ratio += size / found / 40.0);
        }
        assert!((ratios[0] - 1.0).abs() < 0.2 && ratios[1] > 1.6, "{ratios:?}");
    }

    #[test]
    fn noise_that_is_the_same_all_along_is_found_by_parts_too() {
        let [parts, whole] = off(200, |_| 1.0);
        assert!((parts - 1.0).abs() < 0.1 && (whole - 1.0).abs() < 0.1, "{parts} {whole}");
        assert_eq!(by_parts(&[1.0; 49]), None);
    }
}
