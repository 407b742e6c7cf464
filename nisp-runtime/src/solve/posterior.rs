//! Error bars: the Gaussian (Laplace) approximation of the posterior around a minimum.

use super::curvature::Curvature;
use super::dense;
use super::vector;

/// What is known about reported quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// The part of every quantity's standard deviation that comes from the noise of measurements and the spread of beliefs.
    /// Tolerances of equations are no noise: the truth meets equations exactly, and errors follow from its rows alone.
    pub by_noise: Vec<f64>,
    /// The part that the prior vouches for: the deviation of what smoothing takes away, if the truth is as the prior
    /// believes.
    pub by_prior: Vec<f64>,
}

/// A pattern over the reported quantities that may be added to them at little cost in loss.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// The pattern, of unit length; its largest entry is positive.
    pub shape: Vec<f64>,
    /// Standard deviation of its amplitude.
    pub deviation: f64,
    /// Share of the sum of all variances.
    pub share: f64,
    /// Share of the prior's variance of this pattern that the rows have removed: near 1 for what the data determine,
    /// near 0 for what they say nothing about. Absent where some parameter has a flat prior.
    pub learned: Option<f64>,
}

/// The posterior of quantities whose derivatives by the parameters are the rows of `derivatives` (row-major,
/// quantities x parameters).
pub fn posterior(curvature: &Curvature, derivatives: &[f64]) -> Posterior {
    let len = curvature.parameters();
    let mut spread = derivatives.to_vec();
    let count = curvature.variances(&mut spread).len();
    // H^-1 = H^-1 J^T J H^-1 + H^-1 A H^-1: rows and prior.
    curvature.cholesky.solve_upper(&mut spread, count);
    let mut by_noise = vec![0.0; count];
    for rows in &curvature.random {
        let jacobian = &curvature.jacobian[rows.start * len..rows.end * len];
        dense::add_squares_of_products(&spread, jacobian, len, &mut by_noise);
    }
    let by_prior = spread.chunks_exact(len.max(1)).map(|x| {
        let square: f64 = x.iter().zip(&curvature.precision).map(|(x, a)| a * x * x).sum();
        square.sqrt()
    });
    Posterior { by_noise: by_noise.into_iter().map(f64::sqrt).collect(), by_prior: by_prior.collect() }
}

/// The leading directions of the covariance of quantities given as for [`posterior`], largest first and `most` at most.
pub fn directions(curvature: &Curvature, derivatives: &[f64], most: usize) -> Vec<Direction> {
    let mut spread = derivatives.to_vec();
    let variances = curvature.variances(&mut spread);
    let total: f64 = variances.iter().sum();
    let leading = leading(&spread, variances.len(), curvature.parameters(), most).into_iter();
    leading
        .map(|(variance, shape)| Direction {
            deviation: variance.sqrt(),
            share: variance / total,
            learned: prior_variance(curvature, derivatives, &shape).map(|prior| 1.0 - variance / prior),
            shape,
        })
        .collect()
}

/// Largest eigenvalues of `X X^T` with their eigenvectors, for `X` row-major of `count x len`, from the smaller of
/// `X X^T` and `X^T X`.
fn leading(x: &[f64], count: usize, len: usize, most: usize) -> Vec<(f64, Vec<f64>)> {
    let view = dense::row_major(x, count, len);
    let small = count.min(len);
    let mut gram = vec![0.0; small * small];
    dense::gram(if count <= len { view } else { view.transpose() }, &mut gram);
    let Some((values, vectors)) = dense::eigen(&gram, small) else {
        return Vec::new();
    };
    let positive = values.into_iter().zip(vectors.chunks_exact(small.max(1))).filter(|(value, _)| *value > 0.0);
    positive
        .take(most)
        .map(|(value, vector)| {
            let mut shape = vec![0.0; count];
            if count <= len {
                shape.copy_from_slice(vector);
            } else {
                dense::times(x, vector, &mut shape);
            }
            let peak = shape.iter().copied().fold(0.0, |peak: f64, x| if x.abs() > peak.abs() { x } else { peak });
            let scale = peak.signum() / vector::norm(&shape);
            shape.iter_mut().for_each(|x| *x *= scale);
            (value, shape)
        })
        .collect()
}

/// Variance of the amplitude of `shape` before any row was seen.
fn prior_variance(curvature: &Curvature, derivatives: &[f64], shape: &[f64]) -> Option<f64> {
    let mut pulled = vec![0.0; curvature.parameters()];
    dense::transpose_times(derivatives, shape, &mut pulled);
    let precision = &curvature.precision;
    let proper = precision.iter().all(|a| *a > 0.0);
    proper.then(|| pulled.iter().zip(precision).map(|(x, a)| x * x / a).sum())
}
