//! Gauss-Newton: steps that are taken until they change nothing.

use super::normal::factor::Factor;
use super::phase::{CONVEX_STEPS, Phase, WARM_STEPS};
use super::place::{Place, State};
use super::scored::Asked;
use super::solver::{LEAST_DAMPING, Solver};
use super::{LocalError, Stage};
use crate::carrier::Progress;
use crate::facts::Known;
use crate::solve::driver::{Flow, Status, Warning, WarningKind};
use crate::solve::fault::Fault;
use crate::solve::method::FAULTS_IN_A_ROW;
use crate::solve::state;

/// Largest change of a field in one step, in its natural sizes.
const FARTHEST: f64 = 5.0;
/// Time of the error bars, in steps.
pub(super) const BARS: f64 = 2.0;
/// What the score tests of given numbers take, in steps (`scores.rs`).
pub(super) const ASKED: f64 = 1.0;
/// Largest change of a learned scalar's parameter in one step.
const BOLDEST: f64 = 0.5;
/// Relative change of the coefficients at which the answer counts as converged.
const CONVERGED: f64 = 2e-3;
/// Change of the logarithm of the probability, by rows, at which a lattice's answer counts as converged too if learned scalars
/// rest: a pressure that the data hardly determine may wander for long.
const SETTLED: f64 = 2e-4;
/// The same by rows, below which an answer that goes on from the last one has followed its data.
const FOLLOWED: f64 = 0.03;
/// Change of the parameters of learned scalars that rest.
const RESTING: f64 = 1e-3;
/// The same as [`CONVERGED`] on a coarse lattice, whose solution is only where the fine one starts, and after how many steps at least.
const ROUGHLY: f64 = 0.1;
const COARSE_STEPS: u64 = 4;
/// Steps on a coarse lattice at most: what does not settle there may still be where the fine one starts.
const MOST_COARSE: u64 = 20;
/// Most stiffness against a step of every field's coefficient, in tolerances over natural sizes.
const MOST_DAMPING: f64 = 1e4;
/// What damping is multiplied by when a step fails, and divided by when one does not.
const STRONGER: f64 = 10.0;
/// How often larger than the least so far a step may leave the sum of squares: through a narrow valley the way to the minimum
/// leads uphill at first.
const UPHILL: f64 = 2.0;
/// Shares of a step that are tried before it is taken again with more damping.
const SHARES: [f64; 3] = [1.0, 0.25, 0.0625];
/// Share of a step that is tried where the whole led to numbers that are not finite.
const RETREAT: f64 = 0.25;

/// How a run ended.
pub(super) struct End {
    pub(super) state: State,
    pub(super) status: Status,
    pub(super) iterations: u64,
    pub(super) loss: f64,
    /// How far the last step moved a source, over its size, at most.
    pub(super) moved: f64,
    /// What the last step left open; empty if nothing.
    pub(super) warnings: Vec<Warning>,
    /// The last step's factorised matrix.
    pub(super) factor: Option<Factor>,
    /// The state that it is about, where it is of all rows and priors, and hardly damped.
    pub(super) linearised: Option<State>,
    /// Seconds of the longest step.
    pub(super) longest: f64,
    /// The state before the last step, which whoever goes on from it repeats.
    pub(super) checkpoint: state::State,
}

impl End {
    /// Says that there was no time or no step for the fine lattice.
    pub(super) fn stay_coarse(&mut self) {
        if self.status == Status::Converged {
            self.status = Status::Budget;
        }
        let message =
            "nothing was left for the fine lattice: patches have coarse edges; give more --budget or --iterations"
                .into();
        self.warnings.push(Warning { kind: WarningKind::Unresolved, message });
    }
}

impl Solver {
    /// Where a saved run stood on this lattice.
    pub(super) fn restore(&self, saved: &state::State) -> Result<Place, Fault> {
        let mut place = self.first();
        place.restore(saved)?;
        place.skipped = if saved.counter("lattice")? > 0 { CONVEX_STEPS - WARM_STEPS } else { 0 };
        Ok(place)
    }

    /// Repeats steps until they change nothing, or steps or time are spent.
    pub(super) fn run(&mut self, from: Place, coarse: bool, stage: &mut Stage<'_>) -> Result<End, LocalError> {
        let Place { mut state, step: mut iteration, skipped, feet } = from;
        self.set_feet(feet);
        let mut good = self.place(&state, iteration);
        let mut loss = f64::INFINITY;
        let (mut rows, mut moved) = (0, f64::INFINITY);
        let mut status = Status::Budget;
        let mut factor = None;
        let mut is_plain = false;
        let mut faults = Vec::new();
        let mut longest = 0.0f64;
        while factor.is_none() || stage.before + iteration < stage.limits.iterations {
            let began = stage.start.elapsed().as_secs_f64();
            let budget = stage.limits.budget.map_or(f64::INFINITY, |budget| budget.as_secs_f64());
            // What is no solution yet has no error bars; that of a coarse lattice may be the answer.
            let solved = iteration + skipped >= CONVEX_STEPS;
            let wanted = if solved { (1.0 + BARS + ASKED) * longest } else { longest };
            if began + wanted > budget && factor.is_some() {
                break;
            }
            let place = self.place(&state, iteration);
            let (next, found) = match self.step(&state, iteration + skipped, coarse, &[]) {
                Ok(found) => found,
                // The step that led here was too long: it is taken back, and a part of it is tried.
                Err(LocalError::Fault(fault)) if factor.is_some() => {
                    faults.push(fault);
                    is_plain = false;
                    self.set_feet(good.feet.clone());
                    if faults.len() >= FAULTS_IN_A_ROW as usize {
                        (state, status) = (good.state.clone(), Status::NotConverged);
                        break;
                    }
                    state = good.state.towards(&state, RETREAT);
                    continue;
                }
                Err(error) => return Err(error),
            };
            good = place;
            faults.clear();
            let (change, gain) = (self.change(&state, &next), found.gain);
            let before = std::mem::replace(&mut state, next);
            (loss, rows) = (found.loss, found.rows);
            moved = self.heads.moved(self.bound.problem.scene().schema, &before.theta, &state.theta);
            is_plain = found.damping <= LEAST_DAMPING && Phase::of(iteration + skipped, coarse) == Phase::Concave;
            factor = Some(found.factor);
            iteration += 1;
            let elapsed_s = stage.start.elapsed().as_secs_f64();
            longest = longest.max(elapsed_s - began);
            let (steps_before, lattice) = (stage.before, stage.lattice);
            let checkpoint = &|| good.save(steps_before, lattice);
            if (stage.monitor)(Progress { iteration: steps_before + iteration, elapsed_s, loss, checkpoint })
                == Flow::Stop
            {
                status = Status::Interrupted;
                break;
            }
            let (steps, small) = if coarse { (COARSE_STEPS, ROUGHLY) } else { (CONVEX_STEPS + 1, CONVERGED) };
            let resting = learned_change(&before, &state) < RESTING;
            let still = if coarse { 0.5 * SETTLED } else { SETTLED };
            let settled = resting && gain.abs() < still * rows as f64;
            let is_start = coarse && iteration >= MOST_COARSE;
            if is_start || iteration + skipped > steps && (change < small || settled) {
                status = Status::Converged;
                break;
            }
        }
        let mut warnings = self.doubts(loss, rows, iteration + skipped);
        if !warnings.is_empty() && status != Status::Interrupted {
            status = Status::NotConverged;
        }
        let fault = faults.pop().filter(|_| status == Status::NotConverged);
        warnings.extend(fault.map(|fault| Warning { message: fault.to_string(), kind: WarningKind::Fault(fault) }));
        let checkpoint = good.save(stage.before, stage.lattice);
        let linearised = is_plain.then_some(State { noise: state.noise, ..good.state });
        Ok(End {
            state,
            status,
            iterations: stage.before + iteration,
            loss,
            moved,
            warnings,
            factor,
            linearised,
            longest,
            checkpoint,
        })
    }

    /// One step; also what it found on its way. Steps are damped, as Levenberg and Marquardt have it, so that coefficients that
    /// hardly any row sees stay where they are. A step that leads far uphill is shortened, then taken again with more damping.
    /// Some of what is known is asked about on the way.
    pub(super) fn step(
        &mut self,
        state: &State,
        iteration: u64,
        coarse: bool,
        asked: &[Known],
    ) -> Result<(State, Found), LocalError> {
        let regress = iteration == 0;
        self.find_feet(state);
        let noise = if regress { state.noise } else { self.noise(state.used) };
        let across = if regress { state.across } else { self.noise_across(state.used) };
        let phase = Phase::of(iteration, coarse);
        let (loss, rows, probes) = self.assemble(state, noise, phase)?;
        let before = loss + self.penalty(state, noise, phase == Phase::Concave);
        let is_first = regress || Phase::of(iteration - 1, coarse) != phase;
        let lowest = if is_first { before } else { before.min(state.lowest) };
        let fields: Vec<usize> = self.fields().flatten().collect();
        self.normal.set_free(Some(&state.free)).ok_or(LocalError::Memory)?;
        let to_rest = |(free, at): (&bool, &f64)| if *free { 0.0 } else { -at };
        let held: Vec<f64> = state.free.iter().zip(&state.theta).map(to_rest).collect();
        let (mut damping, mut wanted) = (0.0, state.damping);
        let (next, after, factor, told) = loop {
            fields.iter().for_each(|&at| self.normal.add_stiffness(at, wanted - damping));
            damping = wanted;
            let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
            let asked_too = if self.knows_noise() { &[][..] } else { &probes[..] };
            let found = self.normal.step_with(&factor, &held, asked_too).ok_or(LocalError::Factorisation)?;
            let (step, shared, inner) = found;
            let used = if inner.is_empty() { 0.0 } else { mean(&inner) };
            // The model holds no farther than a few natural sizes of the state; the first, of data alone, is exact.
            let largest = fields.iter().map(|&at| step[at].abs()).fold(0.0, f64::max);
            let boldest = shared[..state.learned.len()].iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let all = if regress { 1.0 } else { (FARTHEST / largest).min(BOLDEST / boldest).min(1.0) };
            let calmer = (damping / STRONGER).max(LEAST_DAMPING);
            let told = self.asked_of(asked, &State { noise, ..state.clone() }, &factor);
            let from = State { noise, used, damping: calmer, lowest, ..state.clone() };
            let most = if regress { f64::INFINITY } else { UPHILL * lowest };
            let (mut next, after) = self.shortened(&from, (&step, &shared), all, (phase, most));
            if after <= most || damping >= MOST_DAMPING {
                next.across = across;
                if !regress {
                    next.free = self.free_after(&next, &self.normal.slopes_after(&step, &shared));
                }
                break (next, after, factor, told);
            }
            wanted *= STRONGER;
        };
        Ok((next, Found { loss, gain: before - after, rows, factor, damping, told }))
    }

    /// The state after the longest share of a step that leaves no more than `most` as the sum of squares, or after the shortest;
    /// and that sum.
    fn shortened(
        &mut self,
        from: &State,
        (step, shared): (&[f64], &[f64]),
        all: f64,
        (phase, most): (Phase, f64),
    ) -> (State, f64) {
        let (mut next, mut after) = (from.clone(), f64::INFINITY);
        for share in SHARES.map(|share| share * all) {
            next.theta = from.theta.iter().zip(step).map(|(x, s)| x + share * s).collect();
            next.learned = from.learned.iter().zip(shared).map(|(x, s)| x + share * s).collect();
            after = self.loss(&next, from.noise) + self.penalty(&next, from.noise, phase == Phase::Concave);
            if after <= most {
                break;
            }
        }
        (next, after)
    }

    /// Ranges of the coefficients of fields.
    fn fields(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let heads = self.bound.problem.scene().schema.heads.iter().enumerate().filter(|(_, head)| !head.source);
        heads.map(|(at, _)| self.heads.first[at]..self.heads.first[at + 1])
    }

    /// Largest change of a field's coefficient or a learned parameter; sources may flicker at their edges for long.
    pub(super) fn change(&self, before: &State, after: &State) -> f64 {
        let fields = self.fields().flat_map(|range| range.map(|at| (before.theta[at], after.theta[at])));
        fields.map(|(a, b)| (a - b).abs()).fold(learned_change(before, after), f64::max)
    }
}

/// The loss before a step, from so many rows, what the step gained, the factorised matrix, and what was asked about.
pub(super) struct Found {
    pub(super) loss: f64,
    gain: f64,
    pub(super) rows: usize,
    pub(super) factor: Factor,
    /// Stiffness against the step.
    damping: f64,
    pub(super) told: Vec<Asked>,
}

impl Found {
    /// Whether an answer that goes on from the last one has followed its data: after a leap a step gains more.
    pub(super) fn has_followed(&self) -> bool {
        self.gain.abs() < FOLLOWED * self.rows as f64
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Largest change of a learned scalar's parameter.
fn learned_change(before: &State, after: &State) -> f64 {
    before.learned.iter().zip(&after.learned).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
