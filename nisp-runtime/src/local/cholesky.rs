//! Cholesky factors of a sparse symmetric matrix, and what they say of it.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Side, get_global_parallelism};

use super::ordering::order;

/// Where factors have entries.
#[derive(Clone)]
pub(super) struct Fill(Arc<SymbolicCholesky<usize>>);

/// The factor `L` of `H = L L^T`.
pub(super) struct Cholesky {
    fill: Fill,
    lower: Vec<f64>,
    /// What the diagonal of `H` was raised by, as a share of itself.
    pub(super) lift: f64,
}

impl Fill {
    /// Factors of matrices whose lower triangle has these entries; nothing where memory is too small.
    pub(super) fn of(entries: SymbolicSparseColMatRef<'_, usize>) -> Option<Self> {
        let order = order(entries)?;
        let order = SymmetricOrdering::Custom(order.as_ref());
        let symbolic = factorize_symbolic_cholesky(entries, Side::Lower, order, Default::default());
        Some(Self(Arc::new(symbolic.ok()?)))
    }

    /// Factors of a matrix, of which the lower triangle is given; nothing where it is not positive definite, or memory too small.
    pub(super) fn factor(&self, matrix: SparseColMatRef<'_, usize, f64>) -> Option<Cholesky> {
        let (symbolic, both) = (&self.0, get_global_parallelism());
        let mut lower = Vec::new();
        lower.try_reserve_exact(symbolic.len_val()).ok()?;
        lower.resize(symbolic.len_val(), 0.0);
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(both, Default::default());
        let mut memory = MemBuffer::try_new(scratch).ok()?;
        let (stack, as_it_is) = (MemStack::new(&mut memory), Default::default());
        symbolic
            .factorize_numeric_llt(&mut lower, matrix, Side::Lower, as_it_is, both, stack, Default::default())
            .ok()?;
        Some(Cholesky { fill: self.clone(), lower, lift: 0.0 })
    }
}

impl Cholesky {
    /// `H^-1` times the columns of a matrix; nothing where memory is too small.
    pub(super) fn solve(&self, right: &Mat<f64>) -> Option<Mat<f64>> {
        let factor = LltRef::new(&self.fill.0, &self.lower);
        let (mut solutions, all) = (right.clone(), get_global_parallelism());
        let scratch = self.fill.0.solve_in_place_scratch::<f64>(right.ncols(), all);
        let mut memory = MemBuffer::try_new(scratch).ok()?;
        factor.solve_in_place_with_conj(Conj::No, solutions.as_mut(), all, MemStack::new(&mut memory));
        Some(solutions)
    }

    /// Logarithm of the determinant of `H`; nothing where rounding has made it another one.
    pub(super) fn log_determinant(&self) -> Option<f64> {
        if self.lift > 0.0 {
            return None;
        }
        let logarithms: f64 = match self.fill.0.raw() {
            SymbolicCholeskyRaw::Simplicial(own) => (0..own.ncols()).map(|at| self.lower[own.col_ptr()[at]].ln()).sum(),
            SymbolicCholeskyRaw::Supernodal(own) => {
                let factor = SupernodalLltRef::new(own, &self.lower);
                let block = |at: usize| {
                    let block = factor.supernode(at).val();
                    (0..block.ncols()).map(|at| block[(at, at)].ln()).sum::<f64>()
                };
                (0..own.n_supernodes()).map(block).sum()
            }
        };
        Some(2.0 * logarithms)
    }
}
