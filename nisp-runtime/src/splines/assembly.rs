//! Rows about an iterate: of terms, of priors, and of those that keep everything bounded.

use super::cells::{MANY, SMOOTH};
use super::iterate::{Phase, State};
use super::rows::Rows;
use super::solver::Solver;
use super::triangle::Row;
use crate::loss::Loss;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;

/// Coefficients that nothing speaks of are drawn to zero as by rows that multiply each by this.
pub(super) const RIDGE: f64 = 1e-6;
/// How far a step may move all coefficients of a head together where nothing speaks of that. A field of which equations take
/// derivatives alone may be off by any constant; beside variances much larger than this those of the rest would be rounding.
const FREE: f64 = 10.0;
/// Standard deviation of the learned scalars' parameters before any row is seen.
pub(super) const LEARNED: f64 = 10.0;
/// The same beside sources, before the first end.
const HELD: f64 = 0.03;

impl Solver<'_> {
    /// What a row of a group is divided by.
    pub(super) fn sigma(&self, state: &State, group: usize, term: usize, row: usize) -> f64 {
        let declared = &self.groups[group].schema.terms[term];
        match declared.kind {
            TermKind::Observation => state.classes[self.classes[group][term]].size,
            _ if declared.within.is_some() => self.sizes[group][row],
            _ if state.blurred => (state.tolerance * self.sizes[group][row]).hypot(self.blurs[group][row]),
            _ => state.tolerance * self.sizes[group][row],
        }
    }

    /// The same at a place.
    pub(super) fn sigma_at(&self, state: &State, (group, term): (usize, usize), row: usize, p: usize) -> f64 {
        let around = self.between[group][row].get(p).copied().unwrap_or(0.0);
        self.sigma(state, group, term, row).max(around) * self.bound.noisiness_at((group, row), p)
    }

    /// How the misfits of a group's term count at a state.
    fn loss_of(&self, state: &State, (group, term): (usize, usize)) -> Loss {
        let loss = self.bound.losses[group][term];
        if state.convex { loss.convex() } else { loss }
    }

    /// Rows about a state with their classes, in the order of their unknowns, and what [`Solver::loss`] makes of them; what is
    /// not finite is a fault.
    pub(super) fn rows(&mut self, state: &State, phase: Phase) -> Result<(Rows, f64), Fault> {
        self.rows_into(Rows::new(state.shared()), state, phase)
    }

    /// The same, kept in the way of some that are empty.
    pub(super) fn rows_into(&mut self, mut rows: Rows, state: &State, phase: Phase) -> Result<(Rows, f64), Fault> {
        let slopes = self.set_learned(&state.learned);
        let shared = state.shared();
        let mut cost = 0.0;
        for (at, group) in self.groups.iter().enumerate() {
            let takes_part = |term: &schema::Term| self.takes_part(at, term, phase);
            if group.len() == 0 || !group.schema.terms.iter().any(takes_part) {
                continue;
            }
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, Some(slopes.len()));
            for (number, term) in group.schema.terms.iter().enumerate().filter(|(_, term)| takes_part(term)) {
                let is_unmeasured = !self.is_measured && term.kind == TermKind::Observation;
                if is_unmeasured || self.left_out == Some(self.classes[at][number]) {
                    continue;
                }
                if let Some(noise) = self.shared(state, (at, number)) {
                    let mut take = |row: Row<'_>| rows.push(row, self.classes[at][number]);
                    cost += self.chained(state, (at, number), (noise, &slopes), &mut take)?;
                    continue;
                }
                let loss = self.loss_of(state, (at, number));
                let lacking = self.bound.lacking(at, term);
                let count = group.asked(term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                for row in term.first..term.first + term.rows {
                    for (cell, places) in group.by_cell(|p| p < count && is_there(&p)) {
                        let mut own = group.bundle(&self.heads, cell, shared);
                        for p in places {
                            let misfit = found.row(row, p);
                            if !misfit.is_finite() {
                                let name = format!("{}.{}", group.schema.name, term.name);
                                return Err(Fault::residual(name, Some(p)));
                            }
                            let sigma = self.sigma_at(state, (at, number), row, p);
                            cost += loss.rho(misfit / sigma);
                            let factor = loss.weight(misfit / sigma).sqrt() / sigma;
                            group.add_row(&self.heads, (&found, row, p), &slopes, factor, &mut own);
                        }
                        rows.push_all(&own, self.classes[at][number]);
                    }
                }
            }
        }
        let known = state.classes.len();
        let none = vec![0.0; shared];
        cost += self.add_priors(state, phase, &mut |row, class| rows.push(row, class));
        for head in 0..self.heads.bases.len() {
            let numbers = self.heads.numbers(head, 0);
            let stay = RIDGE.max((FREE * (numbers.len() as f64).sqrt()).recip());
            // Without data fields begin anywhere, and the equations make the rest of them.
            let order = match self.amplitude[head] {
                None if !self.is_measured => self.heads.bases[head].degree - SMOOTH,
                _ => 0,
            };
            let stay = if self.is_measured { stay } else { RIDGE };
            for (function, &number) in numbers.iter().enumerate() {
                let stay = if function < order { FREE.recip() } else { stay };
                // What no data speak of stays where equations have a value. The row holds coefficients to where they are more than
                // it draws them to zero.
                let pull = if phase == Phase::Regress { 0.0 } else { RIDGE.powi(2) * state.theta[number] };
                rows.push(Row { first: number, slopes: &[stay], shared: &none, value: pull / stay }, known);
            }
        }
        rows.sort();
        let deviation = if state.held { HELD } else { LEARNED };
        let learned = state.learned.iter().map(|parameter| (deviation.recip(), parameter / deviation));
        // Before sources are sought nothing else speaks of their lines.
        let unsought = state.lines.iter().filter(|_| phase == Phase::Regress).map(|own| (1.0, *own));
        for (at, (factor, value)) in learned.chain(unsought).enumerate() {
            let mut shared = none.clone();
            shared[at] = factor;
            rows.push(Row { first: 0, slopes: &[], shared: &shared, value }, known);
        }
        Ok((rows, cost))
    }

    /// True if a term's rows count in a phase: data, and conditions on values, are regressed before equations hold.
    pub(super) fn takes_part(&self, at: usize, term: &schema::Term, phase: Phase) -> bool {
        let group = &self.groups[at];
        let is_condition = || term.kind == TermKind::Residual && group.len() < MANY && group.schema.is_of_values(term);
        phase == Phase::Solve || term.kind == TermKind::Observation || is_condition()
    }

    /// The heads that have a prior in a phase: sources, or fields while only data are regressed.
    pub(super) fn believed(&self, phase: Phase) -> Vec<usize> {
        let heads = &self.bound.problem.scene().schema.heads;
        (0..heads.len()).filter(|&head| heads[head].source == (phase == Phase::Solve)).collect()
    }

    /// The heads whose roughness the evidence finds in a phase: sources, or observed fields while only data are regressed.
    pub(super) fn judged(&self, phase: Phase) -> Vec<usize> {
        let observed = self.bound.problem.scene().schema.observed();
        self.believed(phase).into_iter().filter(|head| phase == Phase::Solve || observed.contains(head)).collect()
    }

    /// Gives the rows that keep sources near their lines and smooth, or fields smooth while only data are regressed, with their
    /// classes; returns half the sum of their squares.
    pub(super) fn add_priors(&self, state: &State, phase: Phase, take: &mut dyn FnMut(Row<'_>, usize)) -> f64 {
        let mut shared = vec![0.0; state.learned.len() + state.lines.len()];
        let mut slopes = Vec::new();
        let mut cost = 0.0;
        for head in self.believed(phase) {
            let (prior, class) = (&self.priors[head], self.roughness[head]);
            // A line, and which of the shared unknowns it is.
            let own = if phase == Phase::Solve { self.line(head) } else { 0..0 };
            let (line, at) = (&state.lines[own.clone()], state.learned.len() + own.start);
            // What of a row is the line's, and its slopes by it.
            let beside = |first: usize, factors: &[f64], slopes: &mut [f64]| {
                let along = prior.straight.along(first, factors);
                slopes[at..].iter_mut().zip(along).take(line.len()).for_each(|(slope, along)| *slope = -along);
                line.iter().zip(along).map(|(own, along)| own * along).sum::<f64>()
            };
            for (first, factors) in prior.smooth(state.classes[class].size) {
                let factors = &factors[..prior.width()];
                let (number, value) = self.heads.row_of((head, first), factors, &state.theta, &mut slopes);
                let value = value - beside(first, factors, &mut shared);
                cost += 0.5 * value * value;
                take(Row { first: number, slopes: &slopes, shared: &shared, value }, class);
            }
            let Some(class) = self.amplitude[head] else { continue };
            let amplitude = state.classes[class].size;
            let numbers = self.heads.numbers(head, 0);
            for (first, (&number, factor)) in numbers.iter().zip(prior.small(amplitude)).enumerate() {
                let value = factor * state.theta[number] - beside(first, &[factor], &mut shared);
                cost += 0.5 * value * value;
                take(Row { first: number, slopes: &[factor], shared: &shared, value }, class);
            }
            let factor = self.line_deviation(head, (state.classes[self.roughness[head]].size, amplitude)).recip();
            shared.fill(0.0);
            for (number, own) in line.iter().enumerate() {
                let value = factor * own;
                cost += 0.5 * value * value;
                shared[at + number] = factor;
                take(Row { first: 0, slopes: &[], shared: &shared, value }, state.classes.len());
                shared[at + number] = 0.0;
            }
        }
        cost
    }

    /// Half the sum of squares of all rows, robust ones by what they cost.
    pub(super) fn loss(&mut self, state: &State, phase: Phase) -> f64 {
        self.set_learned(&state.learned);
        let mut sum = 0.0;
        for (at, group) in self.groups.iter().enumerate().filter(|(_, group)| group.len() > 0) {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, None);
            for (number, term) in group.schema.terms.iter().enumerate() {
                if !self.takes_part(at, term, phase) {
                    continue;
                }
                if let Some(noise) = self.shared(state, (at, number)) {
                    sum += self.chained_loss(state, (at, number), noise);
                    continue;
                }
                let loss = self.loss_of(state, (at, number));
                let lacking = self.bound.lacking(at, term);
                let count = group.asked(term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                for row in term.first..term.first + term.rows {
                    let sigma = |p: usize| self.sigma_at(state, (at, number), row, p);
                    sum += (0..count).filter(is_there).map(|p| loss.rho(found.row(row, p) / sigma(p))).sum::<f64>();
                }
            }
        }
        sum + self.add_priors(state, phase, &mut |_, _| {})
    }
}
