//! The curvature of the loss at a minimum, factorised once for everything that is read from it.

use super::dense::{self, Cholesky};
use super::fault::{Fault, Kind};
use super::objective::{BlockKind, LeastSquares};
use super::prior::WeightPrior;
use std::ops::Range;

/// `H = J^T J + A = L L^T` at some theta, with the rows and derivatives that it was made from.
pub struct Curvature {
    len: usize,
    /// Residuals, divided by their sigma.
    pub(crate) rows: Vec<f64>,
    pub(crate) jacobian: Vec<f64>,
    /// Rows that are random: all but equations, which the truth meets exactly.
    pub(crate) random: Vec<Range<usize>>,
    pub(crate) cholesky: Cholesky,
    /// Precision of the prior, by parameter.
    pub(crate) precision: Vec<f64>,
    /// Share of its diagonal that had to be added to `H` before it could be factorised; 0 where rounding is harmless.
    pub jitter: f64,
}

impl Curvature {
    /// Evaluates rows and derivatives at `theta` and factorises.
    ///
    /// # Errors
    /// A fault of the objective; or `H` is singular: some parameter has neither a prior nor rows that depend on it.
    pub fn at<O: LeastSquares + ?Sized>(objective: &mut O, theta: &[f64], prior: &WeightPrior) -> Result<Self, Fault> {
        let (len, count) = (theta.len(), objective.rows());
        let mut rows = vec![0.0; count];
        let mut jacobian = vec![0.0; count * len];
        objective.jacobian(theta, &mut rows, &mut jacobian)?;
        let mut precision = vec![0.0; len];
        prior.write_diagonal(&mut precision);
        let mut normal = vec![0.0; len * len];
        dense::gram_of_columns(&jacobian, count, len, &mut normal);
        for (i, a) in precision.iter().enumerate() {
            normal[i * (len + 1)] += a;
        }
        let mut cholesky = Cholesky::new(len);
        let mut jitter = 0.0;
        let mut factorise = |jitter: f64| {
            cholesky.factorise(|factor| {
                factor.copy_from_slice(&normal);
                factor.iter_mut().step_by(len + 1).for_each(|d| *d *= 1.0 + jitter);
            })
        };
        while !factorise(jitter) {
            jitter = if jitter == 0.0 { 1e-14 } else { 10.0 * jitter };
            if jitter > 1e-8 {
                return Err(Fault { term: "curvature".into(), point: None, what: Kind::Factorisation });
            }
        }
        let blocks = objective.blocks().iter();
        let random = blocks.filter(|block| block.kind != BlockKind::Equation).map(|block| block.rows.clone()).collect();
        Ok(Self { len, rows, jacobian, random, cholesky, precision, jitter })
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.len
    }

    /// Squared norms of `L^-1 v` for vectors `v` one after the other in memory, which they are overwritten with:
    /// variances of `v . theta`.
    pub(crate) fn variances(&self, vectors: &mut [f64]) -> Vec<f64> {
        let count = vectors.len() / self.len.max(1);
        self.cholesky.solve_lower(vectors, count);
        vectors.chunks_exact(self.len).map(|x| super::vector::dot(x, x)).collect()
    }
}
