//! How far every term is off at an answer.

use super::place::State;
use super::solver::Solver;
use crate::schema::TermKind;

/// Misfits of a term, in the engine's units, and the standard deviation that they count with, where it is that of data.
pub(crate) type Misfits = (Vec<f64>, Option<f64>);

impl Solver {
    /// Misfits of all terms, by group: of a cloud's points from the surface, of an integral from its target, of everything
    /// else at every point, or in the mean over every test.
    pub(super) fn misfits(&mut self, state: &State) -> Vec<Vec<Misfits>> {
        self.find_feet(state);
        (0..self.groups.len()).map(|at| self.misfits_of(at, state)).collect()
    }

    fn misfits_of(&self, at: usize, state: &State) -> Vec<Misfits> {
        let group = &self.groups[at];
        let evaluated = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
        let sums = group.sums(&evaluated, &self.scalars);
        let of = |term: &crate::schema::Term| match term.kind {
            TermKind::Chamfer { .. } => {
                let surface = self.surfaces.iter().find(|surface| surface.group == at && surface.term == term.name);
                let sigma = surface.map(|surface| surface.sigma(state.noise));
                (surface.map_or_else(Vec::new, |surface| surface.misfits().collect()), sigma)
            }
            TermKind::Integral => {
                let rows = term.first..term.first + term.rows;
                (sums.iter().filter(|(row, _)| rows.contains(row)).map(|(_, misfit)| *misfit).collect(), None)
            }
            TermKind::Residual | TermKind::Observation => {
                let rows = term.first..term.first + term.rows;
                (rows.flat_map(|row| group.asked(&evaluated, row)).collect(), Some(group.sigma[term.first]))
            }
        };
        group.schema.terms.iter().map(of).collect()
    }
}
