//! What the rows of a step say of noise and roughness.

use rand::SeedableRng;
use rand::rngs::StdRng;

use super::freedom::Unmeasured;
use super::rows::{Asked, Rows};
use super::sampled::{Sampled, used};
use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::block::Block;
use crate::local::normal::factor::Factor;
use crate::loss::{Loss, deviation_of_clean};
use crate::schema::{self, TermKind};
use crate::weighed::Tally;

impl Solver<'_> {
    /// By class, what is left of its rows after a step, how many there are, and how many of them the answer used up.
    pub(super) fn tallies(
        &self,
        state: &State,
        rows: &Rows,
        (step, shared): (&[f64], &[f64]),
        (factor, unmeasured): (&Factor, &Unmeasured),
    ) -> Option<Vec<Tally>> {
        let mut tallies = vec![Tally::default(); state.classes.len()];
        let mut random = StdRng::seed_from_u64(0);
        let lens = (step.len(), shared.len());
        // Sums over rows, with their class and how many of them count.
        let (mut of, mut sums) = (Vec::new(), Vec::new());
        for asked in &rows.asked {
            let group = &self.groups[asked.at];
            let terms = group.schema.terms.iter().enumerate();
            let observed: Vec<(usize, &schema::Term)> =
                terms.filter(|(_, term)| term.kind == TermKind::Observation).collect();
            if observed.is_empty() {
                continue;
            }
            let sampled =
                |(_, term): &(usize, &schema::Term)| Sampled::new(group.sites.count * term.rows, lens, &mut random);
            let mut own: Vec<Sampled> = observed.iter().map(sampled).collect();
            for blocks in self.batches(rows, asked) {
                for ((_, term), sampled) in observed.iter().zip(&mut own) {
                    let first = group.first_own(term);
                    let own = blocks.iter().flat_map(|block| (first..first + term.rows).map(move |row| (block, row)));
                    sampled.add(&own.collect::<Vec<_>>(), (step, shared));
                }
            }
            of.extend(observed.into_iter().map(|(number, term)| {
                let counts = asked.counts[term.first..term.first + term.rows].iter().flatten();
                (self.classes[asked.at][number], counts.filter(|counts| **counts).count())
            }));
            sums.append(&mut own);
        }
        for (surface, blocks) in self.surfaces.iter().zip(&rows.clouds) {
            let own: Vec<(&Block, usize)> = blocks.iter().map(|block| (block, 0)).collect();
            let mut sampled = Sampled::new(own.len(), lens, &mut random);
            sampled.add(&own, (step, shared));
            of.push((self.class(surface), own.len()));
            sums.push(sampled);
        }
        for (((class, count), sum), used) in of.into_iter().zip(&sums).zip(used(&sums, factor)?) {
            tallies[class] = sum.tally(count, used);
        }
        for asked in &rows.asked {
            self.clean(state, asked, &mut tallies);
        }
        for surface in &self.surfaces {
            let tally = &mut tallies[self.class(surface)];
            // Clouds have outliers, which are no noise.
            let clean = deviation_of_clean(surface.misfits().collect(), tally.used) / self.sigma(state, surface);
            tally.squares = clean.powi(2) * (tally.count - tally.used);
        }
        for head in self.judged(state.phase) {
            let blocks = self.prior_rows(state, head);
            let own: Vec<(&Block, usize)> = blocks.iter().map(|block| (block, 0)).collect();
            let tally = &mut tallies[self.roughness[head]];
            tally.count = self.priors[head].rank as f64;
            tally.squares = blocks.iter().map(|block| block.after(0, step, shared).powi(2)).sum();
            tally.used = match state.phase {
                // What data leave of a field is no small difference.
                Phase::Regress => {
                    let mut sampled = Sampled::new(own.len(), lens, &mut random);
                    sampled.add(&own, (step, shared));
                    used(&[sampled], factor)?[0]
                }
                Phase::Explain | Phase::Solve => {
                    let roughness = state.classes[self.roughness[head]].size;
                    let settled = self.freedoms[head].as_ref()?.settled(factor, step.len(), roughness)?;
                    let before = unmeasured.of(head);
                    tally.squares = (tally.squares - before.squares).max(0.0);
                    tally.count - (settled - before.settled)
                }
            };
        }
        Some(tallies)
    }

    /// Puts the squares of clean misfits at a state in place of what rows under Huber's loss have added to their tallies: squares by their
    /// weights grow with every outlier's distance.
    fn clean(&self, state: &State, asked: &Asked, tallies: &mut [Tally]) {
        let group = &self.groups[asked.at];
        let terms = group.schema.terms.iter().enumerate();
        let is_such = |number: usize| matches!(self.bound.losses[asked.at][number], Loss::Huber(_));
        for (number, term) in terms.filter(|(number, term)| is_such(*number) && term.kind == TermKind::Observation) {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            let misfits = (term.first..term.first + term.rows).flat_map(|row| {
                let there = (0..group.places()).filter(|&place| asked.counts[row][place]);
                there.map(|place| group.over_tolerance(&found, row, place)).collect::<Vec<f64>>()
            });
            let tally = &mut tallies[self.classes[asked.at][number]];
            let clean = deviation_of_clean(misfits.collect(), tally.used);
            tally.squares = clean.powi(2) * (tally.count - tally.used).max(0.0);
        }
    }
}
