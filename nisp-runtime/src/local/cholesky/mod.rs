//! Cholesky factors of a sparse symmetric matrix, and what they say of it.

mod front;
mod solve;
mod tree;

use std::sync::Arc;

use nalgebra::DMatrix;

use super::entries::Entries;
use tree::Tree;

/// Where factors have entries.
#[derive(Clone)]
pub(super) struct Fill(Arc<Tree>);

/// The factor `L` of `H = L L^T`.
pub(super) struct Cholesky {
    fill: Fill,
    lower: Vec<f64>,
    /// What the diagonal of `H` was raised by, as a share of itself.
    pub(super) lift: f64,
}

impl Fill {
    /// Factors of matrices whose lower triangle has these entries; nothing where no order of elimination is found.
    pub(super) fn of(entries: &Entries) -> Option<Self> {
        Some(Self(Arc::new(Tree::of(entries)?)))
    }

    /// Factors of a matrix, of which the lower triangle is given; nothing where it is not positive definite, or memory too small.
    pub(super) fn factor(&self, matrix: &[f64]) -> Option<Cholesky> {
        Some(Cholesky { fill: self.clone(), lower: front::factor(&self.0, matrix)?, lift: 0.0 })
    }
}

impl Cholesky {
    /// `H^-1` times the columns of a matrix.
    pub(super) fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        solve::solve(&self.fill.0, &self.lower, right)
    }

    /// Logarithm of the determinant of `H`; nothing where rounding has made it another one.
    pub(super) fn log_determinant(&self) -> Option<f64> {
        if self.lift > 0.0 {
            return None;
        }
        let diagonal = self
            .fill
            .0
            .fronts
            .iter()
            .flat_map(|front| (0..front.width).map(|at| self.lower[front.at + at * (front.size() + 1)].ln()));
        Some(2.0 * diagonal.sum::<f64>())
    }
}
