//! The normal equations about a state: of its rows, and of what is believed beforehand.

use super::rows::{Asked, Rows};
use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::LocalError;
use crate::local::block::Block;
use crate::local::unseen::Unseen;
use crate::schema;
use crate::solve::vector::root_mean_square;

/// What coefficients are multiplied by in rows that keep those bounded that nothing else speaks of.
const RIDGE: f64 = 1e-6;
/// How much rougher fields may be than the data alone say, times the tolerance of their equations. Where a source sets in, fields
/// change in a small part of the domain and time: a prior that speaks beside the data flattens the source.
const FREE: f64 = 10.0;
/// Standard deviation of the learned scalars' parameters before any row is seen.
const LEARNED: f64 = 10.0;
/// What a source is of the order of where no cloud saw it, beside its size where one did, or its natural one: patches carry twice as
/// much.
const LIKELY: f64 = 0.5;

impl Solver<'_> {
    /// The heads whose roughness the evidence finds in a phase: sources, or measured fields while only data are regressed.
    pub(super) fn judged(&self, phase: Phase) -> Vec<usize> {
        let observed = self.schema().observed();
        let heads = self.schema().heads.iter().enumerate();
        let is_judged = |&(head, declared): &(usize, &schema::Head)| match phase {
            Phase::Regress => !declared.source && observed.contains(&head),
            Phase::Explain | Phase::Solve => declared.source,
        };
        heads.filter(is_judged).map(|(head, _)| head).collect()
    }

    pub(super) fn prior_rows(&self, state: &State, head: usize) -> Vec<Block> {
        // Equations say of fields what the prior says of sources: it lets fields go as equations tighten, and keeps only those
        // directions bounded of which nothing else speaks.
        let is_free = state.phase.has_equations() && !self.schema().heads[head].source;
        let times = if is_free { FREE / state.tolerance } else { 1.0 };
        let roughness = times * state.classes[self.roughness[head]].size;
        self.priors[head].blocks(&state.theta, roughness, state.learned.len())
    }

    /// The normal equations about a state; returns the rows of all groups that take part, with the group's number.
    pub(super) fn assemble(&mut self, state: &State, slopes: &[f64]) -> Result<Rows, LocalError> {
        self.find_feet(state);
        let all = self.rows(state, slopes)?;
        self.add_all(state, &all);
        Ok(all)
    }

    /// Where no cloud saw the surface that a source acts on.
    pub(super) fn unseen(&self, head: usize) -> Option<Unseen> {
        let lattice = &self.heads.lattices[head];
        let is_of_all = lattice.dimensions() == lattice.inputs();
        (self.schema().heads[head].source && is_of_all).then(|| Unseen::of(&self.surfaces, lattice)).flatten()
    }

    /// The normal equations of rows and of what is believed.
    pub(super) fn add_all(&mut self, state: &State, rows: &Rows) {
        self.normal.clear();
        for Asked { at, counts, evaluated } in &rows.asked {
            let batches = self.groups[*at].batches(&self.heads, evaluated, &rows.learned, counts);
            batches.for_each(|blocks| self.normal.add_all(&blocks));
            let integrals = self.groups[*at].integrals(&self.heads, evaluated, &self.scalars, &rows.learned);
            for (_, integral) in integrals.iter().filter(|(row, _)| counts[*row].contains(&true)) {
                self.normal.add_dense(integral);
            }
        }
        rows.clouds.iter().for_each(|blocks| self.normal.add_all(blocks));
        for head in 0..self.priors.len() {
            let mut believed = self.prior_rows(state, head);
            // The answer is what the prior says where nothing was seen; its deviations are not.
            if let Some(unseen) = self.normal.draws.as_ref().and_then(|_| self.unseen(head)) {
                let first = self.heads.first[head];
                let own = &state.theta[first..self.heads.first[head + 1]];
                believed.retain(|row| !row.dofs.iter().any(|&dof| unseen.functions[dof as usize - first]));
                let seen = own.iter().enumerate().filter(|(at, _)| !unseen.functions[*at]).map(|(_, x)| *x);
                let level = LIKELY * root_mean_square(seen).max(1.0) / self.heads.lattices[head].smoothing();
                unseen.add(&mut self.normal, &self.heads, head, level);
            }
            self.normal.add_all(&believed);
        }
        for (at, theta) in state.theta.iter().enumerate() {
            self.normal.add_stiffness(at, RIDGE.powi(2));
            // What no data speak of stays where equations have a value.
            self.normal.gradient[at] += if state.phase.has_equations() { RIDGE.powi(2) * theta } else { 0.0 };
        }
        let precision = LEARNED.powi(-2);
        for (at, parameter) in state.learned.iter().enumerate() {
            self.normal.add_learned(at, precision, precision * parameter);
        }
    }
}
