//! The factorised normal matrix: steps, and how far unknowns may be off.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::super::cholesky::Cholesky;
use super::super::draws::{Deviations, Draws};
use super::super::pattern::Part;
use crate::solve::vector;

/// The factorised normal matrix.
pub(in super::super) struct Factor {
    pub(super) factor: Cholesky,
    pub(super) part: Option<Arc<Part>>,
    /// `H^-1` times the border.
    pub(super) solved: Vec<Vec<f64>>,
    pub(super) border: Vec<Vec<f64>>,
    pub(super) schur: DMatrix<f64>,
    pub(super) learned: usize,
}

impl Factor {
    /// Solves the bordered system: the coefficients, then the learned scalars and the multipliers of integrals.
    pub(in super::super) fn solve(&self, right: &[f64], below: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        self.solve_all(&[right], &[below])?.pop()
    }

    /// The same for several right-hand sides.
    pub(in super::super) fn solve_all(
        &self,
        right: &[impl AsRef<[f64]>],
        below: &[impl AsRef<[f64]>],
    ) -> Option<Vec<(Vec<f64>, Vec<f64>)>> {
        let with_border = |(mut step, below): (Vec<f64>, &[f64])| {
            let shared = self.share(&mut step, below)?;
            Some((step, shared))
        };
        self.solve_free(right)?.into_iter().zip(below.iter().map(AsRef::as_ref)).map(with_border).collect()
    }

    /// From a solution without the border to one with it; returns the unknowns of the border. On the right of the last ones is zero, where
    /// `below` says nothing of them.
    pub(super) fn share(&self, step: &mut [f64], below: &[f64]) -> Option<Vec<f64>> {
        let zeros = std::iter::repeat(&0.0);
        let rest = DVector::from_iterator(
            self.border.len(),
            self.border.iter().zip(below.iter().chain(zeros)).map(|(column, b)| b - vector::dot(column, step)),
        );
        let shared = if rest.is_empty() { rest } else { self.schur.clone().lu().solve(&rest)? };
        for (solved, shared) in self.solved.iter().zip(shared.iter()) {
            step.iter_mut().zip(solved).for_each(|(step, solved)| *step -= solved * shared);
        }
        Some(shared.iter().copied().collect())
    }

    /// Solutions for all right-hand sides, drawn from the posterior.
    pub(in super::super) fn deviations(&self, draws: &Draws) -> Option<Deviations> {
        let mut deviations = Deviations::default();
        for (draw, mut coefficients) in self.solve_free(&draws.sides())?.into_iter().enumerate() {
            let mut shared = self.share(&mut coefficients, &draws.below(draw))?;
            shared.truncate(self.learned);
            deviations.learned.push(shared);
            deviations.coefficients.push(coefficients);
        }
        Some(deviations)
    }

    /// The products of right-hand sides with their solutions: of the coefficients, and what is on the right of the border.
    pub(in super::super) fn products(&self, right: &[impl AsRef<[f64]>], below: &[Vec<f64>]) -> Option<Vec<f64>> {
        let solutions = self.solve_all(right, below)?;
        let product = |at: usize| {
            let ((own, shared), below) = (&solutions[at], &below[at]);
            vector::dot(own, right[at].as_ref()) + vector::dot(&shared[..below.len()], below)
        };
        Some((0..solutions.len()).map(product).collect())
    }

    /// Logarithm of the determinant of the matrix with its border; nothing where rounding spoils it.
    pub(in super::super) fn log_determinant(&self) -> Option<f64> {
        let border = if self.border.is_empty() { 0.0 } else { self.schur.determinant().abs().ln() };
        Some(self.factor.log_determinant()? + border)
    }

    /// Variance of a sum of coefficients, each times its weight.
    pub(in super::super) fn variance_of_sum(&self, weights: &[f64]) -> Option<f64> {
        let (solution, _) = self.solve(weights, &[])?;
        Some(vector::dot(&solution, weights))
    }

    /// Variance of a learned scalar's parameter.
    pub(in super::super) fn learned_variance(&self, at: usize) -> Option<f64> {
        let unit = DVector::from_fn(self.schur.nrows(), |row, _| f64::from(u8::from(row == at)));
        self.schur.clone().lu().solve(&unit).map(|column| column[at])
    }

    /// Covariance of some learned scalars' parameters, row by row.
    pub(in super::super) fn covariance_of(&self, learned: &[usize]) -> Option<Vec<f64>> {
        let all = self.schur.clone().try_inverse()?;
        let places = learned.iter().flat_map(|&row| learned.iter().map(move |&column| (row, column)));
        Some(places.map(|at| all[at]).collect())
    }

    /// Solutions without the border, for several right-hand sides: the factors are read once for some of them.
    pub(super) fn solve_free(&self, right: &[impl AsRef<[f64]>]) -> Option<Vec<Vec<f64>>> {
        match &self.part {
            Some(part) => part.solve(&self.factor, right),
            None => self.factor.solve(right),
        }
    }
}
