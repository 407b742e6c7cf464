//! Whether the data would be met better if a given number were otherwise (Rao's score test). Sources may take over what is wrong with it, as far as
//! they can: what the data say beyond that is what counts.
//!
//! A prior says that sources are as small and as smooth as they may be, and any number that makes them smaller gains by it. So what is said here
//! is said by the rows alone, and unknowns take theirs where sources may be larger.

use super::iterate::{Phase, State};
use super::prior::Smoothness;
use super::rows::{Counted, Rows};
use super::solver::Solver;
use super::triangle::{Row, Triangle};
use crate::facts::{Known, Score};
use crate::given::{SMALL, given, slope};
use crate::solve::fault::Fault;

/// Share of what rows say of a number that must be left when the unknowns have taken theirs: below it is rounding.
pub(super) const OPEN: f64 = 1e-20;

impl Solver<'_> {
    /// Given numbers that can be asked about, by their slots. Under robust losses rows change with their weights, which must not.
    pub(super) fn given(&self) -> Vec<usize> {
        if self.bound.losses.iter().flatten().any(|loss| loss.is_robust()) {
            return Vec::new();
        }
        given(self.bound.problem.scene().schema, &self.scalars)
    }

    /// Scores of given numbers about an end.
    pub(super) fn scores(&mut self, kind: Smoothness, end: &State, given: &[usize]) -> Result<Vec<Score>, Fault> {
        self.set_smoothness(kind, end);
        let state = self.with_larger_sources(end);
        self.size(&state);
        let known = state.shared();
        let (rows, _) = self.rows_into(Rows::one_by_one(known), &state, Phase::Solve)?;
        let mut by = Vec::with_capacity(given.len());
        for &slot in given {
            let own = self.scalars[slot];
            let mut values = |share: f64| {
                self.scalars[slot] = own * (1.0 + share);
                let found = self.rows_into(Rows::one_by_one(known), &state, Phase::Solve);
                self.scalars[slot] = own;
                found.map(|(rows, _)| rows.values())
            };
            let (more, less) = (values(SMALL)?, values(-SMALL)?);
            by.push(more.into_iter().zip(less).map(slope).collect::<Vec<f64>>());
        }
        let believed = |class: usize| {
            class == state.classes.len() || self.roughness.contains(&class) || self.amplitude.contains(&Some(class))
        };
        let mut triangle = Triangle::new(self.heads.len(), self.band(&state), known + given.len());
        let (mut walk, mut number, mut shared) = (rows.walk(), 0, Vec::new());
        while let Some(Counted { row, class, .. }) = walk.step() {
            shared.clear();
            shared.extend_from_slice(row.shared);
            shared.extend(by.iter().map(|by| by[number]));
            number += 1;
            let value = if believed(class) { 0.0 } else { row.value };
            triangle.add(Row { shared: &shared, value, ..row });
        }
        let wholes = by.iter().map(|by| by.iter().map(|by| by * by).sum::<f64>());
        let all = given.iter().zip(triangle.beside(given.len())).zip(wholes);
        let told = all.filter(|((_, [_, square]), whole)| *square > OPEN * whole);
        let score = |((&slot, [slope, square]), _): ((&usize, [f64; 2]), f64)| {
            Score::by((Known::Scalar(slot), false), slope, square)
        };
        Ok(told.filter_map(score).collect())
    }
}
