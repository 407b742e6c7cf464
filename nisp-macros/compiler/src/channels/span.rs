//! The span of a set of polynomials, as a reduced row echelon form in exact arithmetic.

use std::collections::BTreeMap;

use num_traits::Zero;

use crate::symbolic::exact::{self, Exact};
use crate::symbolic::polynomial::{MultiIndex, Polynomial};

/// Rows in reduced echelon form: each has coefficient one at its pivot, and no other row contains that monomial.
#[derive(Clone, Debug, Default)]
pub(super) struct Span {
    rows: BTreeMap<MultiIndex, Polynomial>,
}

impl Span {
    /// What remains of a polynomial modulo the span: zero exactly if it lies inside.
    pub(super) fn reduce(&self, polynomial: &Polynomial) -> Exact<Polynomial> {
        let mut rest = polynomial.clone();
        // Rows are fully reduced, so each pivot's coefficient can be read off before any of them is cleared.
        for (index, &coefficient) in polynomial.terms() {
            if let Some(row) = self.rows.get(index) {
                rest.add_scaled(-coefficient, row)?;
            }
        }
        Ok(rest)
    }

    /// Adds a polynomial; false if it lay inside already.
    pub(super) fn insert(&mut self, polynomial: &Polynomial) -> Exact<bool> {
        let rest = self.reduce(polynomial)?;
        let Some((pivot, &leading)) = rest.terms().next_back() else { return Ok(false) };
        let pivot = pivot.clone();
        let row = rest.scaled(exact::invert(leading)?)?;
        for other in self.rows.values_mut() {
            let coefficient = other.coefficient(&pivot);
            if !coefficient.is_zero() {
                other.add_scaled(-coefficient, &row)?;
            }
        }
        self.rows.insert(pivot, row);
        Ok(true)
    }

    /// Adds a polynomial and all its derivatives.
    pub(super) fn close(&mut self, polynomial: &Polynomial, variables: usize) -> Exact<()> {
        let mut open = vec![polynomial.clone()];
        while let Some(next) = open.pop() {
            // A polynomial inside a closed span has all its derivatives inside.
            if self.insert(&next)? {
                for variable in 0..variables {
                    open.push(next.derivative(variable)?);
                }
            }
        }
        Ok(())
    }

    /// Dimension of the span.
    pub(super) fn rank(&self) -> usize {
        self.rows.len()
    }

    /// The monomials that lie in the span: a monomial does exactly if it is a row.
    pub(super) fn monomials(&self) -> impl Iterator<Item = &MultiIndex> {
        self.rows.iter().filter(|(_, row)| row.len() == 1).map(|(pivot, _)| pivot)
    }
}
