//! Initial weights.

use rand::{RngExt, SeedableRng, rngs::StdRng};

use super::Layout;

/// Glorot-normal weights and zero biases; row scales of factorised matrices are drawn from N(0.5, 0.1) and the weights
/// divided by them, as in the reference code. Learned scalars start at zero, where they stand for their start value.
pub fn initialise(layout: &Layout, seed: u64) -> Vec<f64> {
    let mut random = StdRng::seed_from_u64(seed);
    let mut theta = vec![0.0; layout.len];
    for m in layout.matrices() {
        let deviation = (2.0 / (m.rows + m.columns) as f64).sqrt();
        for i in 0..m.rows {
            let scale = m.scales.map_or(0.0, |at| {
                theta[at + i] = 0.5 + 0.1 * normal(&mut random);
                theta[at + i]
            });
            for weight in &mut theta[m.weights + i * m.columns..][..m.columns] {
                *weight = deviation * normal(&mut random) / f64::exp(scale);
            }
        }
    }
    theta
}

/// A standard normal number (Box and Muller).
pub(crate) fn normal(random: &mut StdRng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}
