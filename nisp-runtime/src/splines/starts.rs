//! Where steps start.

use super::iterate::{Phase, State};
use super::place::Place;
use super::solver::{SHORTEST, Solver};
use super::step::TOLERANCE;
use crate::noise::{Noise, ObservationNoise};
use crate::schema::{self, TermKind};
use crate::start::{self, QUIETER, ROUGHER};
use crate::tolerance::LOOSE;
use crate::weighed::{Class, Guess, of_terms};

/// Least roughness, and least amplitude of a source beside its natural size.
const LEAST_ROUGHNESS: f64 = 1e-12;
const LEAST_AMPLITUDE: f64 = 1e-6;

impl Solver<'_> {
    /// Where the solver starts: heads at their offsets, or at another level where equations and data have no value there, and noise
    /// as differences of the data say.
    pub(super) fn first(&mut self, noise: &Noise) -> State {
        let schema = self.bound.problem.scene().schema;
        let mut classes = of_terms(self.bound, noise, Some(TOLERANCE));
        let open = |size: f64, least: f64| Class::open(size, Guess { size: 0.0, count: 0.0, yields: false, least });
        let natural = self.length.sqrt();
        let observed = schema.observed();
        let rough = self.priors.iter().enumerate().map(|(head, prior)| {
            let own = prior.roughness(natural, SHORTEST);
            // Observed fields are rougher than anything that the cells can hold, until the first step says how rough.
            let is_regressed = !schema.heads[head].source && observed.contains(&head);
            open(if is_regressed { prior.roughness(natural, 1.0).max(1e9) } else { own }, LEAST_ROUGHNESS)
        });
        classes.extend(rough);
        classes.extend(self.amplitude.iter().flatten().map(|_| open(natural, LEAST_AMPLITUDE * natural)));
        classes.extend(self.first_lengths());
        let (theta, learned) = (vec![0.0; self.heads.len()], vec![0.0; self.bound.learned.len()]);
        let convex = self.bound.losses.iter().flatten().any(|loss| loss.convex() != *loss);
        let mut state = State {
            theta,
            learned,
            lines: vec![0.0; self.belief.numbers * self.amplitude.iter().flatten().count()],
            classes,
            uneven: Vec::new(),
            doubt: 0.0,
            blurred: false,
            sharing: None,
            tolerance: LOOSE,
            convex,
            held: self.is_beside_sources(),
            step: 0,
        };
        self.level(&mut state);
        state
    }

    /// Begins where equations and data have a value, unless they have one at the state.
    pub(super) fn come_back(&mut self, state: &mut State) {
        self.size(state);
        if !self.loss(state, Phase::Solve).is_finite() {
            self.level(state);
        }
    }

    /// Heads at their offsets, or at another level where equations and data have no value there.
    fn level(&mut self, state: &mut State) {
        let level = start::level(|level| {
            state.theta.fill(level);
            self.size(state);
            self.loss(state, Phase::Solve).is_finite()
        });
        state.theta.fill(level);
    }

    /// Heads that Gauss-Newton steps cannot move from a state, since rows change alike either way: the data leave their sign open.
    pub(super) fn asleep(&self, state: &State) -> Vec<usize> {
        let sleeps = |head: &usize| {
            let at = start::EITHER_WAY.map(|by| {
                let mut theta = state.theta.clone();
                self.heads.numbers(*head, 0).iter().for_each(|&number| theta[number] += by);
                theta
            });
            let terms = self.groups.iter().filter(|group| group.len() > 0).flat_map(|group| {
                let found = at.each_ref().map(|theta| group.evaluate(&self.heads, theta, &self.scalars, None));
                let rows = move |term: &schema::Term| {
                    let all =
                        || (term.first..term.first + term.rows).flat_map(|row| (0..group.len()).map(move |p| (row, p)));
                    let own = found.each_ref().map(|found| all().map(|(row, p)| found.row(row, p)).collect());
                    (term.kind == TermKind::Observation, own)
                };
                group.schema.terms.iter().map(rows)
            });
            start::sleeps(&terms.collect::<Vec<_>>())
        };
        (0..self.heads.bases.len()).filter(sleeps).collect()
    }

    /// Where the steps start again, with less noise and rougher sources, where the noise of the most likely end may hide a source.
    pub(super) fn again(&mut self, noise: &Noise, place: &Place) -> Option<State> {
        let best = &place.best()?.state;
        let class = |found: &ObservationNoise| self.classes[found.group][found.term];
        let count = |found: &ObservationNoise| self.groups[found.group].len();
        if place.is_again
            || !self.has_sources()
            || !start::may_hide(noise, count, |found| best.classes[class(found)].size)
        {
            return None;
        }
        let quiet: Vec<(usize, f64)> =
            noise.observations.iter().map(|found| (class(found), QUIETER * found.deviation)).collect();
        let mut first = self.first(noise);
        for (class, size) in quiet {
            first.classes[class].restart(size);
        }
        for (head, &class) in self.roughness.iter().enumerate().filter(|(head, _)| self.amplitude[*head].is_some()) {
            let natural = self.priors[head].roughness(self.length.sqrt(), SHORTEST);
            first.classes[class].restart(ROUGHER * natural);
        }
        Some(State { step: place.state.step, ..first })
    }
}
