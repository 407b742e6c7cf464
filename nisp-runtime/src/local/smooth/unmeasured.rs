//! What equations settle of a source by themselves. Splines of a field cannot follow every pattern of a source, and equations rule
//! out those that they cannot follow: this says nothing of how much the source bends. The evidence is that of the measurements,
//! given the equations (MacKay 1992), so that it counts what is settled beyond that.

use super::freedom::{Before, Unmeasured};
use super::solver::Solver;
use super::state::{Phase, State};
use super::step::Rows;
use crate::local::block::Block;
use crate::schema::{self, TermKind};

/// Change of the logarithm of a roughness after which what is settled is counted anew.
const STALE: f64 = 0.02;

impl Solver<'_> {
    /// Counts what the rows of all groups settle without measurements, where roughness has changed since it was counted. The
    /// normal equations are those without measurements afterwards.
    pub(super) fn count_unmeasured(&mut self, state: &State, rows: &Rows) -> Unmeasured {
        let sizes: Vec<f64> = self.roughness.iter().map(|&class| state.classes[class].size).collect();
        let past = state.unmeasured.sizes();
        let is_near = |(now, past): (&f64, &f64)| (now / past).ln().abs() < STALE;
        if past.len() == sizes.len() && sizes.iter().zip(past).all(is_near) {
            return state.unmeasured.clone();
        }
        let asked = rows.asked.iter().map(|(at, own)| (*at, self.without(*at, own))).collect();
        self.add_all(state, &Rows { asked, clouds: Vec::new() });
        let found = self.settled(state, &sizes);
        Unmeasured::new(found.unwrap_or_default(), sizes)
    }

    /// By head, what the rows in the normal equations settle.
    fn settled(&self, state: &State, sizes: &[f64]) -> Option<Vec<Before>> {
        let factor = self.normal.factor()?;
        let (step, shared) = self.normal.step(&factor)?;
        let mut all = vec![Before::default(); sizes.len()];
        for head in self.judged(Phase::Solve) {
            let rows = self.prior_rows(state, head);
            let squares = rows.iter().map(|row| row.after(0, &step, &shared).powi(2)).sum();
            let settled = self.freedoms[head].as_ref()?.settled(&factor, step.len(), sizes[head])?;
            all[head] = Before { settled, squares };
        }
        Some(all)
    }

    /// Rows of a group with nothing in those that measure something. A condition on a source alone does.
    fn without(&self, group: usize, blocks: &[Block]) -> Vec<Block> {
        let (group, schema) = (&self.groups[group], self.schema());
        let is_of_source = |&jet: &usize| schema.heads[group.schema.jets[jet].head].source;
        let is_asked = |term: &&schema::Term| !matches!(term.kind, TermKind::Chamfer { .. });
        let measures = |term: &&schema::Term| term.kind == TermKind::Observation || term.jets.iter().all(is_of_source);
        let own = |term: &schema::Term| (0..term.rows).map(|row| group.first_own(term) + row).collect::<Vec<_>>();
        let measured: Vec<usize> = group.schema.terms.iter().filter(is_asked).filter(measures).flat_map(own).collect();
        let mut blocks = blocks.to_vec();
        blocks.iter_mut().for_each(|block| measured.iter().for_each(|&row| block.clear(row)));
        blocks
    }
}
