//! What equations settle of a source by themselves. Splines of a field cannot follow every pattern of a source, and equations rule
//! out those that they cannot follow: this says nothing of how much the source bends. The evidence is that of the measurements,
//! given the equations (MacKay 1992), so that it counts what is settled beyond that.

use super::freedom::{Before, Unmeasured};
use super::rows::{Asked, Rows, is_any};
use super::solver::Solver;
use super::state::{Phase, State};
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
        let asked = rows.asked.iter().map(|asked| self.without(asked)).filter(|asked| is_any(&asked.counts)).collect();
        self.add_all(state, &Rows { asked, clouds: Vec::new(), learned: rows.learned.clone() });
        let heads = self.schema().heads.iter().enumerate();
        heads.filter(|(_, declared)| !declared.source).for_each(|(head, _)| self.hold(state, head));
        let found = self.settled(state, &sizes);
        Unmeasured::new(found.unwrap_or_default(), sizes)
    }

    /// Adds to the normal equations that a head is as large as it was found to be. Equations without measurements may leave a field open,
    /// as where nothing is said of what comes in.
    pub(super) fn hold(&mut self, state: &State, head: usize) {
        let squares = self.squares(state, head);
        if squares > 0.0 {
            for at in self.heads.first[head]..self.heads.first[head + 1] {
                self.normal.add_stiffness(at, 1.0 / squares);
                self.normal.gradient[at] += state.theta[at] / squares;
            }
        }
    }

    /// Sum of squares of a head's coefficients.
    pub(super) fn squares(&self, state: &State, head: usize) -> f64 {
        state.theta[self.heads.first[head]..self.heads.first[head + 1]].iter().map(|x| x * x).sum()
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

    /// Rows of a group of which those do not count that measure something. A condition on a source alone does.
    pub(super) fn without(&self, asked: &Asked) -> Asked {
        let (group, schema) = (&self.groups[asked.at], self.schema());
        let is_of_source = |&jet: &usize| schema.heads[group.schema.jets[jet].head].source;
        let measures = |term: &&schema::Term| term.kind == TermKind::Observation || term.jets.iter().all(is_of_source);
        let mut without = asked.clone();
        for term in group.schema.terms.iter().filter(measures) {
            without.counts[term.first..term.first + term.rows].iter_mut().for_each(|counts| counts.fill(false));
        }
        without
    }
}
