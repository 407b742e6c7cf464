//! From one answer to the next, where only clouds and given parameters have changed.

use super::draws::Deviations;
use super::kept::KeptLattices;
use super::phase::CONVEX_STEPS;
use super::place::{Place, State};
use super::solver::Solver;
use super::together::{together, uncertain};
use super::{LocalError, LocalSolution};
use crate::facts::{Known, Score};
use crate::problem::Bound;
use crate::solve::driver::Status;

/// Steps after a leap, under each prior, at most.
const STEPS: u64 = 8;

/// A solver with its answer: its lattice, the places of its points and the pattern of its equations stay.
pub(crate) struct Live {
    solver: Solver,
    state: State,
    /// What the problem takes for known, and the last score of each; no scores before all were asked for.
    known: Vec<Known>,
    scores: Vec<Option<Score>>,
    /// Whose turn it is to be asked about.
    turn: usize,
}

impl Live {
    /// From an answer, with the scores of all that is known if it was asked for them.
    pub(super) fn new(solver: Solver, state: State, scores: Vec<Option<Score>>) -> Self {
        let known = solver.known();
        Self { solver, state, known, scores, turn: 0 }
    }

    /// Where the answer is, to go back to.
    pub(crate) fn place(&self) -> Place {
        self.solver.place(&self.state, 1)
    }

    /// Goes back to where an answer was.
    pub(crate) fn go_back(&mut self, place: Place) {
        self.solver.set_feet(place.feet);
        self.state = place.state;
    }

    /// The answer to a problem of the same points, from the last one. Edges of patches that have moved are let go of under the
    /// convex prior, and found again under the other.
    pub(crate) fn update(&mut self, bound: Bound) -> Result<LocalSolution, LocalError> {
        if self.solver.bound.scalars != bound.scalars {
            self.scores.clear();
        }
        self.solver.renew(bound);
        // What nothing is known of is asked about; then one after the other, since that takes as long as a step for all.
        let turns = match self.scores.len() {
            len if len == self.known.len() => self.turn..(self.turn + 1).min(len),
            _ => 0..self.known.len(),
        };
        let mut steps = 1;
        let (mut convex, mut found) = self.solver.step(&self.state, CONVEX_STEPS, false, &[])?;
        while !found.has_followed() && steps < STEPS {
            (convex, found) = self.solver.step(&convex, CONVEX_STEPS, false, &[])?;
            steps += 1;
        }
        let place = self.solver.place(&convex, 1);
        // The matrix holds sources at zero where no cloud saw the surface, so that its deviations say too little.
        let on_prior = self.solver.rests_on_the_prior();
        let mut asked = self.known[turns.clone()].to_vec();
        if on_prior.is_empty() {
            asked.extend(uncertain(&self.solver.bound.problem, &asked));
        }
        let (mut state, mut found) = self.solver.step(&convex, CONVEX_STEPS + 1, false, &asked)?;
        steps += 1;
        while !found.has_followed() && steps < 2 * STEPS {
            (state, found) = self.solver.step(&state, CONVEX_STEPS + 1, false, &asked)?;
            steps += 1;
        }
        self.state = state;
        self.scores.resize(self.known.len(), None);
        let told = self.scores[turns.clone()].iter_mut().zip(&found.told);
        told.for_each(|(score, told)| *score = told.score);
        let together = together(&self.solver.bound, &asked, &found.told, self.state.learned.len());
        self.turn = turns.end % self.known.len().max(1);
        let mut warnings = self.solver.doubts(found.loss, found.rows, CONVEX_STEPS);
        let status = if warnings.is_empty() { Status::Converged } else { Status::NotConverged };
        let mut answer = self.solver.answer(&self.state);
        let factor = Some(found.factor).filter(|_| on_prior.is_empty());
        warnings.extend(on_prior);
        answer.scores = self.scores.iter().copied().flatten().collect();
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
            factor,
            together,
            off: Vec::new(),
            checkpoint: place.save(0, 1),
            answer,
            misfits: self.solver.misfits(&self.state),
        })
    }
}
