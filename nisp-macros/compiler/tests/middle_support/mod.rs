//! Shared by the tests of the middle stages: operators from text, and an independent dense Taylor jet.
#![allow(dead_code, reason = "each test file uses a part")]

pub(crate) mod check;
pub(crate) mod jet;
pub(crate) mod models;
pub(crate) mod network;
pub(crate) mod oracle;
pub(crate) mod tangent;

use nisp_compiler::channels::{ChannelSet, Operator};
use nisp_compiler::rational::ratio;

/// `[(coefficient, [exponents])]` as an operator.
pub(crate) fn operator(terms: &[(i128, &[u32])]) -> Operator {
    Operator::from_terms(terms.iter().map(|(c, index)| (index.to_vec(), ratio(*c, 1)))).unwrap()
}

/// A plain partial derivative.
pub(crate) fn partial(index: &[u32]) -> Operator {
    operator(&[(1, index)])
}

/// The Laplacian in the first `dimensions` of `coordinates`.
pub(crate) fn laplacian(dimensions: usize, coordinates: usize) -> Operator {
    let term = |i: usize| {
        let mut index = vec![0; coordinates];
        index[i] = 2;
        (index, ratio(1, 1))
    };
    Operator::from_terms((0..dimensions).map(term)).unwrap()
}

/// The operator applied `n` times.
pub(crate) fn iterated(operator: &Operator, n: usize) -> Operator {
    (1..n).fold(operator.clone(), |product, _| product.times(operator).unwrap())
}

/// The minimal set of some operators.
pub(crate) fn minimal(operators: &[Operator]) -> ChannelSet {
    let coordinates = operators[0].terms().next().unwrap().0.len();
    ChannelSet::minimal(operators, coordinates).unwrap()
}

/// All multi-indices of at most this total degree.
pub(crate) fn dense(coordinates: usize, degree: u32) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = vec![Vec::new()];
    for _ in 0..coordinates {
        all = all.iter().flat_map(|p| (0..=degree).map(move |k| p.iter().copied().chain([k]).collect())).collect();
    }
    all.retain(|index| index.iter().sum::<u32>() <= degree);
    all
}

/// Deterministic numbers in -1..1.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    /// The next number.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// The next few.
    pub(crate) fn take(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }
}
