//! What splines found of a problem, or why they cannot solve it.

use thiserror::Error;

use super::kept::KeptSplines;
use super::triangle::Triangle;
use crate::facts::Answer;
use crate::memory::Exceeded;
use crate::solve::driver::{Status, Warning};
use crate::solve::fault::Fault;
use crate::solve::state;

/// Why splines cannot solve a problem.
#[derive(Debug, Error)]
pub(crate) enum SplineError {
    /// Something that cannot be evaluated, or a state that does not fit.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// Too many rows for the memory.
    #[error(transparent)]
    Memory(#[from] Exceeded),
}

/// A problem solved by splines.
pub(crate) struct SplineSolution {
    pub(crate) kept: KeptSplines,
    /// What is open is read from here.
    pub(crate) roots: Vec<Root>,
    pub(crate) status: Status,
    pub(crate) iterations: u64,
    pub(crate) loss: f64,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) checkpoint: state::State,
    /// What the verdict is made from.
    pub(crate) answer: Answer,
    /// By group and term: how far rows are off, and the noise that the evidence found.
    pub(crate) misfits: Vec<Vec<(Vec<f64>, Option<f64>)>>,
}

/// A square root of the inverse of the coefficients' covariance: of the whole problem, or without a condition.
pub(crate) struct Root {
    /// Group and term of the condition.
    pub(crate) without: Option<(usize, usize)>,
    pub(crate) triangle: Triangle,
}
