//! What is asked for between the places of equations: bounds, and what is stated of values beside them.
//!
//! At the places these have as many rows as a spline has freedom beside the equations, so that together with those in between they
//! are more. Where a bound sets in or lets go, no spline holds all of them, and one that tried to would leave the data. So each row
//! weighs as much as the rows around it can be held.

use super::cells::SMOOTH;
use super::group::Group;
use super::heads::Heads;
use super::iterate::State;
use super::solver::Solver;
use crate::schema;
use crate::solve::vector::root_mean_square;

impl Group {
    /// The same, with a place in the middle between neighbours where the group has terms that are asked for there, too.
    pub(super) fn with_between(self, heads: &Heads, places: &[f64], columns: &[Vec<f64>]) -> Self {
        if !self.schema.terms.iter().any(|term| self.schema.asks_between(term)) {
            return self;
        }
        let order = self.along();
        let with = |values: &[f64]| -> Vec<f64> {
            let middle = |pair: &[usize]| 0.5 * (values[pair[0]] + values[pair[1]]);
            values.iter().copied().chain(order.windows(2).map(middle)).collect()
        };
        // No term that is asked for in between reads columns.
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| with(column)).collect();
        let own = self.len();
        let mut all = Self::new(self.schema, self.kernel, heads, &with(places), &columns);
        all.own = own;
        all
    }

    /// Its places along the coordinate.
    pub(super) fn along(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by(|&a, &b| self.coordinates[a].total_cmp(&self.coordinates[b]));
        order
    }

    /// True where some of its places are between those of equations.
    pub(super) fn has_between(&self) -> bool {
        self.own < self.len()
    }

    /// Places at which a term is asked for: the first so many.
    pub(super) fn asked(&self, term: &schema::Term) -> usize {
        if self.schema.asks_between(term) { self.len() } else { self.own }
    }
}

impl Solver<'_> {
    /// Takes over how far rows are off around each place: in as many cells on either side as splines are wide.
    pub(super) fn size_between(&mut self, state: &State) {
        let groups = self.groups.iter().zip(&mut self.between);
        for (group, sizes) in groups.filter(|(group, _)| group.has_between()) {
            let order = group.along();
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, None);
            let asked = group.schema.terms.iter().filter(|term| group.schema.asks_between(term));
            for row in asked.flat_map(|term| term.first..term.first + term.rows) {
                let off: Vec<f64> = order.iter().map(|&p| found.row(row, p)).collect();
                let near = |at: usize| at.saturating_sub(2 * SMOOTH)..(at + 2 * SMOOTH + 1).min(off.len());
                let around = |at: usize| root_mean_square(off[near(at)].iter().copied());
                sizes[row].resize(off.len(), 0.0);
                order.iter().enumerate().for_each(|(at, &p)| sizes[row][p] = around(at));
            }
        }
    }

    /// True for a class of rows of which those in between are some, by class.
    pub(super) fn shared_with_between(&self, state: &State) -> Vec<bool> {
        let mut is = vec![false; state.classes.len() + 1];
        for (group, classes) in self.groups.iter().zip(&self.classes).filter(|(group, _)| group.has_between()) {
            let terms = group.schema.terms.iter().zip(classes);
            terms.for_each(|(term, &class)| is[class] = group.schema.asks_between(term));
        }
        is
    }
}
