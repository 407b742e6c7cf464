//! Fresh noisy copies of measurements, made from a truth: settings are chosen on some and judged on others.

use nisp::schema::Scene;
use nisp_data::{DataError, Table};
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// What would have been measured of a truth: `t` and every observed column of the scene, at every `every`-th of its
/// rows, with Gaussian noise of standard deviation `noise` in each column's declared unit. The same seed gives the same
/// copy.
///
/// # Errors
/// A truth without one of the columns.
pub fn noisy_copy(truth: &Table, scene: &Scene, every: usize, noise: f64, seed: u64) -> Result<Table, DataError> {
    let mut random = StdRng::seed_from_u64(seed);
    let thin = |values: Vec<f64>| values.into_iter().step_by(every.max(1)).collect::<Vec<f64>>();
    let mut copy = Table::empty();
    copy.push("t", "s", &thin(truth.quantity("t", "s")?))?;
    for column in scene.groups.iter().flat_map(|group| group.columns) {
        let exact = thin(truth.quantity(column.name, column.unit.text)?);
        let noisy: Vec<f64> = exact.into_iter().map(|value| value + noise * normal(&mut random)).collect();
        copy.push(column.name, column.unit.text, &noisy)?;
    }
    Ok(copy)
}

/// A standard normal number: the polar method of Marsaglia and Bray.
fn normal(random: &mut StdRng) -> f64 {
    loop {
        let [x, y] = [(); 2].map(|()| 2.0 * random.random::<f64>() - 1.0);
        let square = x * x + y * y;
        if square > 0.0 && square < 1.0 {
            return x * (-2.0 * square.ln() / square).sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nisp::Scene as _;

    #[test]
    fn copies_have_the_noise_asked_for_and_their_seed_names_them() {
        let truth = include_bytes!("../../data/rlc/rlc_exponential.csv");
        let truth = Table::parse(std::path::Path::new("rlc.csv"), truth).unwrap();
        let scene = crate::rlc::rlc::recover::Scene::SCHEMA;
        let copy = |noise, seed| noisy_copy(&truth, scene, 2, noise, seed).unwrap().column("v").unwrap().to_vec();
        let exact = copy(0.0, 1);
        assert_eq!(exact.len(), 500);
        assert_eq!(exact[1], truth.column("v").unwrap()[2]);
        let noise: Vec<f64> = copy(0.3, 1).iter().zip(&exact).map(|(a, b)| a - b).collect();
        let deviation = (noise.iter().map(|x| x * x).sum::<f64>() / 500.0).sqrt();
        assert!((deviation - 0.3).abs() < 0.03, "{deviation}");
        assert_eq!(copy(0.3, 1), copy(0.3, 1));
        assert_ne!(copy(0.3, 1), copy(0.3, 2));
    }
}
