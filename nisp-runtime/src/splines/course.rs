//! Steps until they change nothing, kind of smoothness after kind.

use std::time::{Duration, Instant};

use super::iterate::Phase;
use super::place::Place;
use super::prior::KINDS;
use super::solver::Solver;
use super::step::TOLERANCE;
use crate::carrier::Progress;
use crate::noise::Noise;
use crate::solve::driver::{Flow, Limits, Status};
use crate::solve::fault::Fault;
use crate::solve::state;

/// Steps that regress the data at most.
const REGRESS: u64 = 12;
/// Gain of the logarithm of the evidence that no longer matters.
const RESTING: f64 = 0.05;
/// Change of a coefficient, in natural sizes, that no longer matters.
const SETTLED: f64 = 1e-3;
/// Change of a coefficient that says that steps lead nowhere.
const WANDERING: f64 = 5e-3;
/// Steps of a kind of smoothness at most, and those after which equations that are still loose are left so.
const MOST_STEPS: u64 = 60;
const MOST_LOOSE_STEPS: u64 = 120;
/// Steps for which time is kept while sources may still be rougher in some parts: those of the error bars.
const KEPT: f64 = 8.0;
/// The end of the error bars' steps at the latest, beside the budget.
const LATE: f64 = 1.05;

/// A run under way.
pub(super) struct Run<'m> {
    pub(super) start: Instant,
    pub(super) limits: Limits,
    /// Seconds of the longest step.
    pub(super) longest: f64,
    pub(super) monitor: &'m mut dyn FnMut(Progress<'_>) -> Flow,
    pub(super) loss: f64,
    /// Largest change of a learned scalar's parameter in the last step, had all of it been taken.
    pub(super) ahead: f64,
}

impl Run<'_> {
    /// True where so many more steps end with the budget, or nearly so.
    pub(super) fn has_time_for(&self, steps: usize) -> bool {
        let end = self.start.elapsed().as_secs_f64() + steps as f64 * self.longest;
        steps == 0 || self.limits.budget.is_none_or(|budget| end <= LATE * budget.as_secs_f64())
    }

    /// Lets sources be as rough along the record as answers say, while the evidence grows and there is time.
    pub(super) fn vary(
        &mut self,
        solver: &mut Solver<'_>,
        place: &mut Place,
        save: &dyn Fn(&Place) -> state::State,
    ) -> Result<Flow, Fault> {
        let whole = self.limits;
        let kept = Duration::from_secs_f64(KEPT * self.longest);
        self.limits.budget = whole.budget.map(|budget| budget.saturating_sub(kept));
        let mut flow = Flow::Continue;
        while self.has_time_for(2)
            && place.state.step < self.limits.iterations
            && let Some(tried) = place.next_uneven()
        {
            solver.set_smoothness(KINDS[tried.kind], &tried.state);
            let Some(next) = solver.uneven(&tried.state)? else {
                place.leave_varied();
                continue;
            };
            place.vary(&tried, next);
            match self.go(solver, place, save)? {
                Status::Converged => {}
                Status::Interrupted => {
                    flow = Flow::Stop;
                    break;
                }
                // Another roughness takes too long, or leaves unknowns open: what was found before stands.
                _ => place.drop_round(),
            }
        }
        self.limits = whole;
        Ok(flow)
    }

    /// Lets neighbouring rows share noise, where the evidence grows with it and there is time.
    pub(super) fn correlate(
        &mut self,
        (solver, noise, kinds): (&mut Solver<'_>, &Noise, Vec<usize>),
        place: &mut Place,
        save: &dyn Fn(&Place) -> state::State,
    ) -> Result<Flow, Fault> {
        if place.shared == 0 && self.has_time_for(2) {
            place.shared = 1;
            if let Some(state) = solver.sharing(noise, place)? {
                place.again(state, kinds);
                if self.go(solver, place, save)? == Status::Interrupted {
                    return Ok(Flow::Stop);
                }
                place.kinds.clear();
            }
        }
        if place.shared == 1 && self.has_time_for(2) {
            place.shared = 2;
            if let Some(rough) = place.shares_noise().filter(|_| solver.may_be_smooth()).cloned() {
                place.go_on(&rough, solver.smooth(&rough.state));
                if self.go(solver, place, save)? == Status::Interrupted {
                    return Ok(Flow::Stop);
                }
                place.kinds.clear();
            }
        }
        // A run that went on from a saved state may have come from there.
        while let Some(alike) = place.likeliest_sharing() {
            let likeliest = place.best_of(Some(alike)).cloned();
            if !likeliest.is_some_and(|best| solver.leaves_rhythm(&best.state)) || !place.leave_out(alike) {
                break;
            }
        }
        place.choose_sharing();
        Ok(Flow::Continue)
    }

    /// Takes steps until all kinds of smoothness that are to be tried have been, or steps or time are spent.
    pub(super) fn go(
        &mut self,
        solver: &mut Solver<'_>,
        place: &mut Place,
        save: &dyn Fn(&Place) -> state::State,
    ) -> Result<Status, Fault> {
        let mut taken = 0;
        while let Some(&kind) = place.kinds.first() {
            if place.phase == Phase::Solve {
                solver.set_smoothness(KINDS[kind], &place.state);
            }
            let elapsed = self.start.elapsed().as_secs_f64();
            let spent = self.limits.budget.is_some_and(|b| elapsed + 2.0 * self.longest > b.as_secs_f64());
            if (spent || place.state.step >= self.limits.iterations) && taken > 0 {
                return Ok(Status::Budget);
            }
            let Some(found) = solver.step(&place.state, place.phase)? else { return Ok(Status::NotConverged) };
            self.longest = self.longest.max(self.start.elapsed().as_secs_f64() - elapsed);
            let is_tight = place.state.tolerance <= TOLERANCE;
            place.state = found.next;
            (place.since, taken) = (place.since + 1, taken + 1);
            (self.loss, self.ahead) = (found.loss, found.ahead);
            let moved: f64 = place.state.classes.iter().map(|class| class.gain).sum();
            let resting = moved < RESTING && place.since > 1;
            match place.phase {
                Phase::Regress if resting || place.since >= REGRESS => {
                    (place.phase, place.since) = (Phase::Solve, 0);
                    solver.come_back(&mut place.state);
                }
                Phase::Solve
                    if is_tight && (resting && found.change < SETTLED || place.since >= MOST_STEPS)
                        || place.since >= MOST_LOOSE_STEPS =>
                {
                    place.since = 0;
                    if place.state.convex {
                        place.state.convex = false;
                    } else if place.state.held {
                        place.state.held = false;
                    } else {
                        // An iterate that wanders about has no evidence.
                        place.next(if found.change < WANDERING {
                            found.evidence - place.state.doubt
                        } else {
                            f64::MIN
                        });
                        if let Some(&kind) = place.kinds.first() {
                            solver.change_smoothness(KINDS[kind], &mut place.state);
                        }
                    }
                }
                _ => {}
            }
            let elapsed_s = self.start.elapsed().as_secs_f64();
            let checkpoint = &|| save(place);
            let progress = Progress { iteration: place.state.step, elapsed_s, loss: self.loss, checkpoint };
            if (self.monitor)(progress) == Flow::Stop {
                return Ok(Status::Interrupted);
            }
        }
        Ok(Status::Converged)
    }
}
