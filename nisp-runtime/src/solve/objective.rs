//! What a solver asks of a problem.

use super::fault::Fault;
use crate::real::Real;
use std::ops::Range;

/// A function to minimise, over flat parameters `theta`.
///
/// Implementations check their own results: every value that is returned as `Ok` is finite, and the fault names the
/// term and point otherwise. Calls with the same `theta` give the same bits, whatever was called before, until
/// [`Objective::accepted`] or [`Objective::refresh`] is called.
#[expect(clippy::len_without_is_empty, reason = "a problem without parameters is no problem")]
pub trait Objective<E: Real> {
    /// Number of parameters.
    fn len(&self) -> usize;

    /// The value at `theta`, in double precision whatever `E` is.
    ///
    /// # Errors
    /// A term that is not finite.
    fn value(&mut self, theta: &[E]) -> Result<f64, Fault>;

    /// The value at `theta`; `gradient` (as long as `theta`) is overwritten with the derivative.
    ///
    /// # Errors
    /// A term or a derivative that is not finite; `gradient` is then of no use.
    fn gradient(&mut self, theta: &[E], gradient: &mut [E]) -> Result<f64, Fault>;

    /// `theta` is the new iterate. What is frozen during a step (assignments of a cloud, active sets) may be
    /// refreshed here. Returns true if the function has changed by it, so that the solver evaluates afresh.
    fn accepted(&mut self, theta: &[E]) -> bool {
        let _ = theta;
        false
    }

    /// Refreshes what is frozen during a step and follows from `theta` alone (assignments of a cloud), as if `theta` were
    /// the new iterate. A method that takes every step evaluates once at a trial point that way, and calls it again at the
    /// former iterate, which restores the function to the bit, should the trial be refused. Returns true if the function
    /// has changed by it.
    fn refresh(&mut self, theta: &[E]) -> bool {
        let _ = theta;
        false
    }
}

/// Half the sum of the squares of rows: `L(theta) = r^T r / 2`, so that the gradient is `J^T r`.
///
/// Rows come already divided by the `sigma` of their block. A prior that is quadratic in `theta` itself (the weight
/// prior of [`super::evidence`]) belongs to the solver and needs no rows.
pub trait LeastSquares: Objective<f64> {
    /// Number of rows; constant until [`Objective::accepted`] returns true.
    fn rows(&self) -> usize;

    /// Overwrites `r` (one per row) with the residuals, and gives `r^T r / 2`.
    ///
    /// # Errors
    /// A residual that is not finite.
    fn residuals(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault>;

    /// Overwrites `r` with the residuals and `j` (row-major, rows x parameters) with their derivatives, and gives
    /// `r^T r / 2`.
    ///
    /// # Errors
    /// A residual or a derivative that is not finite.
    fn jacobian(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault>;

    /// The rows by term: consecutive, without gaps, in row order.
    fn blocks(&self) -> &[Block];

    /// Sets the scale that the rows of a block are divided by (see [`Block::sigma`]).
    fn set_sigma(&mut self, block: usize, sigma: f64);

    /// The scale that the rows of a block speak for at `theta` apart from outliers, where `effective` degrees of freedom are
    /// fitted; nothing of a block that is not to be robust against them.
    fn clean_sigma(&mut self, theta: &[f64], block: usize, effective: f64) -> Option<f64> {
        let _ = (theta, block, effective);
        None
    }

    /// `out = J v` at `theta`, with `v` as long as `theta` and `out` one per row, without forming `J`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn jacobian_vector(&mut self, theta: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Fault>;

    /// `out = J^T u` at `theta`, with `u` one per row and `out` as long as `theta`, without forming `J`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn vector_jacobian(&mut self, theta: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault>;

    /// Overwrites `out` (as long as `theta`) with the diagonal of `J^T J`, or an estimate of it, and returns true; or
    /// returns false where that is not to be had cheaply. Matrix-free solvers precondition with it.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn diagonal(&mut self, theta: &[f64], out: &mut [f64]) -> Result<bool, Fault> {
        let _ = (theta, out);
        Ok(false)
    }
}

/// Consecutive rows of one term.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Name of the term, as the user wrote it.
    pub term: String,
    /// What the rows stand for.
    pub kind: BlockKind,
    /// The rows.
    pub rows: Range<usize>,
    /// Scale that the rows are divided by, in the unit of the term: the standard deviation of an observation, the
    /// tolerance of an equation, the spread of a prior.
    pub sigma: f64,
    /// Number of independent data that the rows stand for. It is `rows.len()` unless a weight (of quadrature, of
    /// repeated data) makes rows count for more or less than one datum.
    pub count: f64,
}

/// What the rows of a [`Block`] stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// A governing equation or a condition, to be satisfied within `sigma`.
    Equation,
    /// Measurements with known noise `sigma`.
    Observation,
    /// Measurements whose noise is not known; `sigma` is the present estimate and may be re-estimated.
    ObservationOfUnknownNoise,
    /// A belief about the solution.
    Prior,
}
