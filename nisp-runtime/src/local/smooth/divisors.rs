//! What rows are divided by at a state, and how their misfits count.

use super::solver::Solver;
use super::state::State;
use crate::local::surface::Surface;
use crate::loss::Loss;
use crate::schema::TermKind;

/// How far such an equation may be off in the middle of cells, over its size: along a coordinate of lower order means are too few.
const SLIGHT: f64 = 0.3;

impl Solver<'_> {
    /// How the misfits of a group's terms count at a state.
    pub(super) fn losses(&self, state: &State, group: usize) -> Vec<Loss> {
        let own = self.bound.losses[group].iter();
        own.map(|loss| if state.convex { loss.convex() } else { *loss }).collect()
    }

    /// The class of a cloud's points.
    pub(super) fn class(&self, surface: &Surface) -> usize {
        let terms = self.schema().groups[surface.group].terms.iter();
        self.classes[surface.group][terms.take_while(|term| term.name != surface.term).count()]
    }

    /// The noise of a cloud's points at a state.
    pub(super) fn sigma(&self, state: &State, surface: &Surface) -> f64 {
        surface.sigma(state.classes[self.class(surface)].size)
    }

    /// Takes over the sizes of equations at a state.
    pub(super) fn size(&mut self, state: &State) {
        for at in 0..self.groups.len() {
            let group = &self.groups[at];
            let facts = group.facts(&self.heads, &state.theta);
            let found = facts.sizes(group.kernel.programs, group.schema, &self.scalars, &self.bound.sizes[at]);
            for term in group.schema.terms {
                let rows = term.first..term.first + term.rows;
                let sizes = self.sizes[at][rows.clone()].iter_mut().zip(&found[rows]);
                // What is declared is of the sum.
                let is_sum = term.kind == TermKind::Integral && term.within.is_none();
                let summed = if is_sum { group.measure() } else { 1.0 };
                sizes.for_each(|(size, found)| *size = summed * found / term.weight.sqrt());
            }
        }
        self.leave_out_levels(state);
    }

    /// Gives all rows what they are divided by at a state.
    pub(super) fn set_sigmas(&mut self, state: &State) {
        for (at, group) in self.groups.iter_mut().enumerate() {
            group.weigh_slight(state.tolerance / SLIGHT);
            for (number, term) in group.schema.terms.iter().enumerate() {
                for row in term.first..term.first + term.rows {
                    group.sigma[row] = match term.kind {
                        TermKind::Observation => state.classes[self.classes[at][number]].size,
                        _ if term.within.is_some() => self.sizes[at][row],
                        _ => state.tolerance * self.sizes[at][row],
                    };
                }
            }
        }
    }
}
