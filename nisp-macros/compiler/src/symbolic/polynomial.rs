//! Polynomials with exact coefficients: operator symbols, and the rules that come out of them.

use std::collections::BTreeMap;

use num_traits::{One, Zero};

use super::exact::{self, Exact};
use crate::rational::Rational;

/// Exponents of a monomial, one per variable.
pub type MultiIndex = Vec<u32>;

/// A polynomial with exact rational coefficients, none of them zero.
///
/// As the symbol of a differential operator its variables are `d/dx_i`: `x^2 + y^2` is the Laplacian.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Polynomial {
    terms: BTreeMap<MultiIndex, Rational>,
}

impl Polynomial {
    /// The zero polynomial.
    pub fn zero() -> Self {
        Self::default()
    }

    /// A single monomial with coefficient one.
    pub fn monomial(index: MultiIndex) -> Self {
        Self { terms: BTreeMap::from([(index, Rational::one())]) }
    }

    /// The constant one in `variables` variables: the operator that reads the value.
    pub fn one(variables: usize) -> Self {
        Self::monomial(vec![0; variables])
    }

    /// The variable number `variable` of `variables`.
    pub fn variable(variable: usize, variables: usize) -> Self {
        let mut index = vec![0; variables];
        index[variable] = 1;
        Self::monomial(index)
    }

    /// From monomials with coefficients; equal monomials are added.
    pub fn from_terms(terms: impl IntoIterator<Item = (MultiIndex, Rational)>) -> Exact<Self> {
        let mut result = Self::zero();
        for (index, coefficient) in terms {
            result.accumulate(index, coefficient)?;
        }
        Ok(result)
    }

    /// Monomials with their coefficients, in the order of their exponents.
    pub fn terms(&self) -> impl DoubleEndedIterator<Item = (&MultiIndex, &Rational)> + Clone {
        self.terms.iter()
    }

    /// Number of monomials.
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// True for the zero polynomial.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// The coefficient of a monomial.
    pub fn coefficient(&self, index: &[u32]) -> Rational {
        self.terms.get(index).copied().unwrap_or_else(Rational::zero)
    }

    /// Largest total degree of its monomials.
    pub fn degree(&self) -> u32 {
        self.terms.keys().map(|index| index.iter().sum()).max().unwrap_or(0)
    }

    /// True if it is one monomial with coefficient one.
    pub fn is_monomial(&self) -> bool {
        self.terms.len() == 1 && self.terms.values().all(One::is_one)
    }

    /// The part of total degree `degree`.
    pub fn homogeneous_part(&self, degree: u32) -> Self {
        let keep = |index: &MultiIndex| index.iter().sum::<u32>() == degree;
        Self { terms: self.terms.iter().filter(|(index, _)| keep(index)).map(|(i, c)| (i.clone(), *c)).collect() }
    }

    /// Adds `coefficient` times a monomial.
    pub fn accumulate(&mut self, index: MultiIndex, coefficient: Rational) -> Exact<()> {
        let total = exact::add(self.coefficient(&index), coefficient)?;
        if total.is_zero() {
            self.terms.remove(&index);
        } else {
            self.terms.insert(index, total);
        }
        Ok(())
    }

    /// Adds `factor` times another polynomial.
    pub fn add_scaled(&mut self, factor: Rational, other: &Self) -> Exact<()> {
        for (index, &coefficient) in &other.terms {
            self.accumulate(index.clone(), exact::mul(factor, coefficient)?)?;
        }
        Ok(())
    }

    /// This polynomial times a number.
    pub fn scaled(&self, factor: Rational) -> Exact<Self> {
        let mut result = Self::zero();
        result.add_scaled(factor, self)?;
        Ok(result)
    }

    /// The product of two polynomials.
    pub fn times(&self, other: &Self) -> Exact<Self> {
        let mut result = Self::zero();
        for (left, &a) in &self.terms {
            for (right, &b) in &other.terms {
                let index = left.iter().zip(right).map(|(l, r)| l + r).collect();
                result.accumulate(index, exact::mul(a, b)?)?;
            }
        }
        Ok(result)
    }

    /// The derivative by one of its variables.
    pub fn derivative(&self, variable: usize) -> Exact<Self> {
        let mut result = Self::zero();
        for (index, &coefficient) in &self.terms {
            if index[variable] > 0 {
                let mut lower = index.clone();
                lower[variable] -= 1;
                let exponent = Rational::from_integer(i128::from(index[variable]));
                result.accumulate(lower, exact::mul(coefficient, exponent)?)?;
            }
        }
        Ok(result)
    }

    /// The same polynomial with coprime integer coefficients, the leading one positive.
    pub fn primitive(&self) -> Exact<Self> {
        let content = exact::content(self.terms.values().rev().copied())?;
        self.scaled(exact::invert(content)?)
    }
}
