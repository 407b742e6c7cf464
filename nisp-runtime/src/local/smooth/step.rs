//! Gauss-Newton steps: where the normal equations about a state lead.

use super::freedom::Unmeasured;
use super::rows::is_any;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::LocalError;
use crate::local::normal::factor::Factor;
use crate::schema::TermKind;
use crate::tolerance;
use crate::weighed::renew;

/// Largest change of a learned parameter in a step.
const FARTHEST: f64 = 1.0;
/// A step is halved so often until it leads downhill, and so often until equations have a value where it leads.
const HALVINGS: u32 = 8;
const MOST_HALVINGS: u32 = 40;

/// What a step found.
pub(super) struct Found {
    pub(super) next: State,
    /// Half the sum of squares of all rows before the step.
    pub(super) loss: f64,
    /// Largest change of a coefficient or parameter.
    pub(super) change: f64,
    /// Largest change of a learned scalar's parameter that the whole step would make.
    pub(super) ahead: f64,
    /// How far it moved a source, over its size, at most.
    pub(super) moved: f64,
    /// The loss after the step over what noise of inexact measurements leaves of it; nothing where all are exact, or where there
    /// are clouds, whose strays are no noise.
    pub(super) strained: f64,
    /// What the loss is less after the whole step; infinite if only a part of it was taken.
    pub(super) gain: f64,
    pub(super) factor: Factor,
}

impl Solver<'_> {
    /// Half the sum of squares of all rows, robust ones by what they cost.
    pub(super) fn loss(&mut self, state: &State) -> f64 {
        self.set_learned(&state.learned);
        self.find_feet(state);
        let clouds = self.surfaces.iter().filter(|surface| self.is_seen(surface, state.phase));
        let mut sum = clouds.map(|surface| surface.loss(self.sigma(state, surface))).sum::<f64>();
        for (at, group) in self.groups.iter().enumerate() {
            let counts = self.counts(at, state.phase);
            if !is_any(&counts) {
                continue;
            }
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            for (term, loss) in group.schema.terms.iter().zip(self.losses(state, at)) {
                for (row, counts) in counts.iter().enumerate().skip(term.first).take(term.rows) {
                    let there = (0..group.places()).filter(|&place| counts[place]);
                    sum += match term.kind {
                        TermKind::Integral => 0.0,
                        _ => there.map(|place| loss.rho(group.over_tolerance(&found, row, place))).sum::<f64>(),
                    };
                }
            }
            let sums = group.sums(&found, &self.scalars).into_iter().filter(|(row, _)| counts[*row].contains(&true));
            sum += sums.map(|(row, misfit)| 0.5 * (misfit / group.sigma[row]).powi(2)).sum::<f64>();
        }
        let priors = (0..self.priors.len()).flat_map(|head| self.prior_rows(state, head));
        sum + priors.map(|block| 0.5 * block.misfits[0].powi(2)).sum::<f64>()
    }

    /// One step.
    pub(super) fn step(&mut self, state: &State) -> Result<Found, LocalError> {
        let slopes = self.set_learned(&state.learned);
        self.size(state);
        self.set_sigmas(state);
        for at in 0..self.groups.len() {
            let losses = self.losses(state, at);
            self.groups[at].set_losses(losses.into_iter());
        }
        let loss = self.loss(state);
        let rows = self.rows(state, &slopes)?;
        // While equations are loose, they need no source.
        let is_loose = state.phase.has_equations() && state.tolerance > state.strictest;
        let counts = state.phase.has_equations() && !is_loose;
        let unmeasured = if counts { self.count_unmeasured(state, &rows) } else { Unmeasured::default() };
        self.add_all(state, &rows);
        let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
        let (step, shared) = self.normal.step(&factor).ok_or(LocalError::Factorisation)?;
        let tallies =
            self.tallies(state, &rows, (&step, &shared), (&factor, &unmeasured)).ok_or(LocalError::Factorisation)?;
        let (step, mut shared) = self.within_bounds(state, (step, shared));
        // Behind the learned parameters are multipliers of integrals.
        shared.truncate(state.learned.len());
        let mut share = shared.iter().fold(1.0, |share: f64, x| share.min(FARTHEST / x.abs().max(f64::MIN_POSITIVE)));
        let mut next = state.clone();
        next.unmeasured = unmeasured;
        let (mut gain, mut left) = (f64::INFINITY, loss);
        for halvings in 0..MOST_HALVINGS {
            next.theta = state.theta.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            next.learned = state.learned.iter().zip(&shared).map(|(x, s)| x + share * s).collect();
            let after = self.loss(&next);
            let is_less = after <= loss * (1.0 + 1e-9) + 1e-12;
            if after.is_finite() && (is_less || halvings + 1 >= HALVINGS) {
                gain = if halvings == 0 { (loss - after).abs() } else { f64::INFINITY };
                left = after;
                break;
            }
            share *= 0.5;
            // Where no step has a value, none is taken.
            (next.theta, next.learned) = (state.theta.clone(), state.learned.clone());
        }
        let change = step.iter().chain(&shared).fold(0.0, |most: f64, x| most.max((share * x).abs()));
        let ahead = shared.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let judged: Vec<usize> = self.judged(state.phase).into_iter().map(|head| self.roughness[head]).collect();
        let measured = (0..tallies.len()).filter(|class| !self.roughness.contains(class));
        let measured = measured.filter(|&class| state.classes[class].open.is_some()).map(|class| tallies[class].count);
        let measured: f64 = measured.sum();
        let strained = if measured > 0.0 && self.surfaces.is_empty() { left / (0.5 * measured) } else { 0.0 };
        let is_held = |class| match self.roughness.contains(&class) {
            true => is_loose || !judged.contains(&class),
            // A second start keeps to its noise until sources had a chance.
            false => state.phase == Phase::Explain || state.phase == Phase::Regress && state.earlier.is_some(),
        };
        renew(&mut next.classes, &tallies, is_held);
        if state.phase.has_equations() {
            next.tolerance = tolerance::after(state.tolerance, share, state.strictest);
        }
        (next.step, next.since) = (state.step + 1, state.since + 1);
        let moved = self.heads.moved(self.schema(), &state.theta, &next.theta);
        Ok(Found { next, loss, change, ahead, moved, strained, gain, factor })
    }
}
