//! Steps on one lattice, from a state until nothing changes any more.

use std::time::Instant;

use super::STILL;
use super::proportions::Proportions;
use super::solver::Solver;
use super::state::{Phase, REGRESS, State};
use crate::carrier::Progress;
use crate::local::LocalError;
use crate::local::normal::factor::Factor;
use crate::noise::Noise;
use crate::solve::driver::{Flow, Limits, Status};
use crate::solve::state::State as Saved;
use crate::tolerance::LOOSE;

/// Steps that look for sources under the noise of the regressed data at most.
const EXPLAIN: u64 = 12;
/// Equations are too strict for the cells where all rows are left over by this many times what noise leaves, once sources were looked for.
const UNEXPLAINED: f64 = 4.0;
/// Gain of the logarithm of the evidence that no longer matters.
const RESTING: f64 = 0.05;
/// Share of the loss that a whole step gains where equations that were made strict are not yet met.
const FALLING: f64 = 0.5;
/// Change of a coefficient, in natural sizes, that no longer matters.
const SETTLED: f64 = 1e-3;
/// Gain of a whole step in the logarithm of the probability that no longer matters.
const GAINED: f64 = 1e-2;
/// Steps with all equations at most.
const MOST_STEPS: u64 = 60;

/// What error bars take in the longest steps, and in usual ones, at most.
const BARS: f64 = 8.0;
const USUAL_BARS: f64 = 13.0;

/// When a solver began, and what it may take.
pub(super) struct Clock {
    pub(super) start: Instant,
    pub(super) limits: Limits,
}

impl Clock {
    fn elapsed_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Seconds that are left.
    pub(super) fn left(&self) -> f64 {
        self.limits.budget.map_or(f64::INFINITY, |budget| budget.as_secs_f64() - self.elapsed_s())
    }

    pub(super) fn has_time(&self, seconds: f64) -> bool {
        seconds < self.left()
    }
}

/// Where the steps on a lattice ended.
pub(super) struct Run {
    pub(super) state: State,
    pub(super) loss: f64,
    /// What a whole step would change of a learned scalar's parameter.
    pub(super) ahead: f64,
    /// How far the last step moved a source, over its size, at most.
    pub(super) moved: f64,
    pub(super) factor: Factor,
    pub(super) status: Status,
    /// Seconds of the longest step, and of all.
    pub(super) longest: f64,
    pub(super) seconds: f64,
    /// Seconds that error bars take about.
    pub(super) bars: f64,
    pub(super) checkpoint: Saved,
}

/// Whether cells leave no learned scalar off by much beside its deviation.
pub(super) fn is_still(factor: &Factor, off: &[f64]) -> bool {
    let deviation = |at: usize| factor.learned_variance(at).map_or(0.0, |variance| variance.max(0.0).sqrt());
    off.iter().enumerate().all(|(at, off)| *off <= STILL * deviation(at))
}

impl Run {
    /// Steps from a state, with equations asked at so many points; `kept` seconds of the budget are left for what comes after.
    pub(super) fn go(
        solver: &mut Solver<'_>,
        mut state: State,
        noise: &Noise,
        (points, proportions): (usize, &Proportions),
        clock: &Clock,
        kept: f64,
        monitor: &mut dyn FnMut(Progress<'_>) -> Flow,
    ) -> Result<Self, LocalError> {
        let began = clock.elapsed_s();
        let save = |state: &State| proportions.save(state.save().with_counter("points", points as u64));
        let (mut longest, before) = (0.0_f64, state.step);
        let mut found = None;
        let mut status = loop {
            if found.is_some() && (!clock.has_time(longest + kept) || state.step >= clock.limits.iterations) {
                break Status::Budget;
            }
            let before_s = clock.elapsed_s();
            let step = solver.step(&state)?;
            let elapsed_s = clock.elapsed_s();
            longest = longest.max(elapsed_s - before_s);
            let (before, is_tight) = (state.phase, state.tolerance <= state.strictest);
            state = step.next;
            let gain: f64 = state.classes.iter().map(|class| class.gain).sum();
            let is_resting = gain < RESTING && state.since > 1;
            let is_falling = step.gain.is_finite() && step.gain > FALLING * step.loss;
            let is_ready = match before {
                Phase::Regress => is_resting || state.since >= REGRESS,
                Phase::Explain => (is_tight && is_resting && !is_falling) || state.since >= EXPLAIN,
                Phase::Solve => false,
            };
            if is_ready && before == Phase::Explain && step.strained > UNEXPLAINED && state.strictest < LOOSE {
                solver.loosen(&mut state);
            } else if is_ready {
                (state.phase, state.since) = (before.next(), 0);
                solver.come_back(&mut state);
            }
            found = Some((step.loss, (step.ahead, step.moved), step.factor));
            let checkpoint = &|| save(&state);
            if monitor(Progress { iteration: state.step, elapsed_s, loss: step.loss, checkpoint }) == Flow::Stop {
                break Status::Interrupted;
            }
            let is_settled =
                before == Phase::Solve && is_tight && is_resting && (step.change < SETTLED || step.gain < GAINED);
            match (is_settled, state.since >= MOST_STEPS) {
                (false, false) => {}
                _ if state.convex => (state.convex, state.since) = (false, 0),
                (true, _) => match solver.again(noise, &state) {
                    Some(again) => state = again,
                    None => break Status::Converged,
                },
                (false, true) => break Status::NotConverged,
            }
        };
        let checkpoint = save(&state);
        if let Some(earlier) = solver.earlier(&mut state, status == Status::Converged) {
            let step = solver.step(&earlier)?;
            (state, found) = (earlier, Some((step.loss, (step.ahead, step.moved), step.factor)));
            status = if status == Status::NotConverged { Status::Converged } else { status };
        }
        let (loss, (ahead, moved), factor) = found.ok_or(LocalError::Factorisation)?;
        let seconds = clock.elapsed_s() - began;
        // One step may take far longer than all others.
        let usual = seconds / (state.step - before).max(1) as f64;
        let bars = (BARS * longest).min(USUAL_BARS * usual);
        Ok(Self { state, loss, ahead, moved, factor, status, longest, seconds, bars, checkpoint })
    }
}
