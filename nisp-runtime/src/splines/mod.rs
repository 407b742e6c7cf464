//! Splines over one coordinate: a carrier for records and for equations on a line.
//!
//! A network is one smooth function of few parameters; a record with many periods has more to say than it can hold. Here every
//! head is a sum of B-splines with a breakpoint at every measurement. Equations are asked to hold at as many places as their
//! residual has freedom, all unknowns are found together by Gauss-Newton steps on a banded triangle, and time and memory are
//! linear in the measurements. The size of the noise and the roughness of every source are those with the largest evidence
//! (MacKay 1992), and so is the order of the source's derivative that is kept small.

mod basis;
mod cells;
mod group;
mod heads;
mod kept;
pub mod live;
mod resolved;
mod rows;
mod solver;
mod triangle;
mod weighed;

use std::time::Instant;

use thiserror::Error;

use crate::facts::Answer;
use crate::memory::{self, Exceeded};
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Flow, Limits, Status, Warning, WarningKind};
use crate::solve::fault::Fault;
use crate::solve::state;

use kept::Spread;
use solver::{Phase, Solver, State, TOLERANCE};
use weighed::{Class, restore_classes, save_classes};

/// Orders of a source's derivative that may be the one that is kept small, the first tried first.
const ORDERS: [usize; 3] = [2, 1, 3];
/// Logarithm of the evidence by which an order may fall behind and still be the right one.
const NEAR: f64 = 8.0;
/// Steps that regress the data at most.
const REGRESS: u64 = 12;
/// Gain of the logarithm of the evidence that no longer matters.
const RESTING: f64 = 0.02;
/// Change of a coefficient, in natural sizes, that no longer matters.
const SETTLED: f64 = 1e-4;
/// Steps of an order at most.
const MOST_STEPS: u64 = 60;
/// The end of the error bars' steps at the latest, beside the budget.
const LATE: f64 = 1.05;
/// Name of the method in saved states.
pub(crate) const METHOD: &str = "splines";

pub(crate) use kept::{CARRIER, KeptSplines};

/// What splines over one coordinate cannot do, of a scene; nothing if they can do all of it.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    let terms = || schema.groups.iter().flat_map(|group| group.terms);
    let refused = [
        (schema.coordinates.len() != 1, "more than one coordinate"),
        (schema.groups.iter().any(|group| group.paired), "paired points"),
        (schema.heads.iter().any(|head| head.hard || head.transformed), "bounded heads or hard conditions"),
        (terms().any(|term| matches!(term.kind, TermKind::Integral)), "integrals"),
        (terms().any(|term| matches!(term.kind, TermKind::Chamfer { .. })), "clouds"),
        (cells::degrees(schema).is_none(), "derivatives of such an order"),
    ];
    refused.into_iter().find(|(is_so, _)| *is_so).map(|(_, what)| what)
}

/// Why splines cannot solve a problem.
#[derive(Debug, Error)]
pub(crate) enum SplineError {
    /// Something that cannot be evaluated, or a state that does not fit.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// Too many rows for the memory.
    #[error(transparent)]
    Memory(#[from] Exceeded),
}

/// A problem solved by splines.
pub(crate) struct SplineSolution {
    pub(crate) kept: KeptSplines,
    pub(crate) status: Status,
    pub(crate) iterations: u64,
    pub(crate) loss: f64,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) checkpoint: state::State,
    /// What the verdict is made from.
    pub(crate) answer: Answer,
    /// By group and term: how far rows are off, and the noise that the evidence found.
    pub(crate) misfits: Vec<Vec<(Vec<f64>, Option<f64>)>>,
}

/// What the caller sees after every step.
pub(crate) struct Progress<'a> {
    pub(crate) iteration: u64,
    pub(crate) elapsed_s: f64,
    pub(crate) loss: f64,
    pub(crate) checkpoint: &'a dyn Fn() -> state::State,
}

/// Where a run stands: which order is tried, from which iterate, and the best order so far.
#[derive(Clone)]
struct Place {
    /// Index in [`ORDERS`].
    order: usize,
    /// Index of the order after the last that is to be tried.
    orders: usize,
    phase: Phase,
    /// Steps of the phase.
    since: u64,
    state: State,
    /// Sizes of all classes when an order's data have been regressed, and when its equations come in.
    regressed: Vec<Class>,
    solved: Vec<Class>,
    /// Of every order that was tried: its index, its evidence and its iterate.
    tried: Vec<(usize, f64, State)>,
}

/// Solves a bound problem within its limits, from the start or from a saved state.
pub(crate) fn solve(
    bound: &Bound,
    noise: &Noise,
    limits: Limits,
    from: Option<&state::State>,
    monitor: &mut dyn FnMut(Progress<'_>) -> Flow,
) -> Result<SplineSolution, SplineError> {
    let start = Instant::now();
    let breakpoints = cells::breakpoints(bound, noise);
    let rows = bound.coordinates.iter().map(Vec::len).max().unwrap_or(0);
    let what = || format!("splines over {} cells, for {rows} rows,", breakpoints.len() - 1);
    memory::require(Solver::bytes(bound, &breakpoints), what, "give a part of the record, or fewer rows of it")?;
    let mut solver = Solver::over(bound, &breakpoints);
    let schema = bound.problem.scene().schema;
    let mut place = Place::first(solver.first(noise), solver.has_sources());
    let mut run = Run { start, limits, longest: 0.0, monitor, loss: f64::INFINITY };
    let begun = |saved: &&state::State| saved.counter("orders").is_ok();
    match (from.filter(begun), cells::middle(bound, &breakpoints)) {
        (Some(saved), _) => place.restore(saved)?,
        // A part of a long record says how smooth the sources are, and how large the noise is.
        (None, Some(middle)) => {
            let part = cells::part(bound, middle);
            let mut solver = Solver::over(&part, middle);
            let mut trial = Place::first(solver.first(noise), solver.has_sources());
            // A run that ends here begins anew.
            let save = |place: &Place| state::State::new(METHOD).with_counter("iterations", place.state.step);
            if run.go(&mut solver, &mut trial, &save)? == Status::Converged
                && let Some((order, _, state)) = trial.best().cloned()
            {
                (place.order, place.orders) = (order, order + 1);
                (place.state.classes, place.solved) = (trial.regressed, state.classes);
                place.state.step = trial.state.step;
            }
        }
        (None, None) => {}
    }
    let mut status = run.go(&mut solver, &mut place, &Place::save)?;
    let loss = run.loss;
    let checkpoint = place.save();
    let mut warnings = Vec::new();
    if let Some((_, _, state)) = place.best().cloned() {
        place.state = State { step: place.state.step, ..state };
    }
    let mut spreads = Vec::new();
    // Only a minimum has error bars.
    let likely = if status == Status::Converged && noise.is_there(schema) { place.likely() } else { Vec::new() };
    if run.has_time_for(likely.len()) {
        for (order, mut state) in likely {
            solver.order = ORDERS[order];
            solver.doubt_roughness(&mut state);
            match solver.step(&state, Phase::Solve)? {
                Some(found) => {
                    spreads.push(Spread { theta: state.theta, learned: state.learned, covariance: found.covariance })
                }
                None => status = Status::NotConverged,
            }
        }
    } else {
        let message = "no time was left for error bars; give a larger budget".into();
        warnings.push(Warning { kind: WarningKind::OutOfTime, message });
    }
    if status == Status::NotConverged {
        let message = "the data and the equations leave some of the unknowns open: give more conditions or data".into();
        warnings.push(Warning { kind: WarningKind::Undetermined, message });
    }
    let scalars = solver.scalars(&place.state.learned).to_vec();
    let misfits = solver.misfits(&place.state);
    let State { theta, learned, step: iterations, .. } = place.state;
    let (heads, facts) = solver.into_facts(&breakpoints, &theta);
    let answer = Answer { facts, clouds: Vec::new(), scalars };
    Ok(SplineSolution {
        kept: KeptSplines { heads, theta, learned, spreads },
        status,
        iterations,
        loss,
        warnings,
        checkpoint,
        answer,
        misfits,
    })
}

/// Share of the data's spread that a description of them may be off.
const ROUGHLY: f64 = 0.02;

/// How many numbers it takes to describe the richest of the observed quantities to within its noise, or to a fiftieth of its
/// spread. A wave takes two a period, and more where it is noisy.
pub(crate) fn richness(bound: &Bound, noise: &Noise) -> f64 {
    let breakpoints = cells::all_breakpoints(bound);
    let middle = cells::middle(bound, &breakpoints);
    let part = middle.map(|middle| cells::part(bound, middle));
    let mut solver = Solver::over(part.as_ref().unwrap_or(bound), middle.unwrap_or(&breakpoints));
    let mut state = solver.first(noise);
    solver.hold_noise(&mut state, noise, ROUGHLY);
    let mut used = 0.0;
    for _ in 0..REGRESS {
        let Ok(Some(found)) = solver.step(&state, Phase::Regress) else { break };
        (used, state) = (found.used, found.next);
    }
    let rows = |bound: &Bound| bound.coordinates.iter().map(Vec::len).max().unwrap_or(0) as f64;
    used * rows(bound) / rows(part.as_ref().unwrap_or(bound)).max(1.0)
}

/// A run under way.
struct Run<'m> {
    start: Instant,
    limits: Limits,
    /// Seconds of the longest step.
    longest: f64,
    monitor: &'m mut dyn FnMut(Progress<'_>) -> Flow,
    loss: f64,
}

impl Run<'_> {
    /// True where so many more steps end with the budget, or nearly so.
    fn has_time_for(&self, steps: usize) -> bool {
        let end = self.start.elapsed().as_secs_f64() + steps as f64 * self.longest;
        steps == 0 || self.limits.budget.is_none_or(|budget| end <= LATE * budget.as_secs_f64())
    }

    /// Takes steps until all orders that are to be tried have been, or steps or time are spent.
    fn go(
        &mut self,
        solver: &mut Solver<'_>,
        place: &mut Place,
        save: &dyn Fn(&Place) -> state::State,
    ) -> Result<Status, Fault> {
        let mut taken = 0;
        while place.order < place.orders {
            solver.order = ORDERS[place.order];
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
            self.loss = found.loss;
            let moved: f64 = place.state.classes.iter().map(|class| class.gain).sum();
            let resting = moved < RESTING && place.since > 1;
            match place.phase {
                Phase::Regress if resting || place.since >= REGRESS => {
                    (place.phase, place.since) = (Phase::Solve, 0);
                    place.regressed.clone_from(&place.state.classes);
                    place.state.take_roughness(solver, &place.solved);
                }
                Phase::Solve if is_tight && (resting && found.change < SETTLED || place.since >= MOST_STEPS) => {
                    place.since = 0;
                    place.next(found.evidence);
                    place.state.take_roughness(solver, &place.solved);
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

impl Place {
    /// The start; without sources, orders make no difference.
    fn first(state: State, has_sources: bool) -> Self {
        let orders = if has_sources { ORDERS.len() } else { 1 };
        let classes = state.classes.clone();
        Self {
            order: 0,
            orders,
            phase: Phase::Regress,
            since: 0,
            state,
            regressed: classes.clone(),
            solved: classes,
            tried: Vec::new(),
        }
    }

    /// Keeps the iterate, and turns to the next order.
    fn next(&mut self, evidence: f64) {
        self.tried.push((self.order, evidence, self.state.clone()));
        self.order += 1;
    }

    /// The order with the largest evidence.
    fn best(&self) -> Option<&(usize, f64, State)> {
        self.tried.iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Orders that the evidence does not rule out; the last iterate where none has been tried to its end.
    fn likely(&self) -> Vec<(usize, State)> {
        let Some(best) = self.best() else { return vec![(self.order.min(ORDERS.len() - 1), self.state.clone())] };
        let near = self.tried.iter().filter(|tried| tried.1 >= best.1 - NEAR);
        near.map(|(order, _, state)| (*order, state.clone())).collect()
    }

    fn save(&self) -> state::State {
        let saved = self.state.save(state::State::new(METHOD), "");
        let saved = saved
            .with_counter("order", self.order as u64)
            .with_counter("orders", self.orders as u64)
            .with_counter("phase", u64::from(self.phase == Phase::Solve))
            .with_counter("since", self.since)
            .with_counter("iterations", self.state.step)
            .with_counter("tried", self.tried.len() as u64);
        let saved = save_classes(&self.solved, save_classes(&self.regressed, saved, "regressed "), "solved ");
        self.tried.iter().enumerate().fold(saved, |saved, (at, (order, evidence, state))| {
            let prefix = format!("tried {at} ");
            let saved = saved.with(&format!("{prefix}evidence"), &[*evidence]);
            state.save(saved.with_counter(&format!("{prefix}order"), *order as u64), &prefix)
        })
    }

    fn restore(&mut self, saved: &state::State) -> Result<(), Fault> {
        saved.check_method(METHOD)?;
        let order = |name: &str| match saved.counter(name)? as usize {
            order if order <= ORDERS.len() => Ok(order),
            _ => Err(Fault::state(name)),
        };
        for at in 0..order("tried")? {
            let prefix = format!("tried {at} ");
            let mut state = self.state.clone();
            state.restore(saved, &prefix)?;
            let [evidence] = saved.scalars(&format!("{prefix}evidence"))?;
            self.tried.push((order(&format!("{prefix}order"))?.min(ORDERS.len() - 1), evidence, state));
        }
        self.state.restore(saved, "")?;
        self.since = saved.counter("since")?;
        restore_classes(&mut self.regressed, saved, "regressed ")?;
        restore_classes(&mut self.solved, saved, "solved ")?;
        (self.order, self.orders) = (order("order")?, order("orders")?);
        self.phase = if saved.counter("phase")? == 1 { Phase::Solve } else { Phase::Regress };
        Ok(())
    }
}
