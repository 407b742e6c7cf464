//! Whether the data would be met better if a given number were otherwise. Sources may take over what is wrong with it, as far as they can:
//! what the data say beyond that is what counts.
//!
//! A prior says that sources are as small and as smooth as they may be, and any number that makes them smaller gains by it. So what is said here
//! is said by the rows alone, and unknowns take theirs where sources may be rougher. What equations are off by, as cells are coarse, says nothing
//! of a number: with all of its coefficients a tenth smaller, an equation is off by a tenth less.

use rayon::prelude::*;

use super::rows::Asked;
use super::run::Clock;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::facts::{Known, LARGER, Score};
use crate::given::{SMALL, given, slope};
use crate::local::block::Block;
use crate::local::rows::Evaluated;
use crate::local::scored::{Scored, add, asked};
use crate::local::surface::Surface;
use crate::schema::{self, TermKind};

/// Steps that all scores take, about, and that each number adds.
const STEPS: f64 = 2.0;
const EACH: f64 = 0.3;

/// By own row of a group, whether it is an equation's.
fn equations(schema: &schema::Group) -> Vec<bool> {
    let own = schema.terms.iter().filter(|term| matches!(term.kind, TermKind::Residual | TermKind::Observation));
    own.flat_map(|term| std::iter::repeat_n(term.kind == TermKind::Residual, term.rows)).collect()
}

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
        let moved: Vec<[Vec<f64>; 2]> = known.iter().map(|&slot| self.moved(slot)).collect();
        let mut scored: Vec<Scored> =
            known.iter().map(|&slot| Scored::new(Known::Scalar(slot), coefficients, border)).collect();
        let mut integral = slopes.len();
        for asked in &rows.asked {
            let group = &self.groups[asked.at];
            let changes = moved.par_iter().map(|scalars| self.changes_of_rows(asked, &state, scalars));
            let changes: Vec<(Vec<f64>, Vec<f64>)> = changes.collect();
            let (own, mut places) = (group.own_rows().len(), group.order.iter());
            let is_equation = equations(group.schema);
            for mut blocks in self.batches(&rows, asked) {
                for block in &mut blocks {
                    block
                        .misfits
                        .iter_mut()
                        .zip(&is_equation)
                        .for_each(|(x, is_equation)| *x *= f64::from(!is_equation));
                }
                blocks.iter().for_each(|block| add(block, &block.misfits, &mut gradient, &mut below));
                let blocks: Vec<(Block, usize)> =
                    blocks.into_iter().zip(places.by_ref()).map(|(block, &place)| (block, place as usize)).collect();
                scored.par_iter_mut().zip(&changes).for_each(|(scored, (by, _))| {
                    blocks.iter().for_each(|(block, place)| scored.add(block, &by[place * own..][..own]));
                });
            }
            for (scored, (_, sums)) in scored.iter_mut().zip(&changes) {
                scored.below[integral..][..sums.len()].iter_mut().zip(sums).for_each(|(below, by)| *below += by);
            }
            integral += changes.first().map_or(0, |(_, sums)| sums.len());
        }
        for (surface, blocks) in self.surfaces.iter().zip(&rows.clouds).filter(|(_, blocks)| !blocks.is_empty()) {
            blocks.iter().for_each(|block| add(block, &block.misfits, &mut gradient, &mut below));
            scored.par_iter_mut().zip(&moved).for_each(|(scored, scalars)| {
                let by = self.changes_of_cloud(surface, &state, scalars);
                blocks.iter().zip(by).for_each(|(block, by)| scored.add(block, &[by]));
            });
        }
        // The border holds the misfits of integrals.
        below[slopes.len()..].copy_from_slice(&self.normal.border_gradient[slopes.len()..]);
        Some(asked(&scored, &factor, (&gradient, &below), false).into_iter().filter_map(|told| told.score).collect())
    }

    /// The scalars with a little more and a little less of one of them.
    fn moved(&self, slot: usize) -> [Vec<f64>; 2] {
        [SMALL, -SMALL].map(|share| {
            let mut scalars = self.scalars.clone();
            scalars[slot] *= 1.0 + share;
            scalars
        })
    }

    /// What a scalar changes of a group: by place and row what it changes of what the row is over its tolerance, where that is asked for; and
    /// by integral that is asked for what it changes of the sum.
    fn changes_of_rows(&self, asked: &Asked, state: &State, moved: &[Vec<f64>; 2]) -> (Vec<f64>, Vec<f64>) {
        let group = &self.groups[asked.at];
        let evaluated = moved.each_ref().map(|scalars| group.evaluate(&self.heads, &state.theta, scalars, false));
        let [more, less] = &evaluated;
        let rows = group.own_rows();
        let of = |place: usize, row: usize| {
            if !asked.counts[row][place] {
                return 0.0;
            }
            let over = |evaluated: &Evaluated| group.over_tolerance(evaluated, row, place);
            let (loss, times) = group.losses[row];
            let own = over(&asked.evaluated) / times.sqrt();
            let weight = if loss.is_robust() { loss.weight(own).sqrt() } else { 1.0 };
            weight * slope((over(more), over(less)))
        };
        let by = (0..group.places()).flat_map(|place| rows.iter().map(move |&row| (place, row)));
        let sums = group.sums(more, &moved[0]).into_iter().zip(group.sums(less, &moved[1]));
        let sums = sums.filter(|((row, _), _)| asked.counts[*row].contains(&true));
        (
            by.map(|(place, row)| of(place, row)).collect(),
            sums.map(|((_, more), (_, less))| slope((more, less))).collect(),
        )
    }

    /// What a scalar changes of the rows of a cloud.
    fn changes_of_cloud(&self, surface: &Surface, state: &State, moved: &[Vec<f64>; 2]) -> Vec<f64> {
        let images =
            |scalars: &Vec<f64>| surface.images(&self.groups[surface.group], &self.heads, &state.theta, scalars);
        let [more, less] = moved.each_ref().map(images);
        let moved = more.into_iter().zip(less).map(|(more, less)| (more - less) / (2.0 * SMALL));
        surface.changes(&moved.collect::<Vec<_>>(), self.sigma(state, surface))
    }
}
