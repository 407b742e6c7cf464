//! States and sources carried by local functions instead of one global network.
//!
//! A network is one smooth function of all its parameters: at its best for a state that is smooth, and slow to learn an
//! edge. A contact patch is nothing but edges. Here every head is a sum of B-splines on a lattice, so that a row depends on
//! a few coefficients, the normal equations are sparse and a Gauss-Newton step costs a sparse factorisation. Equations,
//! units and derivatives are those of the same compiled programs; they are tested with the lattice's hat functions (see
//! `group`). Sources may have a prior that knows patches (see [`Patches`]).
//!
//! Meant for two or three coordinates and a few fields; scenes over time are in better hands with a network.

mod block;
mod bspline;
mod group;
mod heads;
mod lattice;
mod normal;
mod prior;
mod solver;
mod surface;

use std::time::{Duration, Instant};

use thiserror::Error;

use crate::problem::Bound;
use crate::solve::driver::{Flow, Status, Warning};
use crate::solve::fault::Fault;

pub use prior::Patches;

use heads::Heads;
use normal::Factor;
use solver::{End, Solver};

/// How fine the local functions are, and what is known of the sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Cells along the longest coordinate.
    pub cells: usize,
    /// Degree of the state's splines; at least the order of its highest derivative.
    pub degree: usize,
    /// Cells of a source along one of the state's.
    pub finer: usize,
    /// Coordinates along which sources are spread: fewer than there are, if they live on a face.
    pub source_dimensions: usize,
    /// Prior of the sources.
    pub patches: Option<Patches>,
}

/// Why local functions cannot solve a problem.
#[derive(Debug, Error)]
pub enum LocalError {
    /// Something that only networks do.
    #[error("local functions do not do {0}; choose a network")]
    Unsupported(&'static str),
    /// A lattice too fine.
    #[error("the lattice is too fine for the memory; choose fewer cells")]
    Memory,
    /// A normal matrix that is not positive definite.
    #[error("the normal matrix cannot be factorised; the data may not determine the answer")]
    Factorisation,
    /// A residual that is not finite.
    #[error("{0}")]
    Fault(Fault),
}

/// How much coarser the lattice is on which a solution is sought first: coarse splines find the way to it in fewer and
/// cheaper steps, and noise creases them less.
const COARSER: usize = 3;
/// Cells that it has at least.
const FEWEST: usize = 16;

/// A solved problem on its lattices.
pub(crate) struct LocalSolution {
    heads: Heads,
    theta: Vec<f64>,
    pub(crate) learned: Vec<f64>,
    pub(crate) status: Status,
    pub(crate) iterations: u64,
    pub(crate) loss: f64,
    pub(crate) warnings: Vec<Warning>,
    factor: Option<Factor>,
}

/// Solves a bound problem within a budget.
pub(crate) fn solve(
    bound: &Bound,
    settings: &Local,
    budget: Duration,
    iterations: u64,
    monitor: &mut dyn FnMut(u64, f64, f64) -> Flow,
) -> Result<LocalSolution, LocalError> {
    let start = Instant::now();
    let coarse = settings.cells.div_ceil(COARSER).max(FEWEST).min(settings.cells);
    let mut solver = Solver::new(bound, settings, coarse)?;
    let mut end = solver.run(None, start, budget, iterations, coarse < settings.cells, monitor)?;
    let left = iterations - end.iterations;
    if coarse < settings.cells && end.status != Status::Interrupted && left > 0 && start.elapsed() < budget {
        let mut fine = Solver::new(bound, settings, settings.cells)?;
        let before = end.iterations;
        let from = fine.taken_over(&solver.heads, &end.state)?;
        end =
            fine.run(Some(from), start, budget, left, false, &mut |step, at, loss| monitor(before + step, at, loss))?;
        end.iterations += before;
        solver = fine;
    }
    let End { state, status, iterations, loss, warnings, factor } = end;
    Ok(LocalSolution {
        heads: solver.heads,
        theta: state.theta,
        learned: state.learned,
        status,
        iterations,
        loss,
        warnings,
        factor,
    })
}

impl LocalSolution {
    /// Values of a head at points in the engine's units, flat.
    pub(crate) fn evaluate(&self, head: usize, points: &[f64]) -> Vec<f64> {
        let mut scratch = Vec::new();
        let inputs = self.heads.lattices[head].dimensions();
        points.chunks_exact(inputs).map(|point| self.heads.value(head, point, &self.theta, &mut scratch)).collect()
    }

    /// Standard deviation of a learned scalar's parameter.
    pub(crate) fn learned_deviation(&self, at: usize) -> Option<f64> {
        self.factor.as_ref()?.learned_variance(at).map(|variance| variance.max(0.0).sqrt())
    }
}
