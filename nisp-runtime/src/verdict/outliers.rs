//! Outliers in a record: values that stand alone, far from the course of their neighbours, where a squared loss follows them.

use nalgebra::{DMatrix, DVector};

/// Neighbours on each side whose course a value is compared with.
const SIDE: usize = 3;
/// Numbers that describe the course: a parabola.
const UNKNOWNS: usize = 3;
/// Distance from that course, over its own roughness and the noise, that chance does not make.
const FAR: f64 = 10.0;
/// Values on each side whose courses say how noisy the record is about a value: the quietest quarter of them, which outliers among
/// them leave alone. Three numbers that are left of one course are at times quiet by chance, and noise may grow with the values.
const AROUND: usize = 12;

/// The places of outliers among values in the order of their coordinate, and the sum of the squares of their distances over that
/// of noise of these deviations.
pub(crate) fn weight(places: &[f64], values: &[f64], deviations: &[f64]) -> (Vec<usize>, f64) {
    let mut courses = Vec::new();
    for at in SIDE..values.len().saturating_sub(SIDE) {
        let near: Vec<usize> = (at - SIDE..=at + SIDE).filter(|&other| other != at).collect();
        let reach = (places[at + SIDE] - places[at - SIDE]).abs().max(f64::MIN_POSITIVE);
        let away = |other: usize| (places[other] - places[at]) / reach;
        let rows = near.iter().flat_map(|&other| [1.0, away(other), away(other).powi(2)]);
        let design = DMatrix::from_row_iterator(near.len(), UNKNOWNS, rows);
        let around = DVector::from_iterator(near.len(), near.iter().map(|&other| values[other]));
        let Ok(course) = design.clone().svd(true, true).solve(&around, 1e-12) else { continue };
        let freedom = (near.len() - UNKNOWNS) as f64;
        let rough = ((&around - design * &course).norm_squared() / freedom).sqrt();
        courses.push((at, (values[at] - course[0]).abs(), rough));
    }
    let mut found = Vec::new();
    let mut sum = 0.0;
    for (number, &(at, distance, rough)) in courses.iter().enumerate() {
        let around = &courses[number.saturating_sub(AROUND)..(number + AROUND + 1).min(courses.len())];
        let mut around: Vec<f64> = around.iter().map(|(_, _, rough)| *rough).collect();
        around.sort_by(f64::total_cmp);
        let quiet = around[around.len() / 4];
        if distance > FAR * rough.max(quiet).max(deviations[at]) {
            found.push(at);
            sum += distance * distance;
        }
    }
    let noise: f64 = deviations.iter().map(|own| own * own).sum();
    (found, if sum > 0.0 { sum / noise } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    fn record(noise: f64, course: fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let mut random = StdRng::seed_from_u64(3);
        let places: Vec<f64> = (0..200).map(|i| 0.05 * f64::from(i)).collect();
        let values = places.iter().map(|&x| course(x) + noise * normal(&mut random)).collect();
        (places, values)
    }

    #[test]
    fn noise_layers_and_jumps_are_no_outliers() {
        for noise in [1e-6, 1e-2, 0.3] {
            let courses: [fn(f64) -> f64; 3] = [f64::sin, |x| (-x / 0.02).exp(), |x| if x > 5.02 { 1.0 } else { 0.0 }];
            for course in courses {
                let (places, values) = record(noise, course);
                assert_eq!(weight(&places, &values, &[noise; 200]), (vec![], 0.0));
            }
        }
    }

    /// Noise of a share of values that grow by a factor of e^5: the deviation of the record as a whole is that of small ones.
    #[test]
    fn noise_that_grows_with_the_values_is_no_outlier() {
        for seed in 0..20 {
            let mut random = StdRng::seed_from_u64(seed);
            let places: Vec<f64> = (0..200).map(|i| 0.025 * f64::from(i)).collect();
            let values: Vec<f64> = places.iter().map(|&x| x.exp() * (1.0 + 0.05 * normal(&mut random))).collect();
            assert_eq!(weight(&places, &values, &[0.05; 200]), (vec![], 0.0), "seed {seed}");
        }
    }

    #[test]
    fn values_that_stand_alone_are() {
        let (places, mut values) = record(1e-2, f64::sin);
        values[50] += 0.5;
        values[120] -= 0.5;
        let (found, weight) = weight(&places, &values, &[1e-2; 200]);
        assert_eq!(found, [50, 120]);
        // Two squares of fifty deviations over two hundred, up to the neighbours' noise.
        assert!((weight / 25.0 - 1.0).abs() < 0.2, "{weight}");
    }
}
