//! The rows that take part in a step.

use std::sync::Arc;

use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::LocalError;
use crate::local::block::Block;
use crate::local::rows::Evaluated;
use crate::local::surface::Surface;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;

/// The rows that take part about a state. Those of groups are linearised whenever they are read: their derivatives would fill the
/// memory.
pub(super) struct Rows {
    pub(super) asked: Vec<Asked>,
    /// By cloud, a block for each point that has a foot.
    pub(super) clouds: Vec<Vec<Block>>,
    /// Derivatives of the learned scalars by their parameters.
    pub(super) learned: Vec<f64>,
}

/// The rows of a group.
#[derive(Clone)]
pub(super) struct Asked {
    /// The group's number.
    pub(super) at: usize,
    /// By row and place, whether it counts.
    pub(super) counts: Vec<Vec<bool>>,
    pub(super) evaluated: Arc<Evaluated>,
}

impl Solver<'_> {
    /// By row of a group and place, whether it counts in a phase: equations wait until data and conditions on values are
    /// regressed, and of what was not measured nothing is known.
    pub(super) fn counts(&self, at: usize, phase: Phase) -> Vec<Vec<bool>> {
        let group = &self.groups[at];
        let mut counts = vec![vec![false; group.places()]; group.schema.rows];
        let is_asked = |term: &&schema::Term| !matches!(term.kind, TermKind::Chamfer { .. });
        let takes_part = |term: &&schema::Term| takes_part(group.schema, term, phase);
        for term in group.schema.terms.iter().filter(is_asked).filter(takes_part) {
            let measured = self.bound.lacking(at, term).unwrap_or_else(|| vec![true; group.places()]);
            counts[term.first..term.first + term.rows].fill(measured);
        }
        counts
    }

    /// The rows of a group, batch by batch.
    pub(super) fn batches<'b>(&'b self, rows: &'b Rows, asked: &'b Asked) -> impl Iterator<Item = Vec<Block>> + 'b {
        self.groups[asked.at].batches(&self.heads, &asked.evaluated, &rows.learned, &asked.counts)
    }

    /// Whether a cloud takes part in a phase.
    pub(super) fn is_seen(&self, surface: &Surface, phase: Phase) -> bool {
        let group = &self.schema().groups[surface.group];
        group.terms.iter().any(|term| term.name == surface.term && takes_part(group, term, phase))
    }

    /// The rows of all groups and clouds that take part about a state, whose feet are found.
    pub(super) fn rows(&self, state: &State, slopes: &[f64]) -> Result<Rows, LocalError> {
        let mut asked = Vec::new();
        for (at, group) in self.groups.iter().enumerate() {
            let counts = self.counts(at, state.phase);
            if !is_any(&counts) {
                continue;
            }
            let evaluated = Arc::new(group.evaluate(&self.heads, &state.theta, &self.scalars, true));
            for (own, row) in group.own_rows().into_iter().enumerate() {
                let counts = |p: usize| !group.tests.is_empty() || counts[row][p];
                let is_lost = |&p: &usize| counts(p) && !evaluated.row(row, p).is_finite();
                if let Some(p) = (0..group.sites.count).find(is_lost) {
                    return Err(LocalError::Fault(Fault::residual(group.name(own), Some(p))));
                }
            }
            asked.push(Asked { at, counts, evaluated });
        }
        let of_cloud = |surface: &Surface| {
            let (group, sigma) = (&self.groups[surface.group], self.sigma(state, surface));
            let rows = || surface.blocks(group, &self.heads, &state.theta, &self.scalars, slopes, sigma);
            if self.is_seen(surface, state.phase) { rows() } else { Vec::new() }
        };
        Ok(Rows { asked, clouds: self.surfaces.iter().map(of_cloud).collect(), learned: slopes.to_vec() })
    }
}

/// Whether a term takes part in a phase: those with derivatives wait until data and conditions on values are regressed.
fn takes_part(group: &schema::Group, term: &schema::Term, phase: Phase) -> bool {
    phase.has_equations() || group.is_of_values(term)
}

/// Whether any row of a group counts at any of its points.
pub(super) fn is_any(counts: &[Vec<bool>]) -> bool {
    counts.iter().any(|row| row.contains(&true))
}
