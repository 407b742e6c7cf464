//! Splines over one coordinate: a carrier for records and for equations on a line.
//!
//! A network is one smooth function of few parameters; a record with many periods has more to say than it can hold. Here every
//! head is a sum of B-splines with a breakpoint at every measurement. Equations are asked to hold at as many places as their
//! residual has freedom, all unknowns are found together by Gauss-Newton steps on a banded triangle, and time and memory are
//! linear in the measurements. The size of the noise, and the size and roughness of every source, are those with the largest
//! evidence (MacKay 1992), and so is the kind of smoothness.

mod basis;
mod cells;
mod group;
mod heads;
mod kept;
pub mod live;
mod prior;
mod resolved;
mod rows;
mod solver;
mod triangle;
pub(crate) mod weighed;

use std::time::Instant;

use thiserror::Error;

use crate::carrier::Progress;
use crate::facts::Answer;
use crate::memory::{self, Exceeded};
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Flow, Limits, Status, Warning, WarningKind};
use crate::solve::fault::Fault;
use crate::solve::state;

use kept::Spread;
use prior::KINDS;
pub(crate) use triangle::Triangle;

use solver::{Phase, Solver, State, TOLERANCE};

/// Logarithm of the evidence by which a kind of smoothness may fall behind and still count.
const NEAR: f64 = 8.0;
/// How far differences of the evidence are trusted: all kinds are approximations of what the source is like.
const TRUST: f64 = 0.3;
/// Coefficients up to which it is looked for what is open.
const MANY: usize = 20_000;
/// Steps that regress the data at most.
const REGRESS: u64 = 12;
/// Gain of the logarithm of the evidence that no longer matters.
const RESTING: f64 = 0.05;
/// Change of a coefficient, in natural sizes, that no longer matters.
const SETTLED: f64 = 1e-3;
/// Change of a coefficient that says that steps lead nowhere.
const WANDERING: f64 = 5e-3;
/// Steps of a kind of smoothness at most.
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
    /// What is open is read from here.
    pub(crate) roots: Vec<Root>,
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

/// A square root of the inverse of the coefficients' covariance: of the whole problem, or without a condition.
pub(crate) struct Root {
    /// Group and term of the condition.
    pub(crate) without: Option<(usize, usize)>,
    pub(crate) triangle: Triangle,
}

/// Where a run stands: which kind of smoothness is tried, from which iterate, and what came of those before.
#[derive(Clone)]
struct Place {
    /// Indices in [`KINDS`] of those that are still to be tried, the present one first.
    kinds: Vec<usize>,
    phase: Phase,
    /// Steps of the phase.
    since: u64,
    state: State,
    tried: Vec<Tried>,
}

/// A kind of smoothness that was tried: its index, its evidence and its iterate.
#[derive(Clone)]
struct Tried {
    kind: usize,
    evidence: f64,
    state: State,
}

/// Solves a bound problem within its limits, from the start or from a saved state. Conditions, by group and term, are those that
/// might be left out.
pub(crate) fn solve(
    bound: &Bound,
    noise: &Noise,
    conditions: &[(usize, usize)],
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
    let mut place = Place::first(solver.first(noise), kinds(solver.has_sources(), cells::stretches(bound)));
    let mut run = Run { start, limits, longest: 0.0, monitor, loss: f64::INFINITY };
    let begun = |saved: &&state::State| saved.indices("kinds").is_ok();
    match (from.filter(begun), cells::middle(bound, &breakpoints)) {
        (Some(saved), _) => place.restore(saved)?,
        // A part of a long record says how smooth the sources are, and how large the noise is.
        (None, Some(middle)) => {
            let part = cells::part(bound, middle);
            let mut solver = Solver::over(&part, middle);
            let mut trial = Place::first(solver.first(noise), kinds(solver.has_sources(), false));
            // A run that ends here begins anew.
            let save = |place: &Place| state::State::new(METHOD).with_counter("iterations", place.state.step);
            if run.go(&mut solver, &mut trial, &save)? == Status::Converged
                && let Some(Tried { kind, state, .. }) = trial.best().cloned()
            {
                place.kinds = vec![kind];
                place.state.classes = state.classes;
                place.state.step = trial.state.step;
            }
        }
        (None, None) => {}
    }
    let mut status = run.go(&mut solver, &mut place, &Place::save)?;
    let loss = run.loss;
    let checkpoint = place.save();
    let mut warnings = Vec::new();
    if let Some(Tried { state, .. }) = place.best().cloned() {
        place.state = State { step: place.state.step, ..state };
    }
    let mut spreads = Vec::new();
    let mut roots = Vec::new();
    // Only a minimum has error bars.
    let likely = if status == Status::Converged && noise.is_there(schema) { place.likely() } else { Vec::new() };
    if run.has_time_for(likely.len()) {
        for (share, Tried { kind, state, .. }) in likely {
            solver.set_smoothness(KINDS[kind]);
            match solver.doubted(state)? {
                Some((State { theta, learned, .. }, found)) => {
                    spreads.push(Spread { share, theta, learned, covariance: found.covariance })
                }
                None => status = Status::NotConverged,
            }
        }
    } else {
        let message = "no time was left for error bars; give a larger budget".into();
        warnings.push(Warning { kind: WarningKind::OutOfTime, message });
    }
    if status == Status::Converged
        && solver.heads.len() <= MANY
        && let Some(best) = place.best()
    {
        solver.set_smoothness(KINDS[best.kind]);
        for without in std::iter::once(None).chain(conditions.iter().copied().map(Some)) {
            let triangle = if run.has_time_for(1) { solver.root(&place.state, without)? } else { None };
            roots.extend(triangle.map(|triangle| Root { without, triangle }));
        }
    }
    if status == Status::NotConverged {
        let message = "the data and the equations leave some of the unknowns open: give more conditions or data".into();
        warnings.push(Warning { kind: WarningKind::Undetermined, message });
    }
    let scalars = solver.scalars(&place.state.learned).to_vec();
    let misfits = solver.misfits(&place.state);
    let State { theta, learned, step: iterations, .. } = place.state;
    let (heads, facts) = solver.into_facts(&breakpoints, &theta);
    let kept = KeptSplines { heads, theta, learned, spreads };
    let told = kept.told(schema);
    let answer = Answer { facts, clouds: Vec::new(), scalars, scores: Vec::new(), told };
    Ok(SplineSolution { kept, roots, status, iterations, loss, warnings, checkpoint, answer, misfits })
}

/// Kinds of smoothness that are tried.
fn kinds(has_sources: bool, stretches: bool) -> Vec<usize> {
    match (has_sources, stretches) {
        (false, _) => vec![0],
        (true, false) => (0..KINDS.len()).filter(|&kind| !KINDS[kind].stretched).collect(),
        (true, true) => (0..KINDS.len()).collect(),
    }
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

    /// Takes steps until all kinds of smoothness that are to be tried have been, or steps or time are spent.
    fn go(
        &mut self,
        solver: &mut Solver<'_>,
        place: &mut Place,
        save: &dyn Fn(&Place) -> state::State,
    ) -> Result<Status, Fault> {
        let mut taken = 0;
        while let Some(&kind) = place.kinds.first() {
            if place.phase == Phase::Solve {
                solver.set_smoothness(KINDS[kind]);
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
            self.loss = found.loss;
            let moved: f64 = place.state.classes.iter().map(|class| class.gain).sum();
            let resting = moved < RESTING && place.since > 1;
            match place.phase {
                Phase::Regress if resting || place.since >= REGRESS => {
                    (place.phase, place.since) = (Phase::Solve, 0);
                }
                Phase::Solve if is_tight && (resting && found.change < SETTLED || place.since >= MOST_STEPS) => {
                    place.since = 0;
                    // An iterate that wanders about has no evidence.
                    place.next(if found.change < WANDERING { found.evidence } else { f64::MIN });
                    if let Some(&kind) = place.kinds.first() {
                        solver.change_smoothness(KINDS[kind], &mut place.state);
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

impl Place {
    /// The start.
    fn first(state: State, kinds: Vec<usize>) -> Self {
        Self { kinds, phase: Phase::Regress, since: 0, state, tried: Vec::new() }
    }

    /// Keeps the iterate, and turns to the next kind. A time that the evidence rules out is not tried with other orders.
    fn next(&mut self, evidence: f64) {
        let kind = self.kinds.remove(0);
        self.tried.push(Tried { kind, evidence, state: self.state.clone() });
        let most = |kinds: &mut dyn Iterator<Item = &Tried>| kinds.map(|tried| tried.evidence).fold(f64::NAN, f64::max);
        let best = most(&mut self.tried.iter());
        let along =
            [false, true].map(|time| most(&mut self.tried.iter().filter(|tried| KINDS[tried.kind].stretched == time)));
        // Of a time that has not been tried nothing is known.
        self.kinds.retain(|&kind| {
            let own = along[usize::from(KINDS[kind].stretched)];
            own.is_nan() || own >= best - NEAR
        });
    }

    /// The kind with the largest evidence.
    fn best(&self) -> Option<&Tried> {
        self.tried.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    /// Kinds that the evidence does not rule out, with their shares of it.
    fn likely(&self) -> Vec<(f64, Tried)> {
        let Some(best) = self.best() else { return Vec::new() };
        let near = || self.tried.iter().filter(|tried| tried.evidence >= best.evidence - NEAR);
        let weight = |tried: &Tried| (TRUST * (tried.evidence - best.evidence)).exp();
        let all: f64 = near().map(weight).sum();
        near().map(|tried| (weight(tried) / all, tried.clone())).collect()
    }

    fn save(&self) -> state::State {
        let saved = self.state.save(state::State::new(METHOD), "");
        let kinds: Vec<f64> = self.kinds.iter().map(|&kind| kind as f64).collect();
        let saved = saved
            .with("kinds", &kinds)
            .with_counter("phase", u64::from(self.phase == Phase::Solve))
            .with_counter("since", self.since)
            .with_counter("iterations", self.state.step)
            .with_counter("tried", self.tried.len() as u64);
        self.tried.iter().enumerate().fold(saved, |saved, (at, Tried { kind, evidence, state })| {
            let prefix = format!("tried {at} ");
            let saved = saved.with(&format!("{prefix}evidence"), &[*evidence]);
            state.save(saved.with_counter(&format!("{prefix}kind"), *kind as u64), &prefix)
        })
    }

    fn restore(&mut self, saved: &state::State) -> Result<(), Fault> {
        saved.check_method(METHOD)?;
        let known = |kind: &usize| *kind < KINDS.len();
        self.kinds = saved.indices("kinds")?;
        if !self.kinds.iter().all(known) {
            return Err(Fault::state("kinds"));
        }
        for at in 0..saved.counter("tried")? {
            let prefix = format!("tried {at} ");
            let mut state = self.state.clone();
            state.restore(saved, &prefix)?;
            let [evidence] = saved.scalars(&format!("{prefix}evidence"))?;
            let kind = saved.counter(&format!("{prefix}kind"))? as usize;
            self.tried.push(Tried {
                kind: Some(kind).filter(known).ok_or_else(|| Fault::state("kind"))?,
                evidence,
                state,
            });
        }
        self.state.restore(saved, "")?;
        self.since = saved.counter("since")?;
        self.phase = if saved.counter("phase")? == 1 { Phase::Solve } else { Phase::Regress };
        Ok(())
    }
}
