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
    /// The pattern by columns of the spread, of unit length: another quantity moves by its row times this while the
    /// amplitude moves by one standard deviation.
    pub columns: Vec<f64>,
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

/// A square root `X` of the covariance `X X^T` of quantities given as for [`posterior`]: row-major, quantities x parameters.
pub fn spread(curvature: &Curvature, derivatives: &[f64]) -> Vec<f64> {
    let mut spread = derivatives.to_vec();
    curvature.variances(&mut spread);
    spread
}

/// The leading direction of the covariance `X X^T` of `count` quantities, from its square root `X`, row-major; none where
/// nothing moves.
pub fn leading(spread: &[f64], count: usize) -> Option<Direction> {
    let len = spread.len().checked_div(count).filter(|len| *len > 0)?;
    let small = count.min(len);
    let mut gram = vec![0.0; small * small];
    if count <= len {
        dense::gram(spread, count, len, &mut gram);
    } else {
        dense::gram_of_columns(spread, count, len, &mut gram);
    }
    let (values, vectors) = dense::eigen(&gram, small)?;
    let variance = values.first().copied().filter(|value| *value > 0.0)?;
    let deviation = variance.sqrt();
    let (mut shape, mut columns) = (vec![0.0; count], vec![0.0; len]);
    if count <= len {
        shape.copy_from_slice(&vectors[..small]);
        dense::transpose_times(spread, &shape, &mut columns);
        columns.iter_mut().for_each(|x| *x /= deviation);
    } else {
        columns.copy_from_slice(&vectors[..small]);
        dense::times(spread, &columns, &mut shape);
        shape.iter_mut().for_each(|x| *x /= deviation);
    }
    let sign = shape[vector::largest(&shape)].signum();
    shape.iter_mut().chain(&mut columns).for_each(|x| *x *= sign);
    Some(Direction { shape, deviation, share: variance / vector::dot(spread, spread), columns })
}
