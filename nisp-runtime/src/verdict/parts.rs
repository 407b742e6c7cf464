//! Noise that is not the same all along a record: it grows with time, or a sensor is worse in a part of it.

use super::misfits::Misfits;
use super::root_mean_square;
use crate::noise::{by_differences, in_order};

/// Parts of a record.
const PARTS: usize = 4;
/// Rows of a part that say how noisy it is, at least.
const FEW: usize = 25;

/// The root mean square of the noise of a record whose parts are unlike; nothing of short records, and over several coordinates.
/// The median over the whole record, by which noise is judged otherwise, is that of its quieter parts.
pub(super) fn noise(left: &Misfits) -> Option<f64> {
    let of = |&column: &usize| {
        let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
        by_parts(&in_order(&left.places, &values))
    };
    let columns = left.term.columns.iter().filter(|_| left.is_record()).map(of);
    columns.collect::<Option<Vec<f64>>>().filter(|levels| !levels.is_empty()).map(root_mean_square)
}

/// The same of values in their order.
fn by_parts(values: &[f64]) -> Option<f64> {
    let rows = |part: usize| part * values.len() / PARTS..(part + 1) * values.len() / PARTS;
    let levels = (0..PARTS).map(|part| by_differences(&values[rows(part)]));
    levels.collect::<Option<Vec<f64>>>().filter(|_| values.len() >= PARTS * FEW).map(root_mean_square)
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

    #[test]
    fn noise_that_is_the_same_all_along_is_found_by_parts_too() {
        let [parts, whole] = off(200, |_| 1.0);
        assert!((parts - 1.0).abs() < 0.1 && (whole - 1.0).abs() < 0.1, "{parts} {whole}");
        assert_eq!(by_parts(&[1.0; 99]), None);
    }
}
