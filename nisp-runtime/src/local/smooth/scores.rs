//! Whether the data would be met better if a given number were otherwise. Sources may take over what is wrong with it, as far as they can:
//! what the data say beyond that is what counts.
//!
//! A prior says that sources are as small and as smooth as they may be, and any number that makes them smaller gains by it. So what is said here
//! is said by the rows alone, and unknowns take theirs where sources may be rougher.

use rayon::prelude::*;

use super::rows::{Asked, Rows};
use super::run::Clock;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::facts::{Known, LARGER, Score};
use crate::given::{SMALL, given, slope};
use crate::local::block::Block;
use crate::local::rows::Evaluated;
use crate::local::scored::{Scored, add};

/// Steps that all scores take, about, and that each number adds.
const STEPS: f64 = 2.0;
const EACH: f64 = 0.3;

impl Solver<'_> {
    /// Scores of given numbers about an end; none where steps of so many seconds leave no time for them.
    pub(super) fn scores(&mut self, end: &State, clock: &Clock, seconds: f64) -> Vec<Score> {
        let known = given(self.schema(), &self.scalars);
        let has_time = clock.has_time((STEPS + EACH * known.len() as f64) * seconds);
        if known.is_empty() || !self.is_measured() || !has_time {
            return Vec::new();
        }
        self.scores_of(&known, end).unwrap_or_default()
    }

    fn scores_of(&mut self, known: &[usize], end: &State) -> Option<Vec<Score>> {
        let mut state = end.clone();
        for head in self.judged(Phase::Solve) {
            state.classes[self.roughness[head]].size *= LARGER;
        }
        let slopes = self.set_learned(&state.learned);
        self.size(&state);
        self.set_sigmas(&state);
        let rows = self.assemble(&state, &slopes).ok()?;
        let factor = self.normal.factor()?;
        let (coefficients, border) = (self.heads.len(), self.normal.border_gradient.len());
        let (mut gradient, mut below) = (vec![0.0; coefficients], vec![0.0; border]);
        let blocks = rows.asked.iter().flat_map(|asked| self.batches(&rows, asked)).flatten();
        blocks.chain(rows.clouds.iter().flatten().cloned()).for_each(|block| {
            add(&block, &block.misfits, &mut gradient, &mut below);
        });
        // Of an integral the border has its misfit.
        below[slopes.len()..].copy_from_slice(&self.normal.border_gradient[slopes.len()..]);
        let score = |&slot: &usize| {
            let mut scored = Scored::new(Known::Scalar(slot), coefficients, border);
            self.score_rows(&rows, slot, &state, &mut scored);
            scored.score(&factor, (&gradient, &below), false)
        };
        Some(known.par_iter().filter_map(score).collect())
    }

    /// Adds all rows with their derivatives by a scalar.
    fn score_rows(&self, rows: &Rows, slot: usize, state: &State, scored: &mut Scored) {
        let [more, less] = [SMALL, -SMALL].map(|share| {
            let mut scalars = self.scalars.clone();
            scalars[slot] *= 1.0 + share;
            scalars
        });
        let mut integral = rows.learned.len();
        for asked in &rows.asked {
            let group = &self.groups[asked.at];
            let [more, less] =
                [&more, &less].map(|scalars| (group.evaluate(&self.heads, &state.theta, scalars, false), scalars));
            for (&place, block) in group.order.iter().zip(self.batches(rows, asked).flatten()) {
                scored.add(&block, &self.slopes_of(asked, (&more.0, &less.0), place as usize));
            }
            let sums = |(evaluated, scalars): (Evaluated, &Vec<f64>)| group.sums(&evaluated, scalars);
            let sums = sums(more).into_iter().zip(sums(less));
            for ((_, more), (_, less)) in sums.filter(|((row, _), _)| asked.counts[*row].contains(&true)) {
                scored.below[integral] += slope((more, less));
                integral += 1;
            }
        }
        for (surface, blocks) in self.surfaces.iter().zip(&rows.clouds).filter(|(_, blocks)| !blocks.is_empty()) {
            let group = &self.groups[surface.group];
            let images = |scalars: &[f64]| surface.images(group, &self.heads, &state.theta, scalars);
            let moved: Vec<_> = images(&more).into_iter().zip(images(&less)).collect();
            let moved: Vec<_> = moved.into_iter().map(|(more, less)| (more - less) / (2.0 * SMALL)).collect();
            let by = surface.changes(&moved, self.sigma(state, surface));
            blocks.iter().zip(by).for_each(|(block, by): (&Block, f64)| scored.add(block, &[by]));
        }
    }

    /// By row at a place that is asked for, what a scalar changes of what it is over its tolerance.
    fn slopes_of(&self, asked: &Asked, (more, less): (&Evaluated, &Evaluated), place: usize) -> Vec<f64> {
        let group = &self.groups[asked.at];
        let of = |row: usize| {
            if !asked.counts[row][place] {
                return 0.0;
            }
            let over = |evaluated: &Evaluated| group.over_tolerance(evaluated, row, place);
            let (loss, times) = group.losses[row];
            let own = over(&asked.evaluated) / times.sqrt();
            let weight = if loss.is_robust() { loss.weight(own).sqrt() } else { 1.0 };
            weight * slope((over(more), over(less)))
        };
        group.own_rows().into_iter().map(of).collect()
    }
}
