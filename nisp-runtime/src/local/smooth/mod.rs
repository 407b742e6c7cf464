//! Local functions for measured fields and smooth sources, over two coordinates or more.
//!
//! Fields and sources are splines on one lattice of cells, as fine as the points of the equations can tell. Equations hold at
//! their points, to a tolerance that falls from step to step; all unknowns are found together by Gauss-Newton steps on sparse
//! normal equations. The size of the noise, and how much every source bends, are those with the largest evidence (MacKay 1992).

mod between;
mod bounded;
mod judged;
mod meshes;
mod prior;
mod solver;
mod starts;
mod state;
mod step;
mod told;

use std::time::Instant;

use super::{KeptLattices, LocalError, LocalSolution};
use crate::bounds;
use crate::carrier::Progress;
use crate::local::draws::Deviations;
use crate::local::lattice::MOST_COORDINATES;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Flow, Limits, Status, Warning, WarningKind};
use crate::solve::state::State as Saved;

use solver::{Solver, groups};
use state::{Phase, State};

/// Name of the method in saved states.
pub(crate) const METHOD: &str = "splines on a lattice";

/// Steps that regress the data at most.
const REGRESS: u64 = 6;
/// Steps that look for sources under the noise of the regressed data at most.
const EXPLAIN: u64 = 12;
/// Gain of the logarithm of the evidence that no longer matters.
const RESTING: f64 = 0.05;
/// Change of a coefficient, in natural sizes, or gain of a whole step in the logarithm of the probability, that no longer matters.
const SETTLED: f64 = 1e-3;
/// Steps with all equations at most.
const MOST_STEPS: u64 = 60;
/// What error bars take, in steps.
const BARS: f64 = 1.0 + judged::DOUBTS as f64;

/// What splines on a lattice cannot do, of a scene; nothing if they can do all of it.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    let terms = || schema.groups.iter().flat_map(|group| group.terms);
    let heads = || 0..schema.heads.len();
    let refused = [
        (schema.coordinates.len() < 2, "one coordinate"),
        (schema.coordinates.len() > MOST_COORDINATES, "more than four coordinates"),
        (schema.groups.iter().any(|group| group.paired), "paired points"),
        (terms().any(|term| matches!(term.kind, TermKind::Integral)), "integrals"),
        (terms().any(|term| matches!(term.kind, TermKind::Chamfer { .. })), "clouds"),
        (heads().any(|head| meshes::degree(schema, head).is_none()), "derivatives of such an order"),
    ];
    refused.into_iter().find(|(is_so, _)| *is_so).map(|(_, what)| what).or_else(|| bounds::refused(schema))
}

/// Solves a bound problem within its limits, from the start or from a saved state.
pub(crate) fn solve(
    bound: &Bound,
    noise: &Noise,
    limits: Limits,
    from: Option<&Saved>,
    monitor: &mut dyn FnMut(Progress<'_>) -> Flow,
) -> Result<LocalSolution, LocalError> {
    let start = Instant::now();
    let filled = between::filled(bound);
    let mut solver = Solver::new(filled.as_ref().unwrap_or(bound), noise)?;
    let mut state = solver.first(noise);
    if let Some(saved) = from {
        state.restore(saved).map_err(LocalError::Fault)?;
    }
    let mut longest = 0.0_f64;
    let (mut loss, mut ahead, mut factor) = (f64::INFINITY, f64::INFINITY, None);
    let has_time = |seconds: f64| {
        limits.budget.is_none_or(|budget| start.elapsed().as_secs_f64() + seconds < budget.as_secs_f64())
    };
    let mut status = loop {
        if factor.is_some() && (!has_time(longest) || state.step >= limits.iterations) {
            break Status::Budget;
        }
        let began = start.elapsed().as_secs_f64();
        let found = solver.step(&state)?;
        longest = longest.max(start.elapsed().as_secs_f64() - began);
        let (before, is_tight) = (state.phase, state.tolerance <= solver.tolerance);
        (state, loss, ahead, factor) = (found.next, found.loss, found.ahead, Some(found.factor));
        let gain: f64 = state.classes.iter().map(|class| class.gain).sum();
        let is_resting = gain < RESTING && state.since > 1;
        let is_ready = match before {
            Phase::Regress => is_resting || state.since >= REGRESS,
            Phase::Explain => (is_tight && is_resting) || state.since >= EXPLAIN,
            Phase::Solve => false,
        };
        if is_ready {
            (state.phase, state.since) = (before.next(), 0);
        }
        let elapsed_s = start.elapsed().as_secs_f64();
        let checkpoint = &|| state.save();
        if monitor(Progress { iteration: state.step, elapsed_s, loss, checkpoint }) == Flow::Stop {
            break Status::Interrupted;
        }
        let is_settled =
            before == Phase::Solve && is_tight && is_resting && (found.change < SETTLED || found.gain < SETTLED);
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
    let checkpoint = state.save();
    if let Some(earlier) = solver.earlier(&mut state, status == Status::Converged) {
        let found = solver.step(&earlier)?;
        (state, loss, ahead, factor) = (earlier, found.loss, found.ahead, Some(found.factor));
        status = if status == Status::NotConverged { Status::Converged } else { status };
    }
    let mut warnings = Vec::new();
    let wants_bars = status == Status::Converged && noise.is_there(bound.problem.scene().schema);
    let deviations = if !wants_bars {
        Deviations::default()
    } else if has_time(BARS * longest) {
        solver.doubted(&state).unwrap_or_default()
    } else {
        let message = "no time was left for error bars; give a larger budget".into();
        warnings.push(Warning { kind: WarningKind::OutOfTime, message });
        Deviations::default()
    };
    if filled.is_some() {
        solver.groups = groups(bound, &solver.heads);
    }
    let (mut answer, misfits) = (solver.answer(&state), solver.misfits(&state));
    answer.ahead = (status != Status::Converged).then_some(ahead);
    if status == Status::NotConverged {
        let message = "the data and the equations leave some of the unknowns open: give more conditions or data".into();
        warnings.push(Warning { kind: WarningKind::Undetermined, message });
    }
    let State { theta, learned, step: iterations, .. } = state;
    let kept = KeptLattices { heads: solver.heads, theta, learned, draws: deviations };
    answer.told = told::told(bound, &kept);
    let factor = factor.filter(|_| wants_bars);
    Ok(LocalSolution { kept, status, iterations, loss, warnings, factor, checkpoint, answer, misfits })
}
