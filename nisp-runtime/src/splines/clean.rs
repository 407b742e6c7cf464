//! The noise of measurements under Huber's loss, from those that are no outliers. A weighted square grows with the distance of an outlier, so
//! that a few outliers would make the noise many times too large.

use super::iterate::{Phase, State};
use super::solver::Solver;
use crate::loss::{Loss, deviation_of_clean};
use crate::schema::TermKind;
use crate::weighed::Tally;

impl Solver<'_> {
    /// Puts the squares of clean misfits at a state in place of what rows under Huber's loss have added to their tallies.
    pub(super) fn clean(&self, state: &State, phase: Phase, tallies: &mut [Tally]) {
        for (at, group) in self.groups.iter().enumerate().filter(|(_, group)| group.len() > 0) {
            let terms = group.schema.terms.iter().enumerate();
            let is_such = |number: usize| matches!(self.bound.losses[at][number], Loss::Huber(_));
            for (number, term) in terms.filter(|(number, term)| is_such(*number) && self.takes_part(at, term, phase)) {
                let class = self.classes[at][number];
                if term.kind != TermKind::Observation || self.left_out == Some(class) {
                    continue;
                }
                let found = group.evaluate(&self.heads, &state.theta, &self.scalars, None);
                let lacking = self.bound.lacking(at, term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                let misfits = (term.first..term.first + term.rows).flat_map(|row| {
                    let there = (0..group.asked(term)).filter(is_there);
                    there.map(|p| found.row(row, p) / self.sigma_at(state, (at, number), row, p)).collect::<Vec<f64>>()
                });
                let tally = &mut tallies[class];
                let clean = deviation_of_clean(misfits.collect(), tally.used);
                tally.squares = clean.powi(2) * (tally.count - tally.used).max(0.0);
            }
        }
    }
}
