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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unknowns at every node of a lattice, that meet those of the nodes around it; diagonals outweigh the rest of their rows.
    fn lattice([across, up]: [usize; 2]) -> (Vec<Vec<usize>>, DMatrix<f64>) {
        let n = 2 * across * up;
        let node = |unknown: usize| (unknown / 2 % across, unknown / 2 / across);
        let meet = |a: usize, b: usize| {
            let ((i, j), (k, l)) = (node(a), node(b));
            i.abs_diff(k) < 2 && j.abs_diff(l) < 2
        };
        let entry = |a: usize, b: usize| if a == b { 20.0 } else { ((a + b) as f64 * 0.7).sin() };
        let matrix = DMatrix::from_fn(n, n, |a, b| if meet(a, b) { entry(a, b) } else { 0.0 });
        let columns = (0..n).map(|column| (column..n).filter(|&row| meet(row, column)).collect()).collect();
        (columns, matrix)
    }

    /// Solutions and determinants are those of dense factors, on one front and on many.
    #[test]
    fn solutions_are_those_of_dense_factors() {
        for sides in [[1, 1], [3, 2], [40, 1], [17, 15]] {
            let (columns, matrix) = lattice(sides);
            let n = columns.len();
            let fill = Fill::of(&Entries::new(&columns)).unwrap();
            let mut values: Vec<f64> = columns
                .iter()
                .enumerate()
                .flat_map(|(at, rows)| rows.iter().map(move |&row| (row, at)))
                .map(|at| matrix[at])
                .collect();
            let factor = fill.factor(&values).unwrap();
            let dense = matrix.clone().cholesky().unwrap();
            for count in [1, 5, 33, 64] {
                let right = DMatrix::from_fn(n, count, |row, column| ((3 * row + 7 * column) as f64).cos());
                let off = (factor.solve(&right) - dense.solve(&right)).amax();
                assert!(off < 1e-13, "{sides:?} {count}: {off}");
            }
            let expected = 2.0 * dense.l().diagonal().map(f64::ln).sum();
            let found = factor.log_determinant().unwrap();
            assert!((found - expected).abs() < 1e-12 * expected, "{sides:?}: {found} {expected}");
            // The last diagonal.
            *values.last_mut().unwrap() = -1.0;
            assert!(fill.factor(&values).is_none());
        }
    }
}
