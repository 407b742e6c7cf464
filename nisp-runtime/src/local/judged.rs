//! What local functions say at the points of their groups and of their clouds, for the verdict.

use super::place::State;
use super::solver::Solver;
use crate::facts::{Answer, OTHER_THAN_SPLINES};

/// Distances to a cloud that splines do not follow, as a share of a cell.
const UNRESOLVED: f64 = 0.03;

impl Solver {
    /// What a state says.
    pub(super) fn answer(&mut self, state: &State) -> Answer {
        self.find_feet(state);
        let facts = self.groups.iter().map(|group| group.facts(&self.heads, &state.theta));
        let clouds = self.surfaces.iter().map(|surface| surface.facts(UNRESOLVED * self.cell));
        Answer {
            facts: facts.collect(),
            between: Vec::new(),
            clouds: clouds.collect(),
            scalars: self.scalars.clone(),
            scores: Vec::new(),
            told: Vec::new(),
            leaning: Vec::new(),
            ahead: None,
            moved: None,
            left_to_learned: Vec::new(),
            strain: None,
            loose: None,
            is_coarse: false,
            shared: Vec::new(),
            used: 1.0,
            refined: None,
            finer: OTHER_THAN_SPLINES,
        }
    }
}
