//! From one answer to the next, where only clouds and given parameters have changed.

use super::draws::Deviations;
use super::kept::KeptLattices;
use super::phase::CONVEX_STEPS;
use super::place::State;
use super::solver::Solver;
use super::{LocalError, LocalSolution};
use crate::problem::Bound;
use crate::solve::driver::Status;

/// Steps at most, and the change of a field in natural sizes after which no more are taken.
const STEPS: u64 = 2;
const STILL: f64 = 5e-3;

/// A solver with its answer: its lattice, the places of its points and the pattern of its equations stay.
pub(crate) struct Live {
    pub(super) solver: Solver,
    pub(super) state: State,
}

impl Live {
    /// The answer to a problem of the same points, from the last one.
    pub(crate) fn update(&mut self, bound: Bound) -> Result<LocalSolution, LocalError> {
        self.solver.renew(bound);
        let mut steps = 0;
        let (found, place) = loop {
            let place = self.solver.place(&self.state, steps);
            let (next, found) = self.solver.step(&self.state, CONVEX_STEPS + 1 + steps, false)?;
            let change = self.solver.change(&self.state, &next);
            self.state = next;
            steps += 1;
            if steps == STEPS || change < STILL {
                break (found, place);
            }
        };
        let warnings = self.solver.doubts(found.loss, found.rows, CONVEX_STEPS);
        let status = if warnings.is_empty() { Status::Converged } else { Status::NotConverged };
        let mut answer = self.solver.answer(&self.state);
        // An answer that nothing says against is asked what it rests on.
        if status == Status::Converged {
            answer.scores = self.solver.scores(&self.state).unwrap_or_default();
        }
        Ok(LocalSolution {
            kept: KeptLattices {
                heads: self.solver.heads.clone(),
                theta: self.state.theta.clone(),
                learned: self.state.learned.clone(),
                draws: Deviations::default(),
            },
            status,
            iterations: steps,
            loss: found.loss,
            warnings,
            factor: Some(found.factor),
            checkpoint: place.save(0, 1),
            answer,
            misfits: self.solver.misfits(&self.state),
        })
    }
}
