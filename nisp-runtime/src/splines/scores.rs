//! Whether the data would be met better if a given number or column were otherwise, or if a sensor had an offset (Rao's score test). Sources may take over what is wrong with it, as far as
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
use crate::schema::TermKind;
use crate::solve::fault::Fault;
use crate::standing::stands;

/// Share of what rows say of a number that must be left when the unknowns have taken theirs: below it is rounding.
pub(super) const OPEN: f64 = 1e-20;
/// Rows of a record whose sensor may be said to have an offset, at least.
const FEWEST: usize = 16;

impl Solver<'_> {
    /// What is taken for known and can be asked about: given numbers, that measured columns of a record have no offset, and that given columns
    /// are right where they stand still. Under robust losses rows change with their weights, which must not.
    pub(super) fn known(&self) -> Vec<Known> {
        if self.bound.losses.iter().flatten().any(|loss| loss.is_robust()) {
            return Vec::new();
        }
        let schema = self.bound.problem.scene().schema;
        let given = given(schema, &self.scalars).into_iter().map(Known::Scalar);
        let records = self.groups.iter().enumerate().filter(|(_, group)| group.len() >= FEWEST);
        let observed = records.clone().flat_map(|(at, group)| {
            let terms = group.schema.terms.iter().filter(|term| term.kind == TermKind::Observation);
            terms.flat_map(move |term| term.columns.iter().map(move |&column| Known::Offset { group: at, column }))
        });
        let standing = records.flat_map(|(at, group)| {
            let observed: Vec<usize> = group.schema.terms.iter().flat_map(|term| term.columns).copied().collect();
            let given = (0..group.schema.columns.len()).filter(move |column| !observed.contains(column));
            let stands = given.filter(move |&column| !stands(&self.bound.columns[at][column]).is_empty());
            stands.map(move |column| Known::Standing { group: at, column })
        });
        given.chain(observed).chain(standing).collect()
    }

    /// Scores of what is taken for known about an end.
    pub(super) fn scores(&mut self, kind: Smoothness, end: &State, all: &[Known]) -> Result<Vec<Score>, Fault> {
        self.set_smoothness(kind, end);
        let state = self.with_larger_sources(end);
        self.size(&state);
        let learned = state.shared();
        let (rows, _) = self.rows_into(Rows::one_by_one(learned), &state, Phase::Solve)?;
        let mut by = Vec::with_capacity(all.len());
        for &known in all {
            let mut values = |share: f64| {
                let size = self.move_known(known, share);
                let found = self.rows_into(Rows::one_by_one(learned), &state, Phase::Solve);
                self.move_back(known, size);
                found.map(|(rows, _)| rows.values())
            };
            let (more, less) = (values(SMALL)?, values(-SMALL)?);
            by.push(more.into_iter().zip(less).map(slope).collect::<Vec<f64>>());
        }
        let believed = |class: usize| {
            class == state.classes.len() || self.roughness.contains(&class) || self.amplitude.contains(&Some(class))
        };
        let mut triangle = Triangle::new(self.heads.len(), self.band(&state), learned + all.len());
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
        let told = all.iter().zip(triangle.beside(all.len())).zip(wholes);
        let told = told.filter(|((_, [_, square]), whole)| *square > OPEN * whole);
        let score =
            |((&known, [slope, square]), _): ((&Known, [f64; 2]), f64)| Score::by((known, false), slope, square);
        Ok(told.filter_map(score).collect())
    }

    /// Moves what is known by a share of its size; returns what it was.
    fn move_known(&mut self, known: Known, share: f64) -> Vec<f64> {
        match known {
            Known::Scalar(slot) => {
                let own = self.scalars[slot];
                self.scalars[slot] *= 1.0 + share;
                vec![own]
            }
            Known::Offset { group, column } => {
                let by = share * self.bound.spread_of(group, column);
                let own = self.groups[group].column(column).to_vec();
                self.groups[group].column(column).iter_mut().for_each(|value| *value += by);
                own
            }
            Known::Standing { group, column } => {
                let by = share * self.bound.spread_of(group, column);
                let len = self.groups[group].len();
                let values = self.groups[group].column(column);
                let own = values.to_vec();
                stands(&own[..len]).into_iter().flatten().for_each(|at| values[at] += by);
                own
            }
            Known::Place { .. } | Known::Direction { .. } | Known::Size { .. } => Vec::new(),
        }
    }

    /// Puts back what was known.
    fn move_back(&mut self, known: Known, own: Vec<f64>) {
        match known {
            Known::Scalar(slot) => self.scalars[slot] = own[0],
            Known::Offset { group, column } | Known::Standing { group, column } => {
                self.groups[group].column(column).copy_from_slice(&own)
            }
            Known::Place { .. } | Known::Direction { .. } | Known::Size { .. } => {}
        }
    }
}
