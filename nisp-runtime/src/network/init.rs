//! Initial weights.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng, rngs::StdRng};

use super::{Activation, Kind, Layout};

/// Standard deviation of the slope of a first sine layer's argument, in radians per half the domain. Sitzmann et al. take
/// 30 / sqrt(3), for images; what is recovered under noise is smoother.
const FIRST_SLOPE: f64 = 3.0;

/// Weights are normal, and biases zero; row scales of factorised matrices are drawn from N(0.5, 0.1) and the weights
/// divided by them, as in the reference code. Learned scalars start at zero, where they stand for their start value.
///
/// Weights of tanh and of heads have Glorot's variance. With sines, arguments of all hidden layers have variance one, as in
/// Sitzmann et al., "Implicit neural representations with periodic activation functions" (2020). The first sines have
/// phases from all over the circle.
pub fn initialise(layout: &Layout, seed: u64) -> Vec<f64> {
    let mut random = StdRng::seed_from_u64(seed);
    let mut theta = vec![0.0; layout.len];
    let is_sine = layout.architecture.activation == Activation::Sine;
    let hidden = layout.affine.len()..layout.affine.len() + layout.hidden.len();
    for (at, m) in layout.matrices().enumerate() {
        let variance = match layout.architecture.kind {
            _ if !is_sine || at >= hidden.end => 2.0 / (m.rows + m.columns) as f64,
            _ if at < hidden.start => FIRST_SLOPE * FIRST_SLOPE / m.columns as f64,
            // A sine's mean square is 1/2. That of `c z + d (1 - z)` with sines c, d and z is 1.
            Kind::Plain => 2.0 / m.columns as f64,
            Kind::Modified => 1.0 / m.columns as f64,
        };
        let deviation = variance.sqrt();
        for i in 0..m.rows {
            let scale = m.scales.map_or(0.0, |at| {
                theta[at + i] = 0.5 + 0.1 * normal(&mut random);
                theta[at + i]
            });
            for weight in &mut theta[m.weights + i * m.columns..][..m.columns] {
                *weight = deviation * normal(&mut random) / f64::exp(scale);
            }
        }
        if is_sine && at < hidden.start {
            theta[m.bias..m.bias + m.rows].fill_with(|| PI * (2.0 * random.random::<f64>() - 1.0));
        }
    }
    theta
}

/// A standard normal number (Box and Muller).
pub(crate) fn normal(random: &mut StdRng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Architecture, Matrix};

    fn product(m: &Matrix, theta: &[f64], input: &[f64]) -> Vec<f64> {
        let row = |i: usize| theta[m.weights + i * m.columns..][..m.columns].iter().zip(input).map(|(w, x)| w * x);
        (0..m.rows).map(|i| row(i).sum::<f64>() + theta[m.bias + i]).collect()
    }

    fn sines(arguments: Vec<f64>) -> Vec<f64> {
        arguments.into_iter().map(f64::sin).collect()
    }

    #[test]
    fn arguments_of_hidden_sines_have_variance_one_at_any_depth() {
        for architecture in [Architecture::plain(300, 6), Architecture::modified(300, 6)] {
            let architecture = Architecture { activation: Activation::Sine, ..architecture };
            let layout = Layout::new(architecture, 2, 1, 0, 1);
            let theta = initialise(&layout, 7);
            for point in [[0.0, 0.0], [-0.9, 0.3], [1.0, 1.0]] {
                let lifted: Vec<Vec<f64>> = layout.affine.iter().map(|m| sines(product(m, &theta, &point))).collect();
                let gate = |z: Vec<f64>| match architecture.kind {
                    Kind::Plain => z,
                    Kind::Modified => (0..z.len()).map(|i| lifted[1][i] * z[i] + lifted[2][i] * (1.0 - z[i])).collect(),
                };
                let mut z = gate(lifted[0].clone());
                for m in &layout.hidden {
                    let arguments = product(m, &theta, &z);
                    let variance = arguments.iter().map(|a| a * a).sum::<f64>() / arguments.len() as f64;
                    // Of 300 squares of normal numbers the mean has a standard deviation of 0.08.
                    assert!((variance - 1.0).abs() < 0.4, "{}: {variance}", m.name);
                    z = gate(sines(arguments));
                }
            }
        }
    }
}
