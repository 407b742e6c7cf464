//! Local functions for measured fields and smooth sources, over two coordinates or more, and for curves that a cloud shows.
//!
//! Fields and sources are splines on one lattice of cells, as fine as the points of the equations can tell. Equations hold at
//! their points, to a tolerance that falls from step to step; all unknowns are found together by Gauss-Newton steps on sparse
//! normal equations. The size of the noise, and how much every source bends, are those with the largest evidence (MacKay 1992).

mod belief;
mod between;
mod bounded;
mod changes;
mod clashes;
mod crossings;
mod divisors;
mod domain;
mod edges;
mod equations;
mod finish;
mod freedom;
mod judged;
mod leaning;
mod levels;
mod means;
mod meshes;
mod places;
mod prior;
mod proportions;
mod quadrature;
mod rows;
mod run;
mod sampled;
mod scores;
mod shares;
mod short;
mod singular;
mod solver;
mod starts;
mod state;
mod step;
mod tallies;
mod told;
mod undetermined;
mod unmeasured;
mod unsure;

use std::time::Instant;

use between::measurements;
pub(crate) use between::others;
use changes::Changes;
use clashes::Clashes;
use finish::finish;
use judged::{FAR, MISSED};
use means::Asked;
use proportions::Proportions;

use super::{LocalError, LocalSolution, refuse};
use crate::bounds;
use crate::carrier::Progress;
use crate::local::lattice::MOST_COORDINATES;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Flow, Limits, Status};
use crate::solve::fault::Fault;
use crate::solve::state::State as Saved;

use run::{Clock, Run, is_still};
use solver::Solver;
use state::State;

/// Name of the method in saved states.
pub(crate) const METHOD: &str = "splines on a lattice";

/// Points of the largest equation on a finer lattice, beside those on the one before.
const MORE: usize = 2;
/// A finer lattice that leaves more of the strain than this does not help.
const EASED: f64 = 0.9;
/// Finer lattices that may not help, one after the other, where measurements are missed by far.
const PATIENCE: usize = 2;
/// Strain below which one lattice is enough for an answer to exact measurements.
const EXACT: f64 = 0.01;
/// Change of sources, fields and learned scalars from a lattice to a finer one, as a share, below which they are the same.
const SAME: f64 = 0.01;
/// Deviations by which a lattice may leave a learned scalar off.
const STILL: f64 = 0.5;
/// How far the cells of a lattice may hold back an answer for which nothing was measured, as a share of its range: finer ones follow.
const NEAR: f64 = 1e-3;
/// Steps with more measurements, about, after those with some; and how many times as many are worth these.
const STEPS: f64 = 5.0;
const WORTH: f64 = 2.0;
/// How much longer a finer lattice takes at least. Where it does not end within the budget, nothing is lost but time.
const SLOWER: f64 = 1.0;
/// How much longer a finer lattice and its error bars take about, and how much longer than error bars all that is left to do then.
const FINER: f64 = 3.0;
const ENDING: f64 = 2.0;

/// What splines on a lattice cannot do, of a scene; nothing if they can do all of it.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    let terms = || schema.groups.iter().flat_map(|group| group.terms);
    let heads = || 0..schema.heads.len();
    let refused = [
        (schema.coordinates.len() < 2 && !is_for_one(schema), "one coordinate"),
        (schema.coordinates.len() > MOST_COORDINATES, "more than four coordinates"),
        (terms().any(|t| t.kind == TermKind::Integral && t.loss.is_robust()), "robust losses of integrals"),
        (heads().any(|head| meshes::degree(schema, head).is_none()), "derivatives of such an order"),
    ];
    let found = refused.into_iter().find(|(is_so, _)| *is_so).map(|(_, what)| what);
    found.or_else(|| refuse::clouds(schema)).or_else(|| bounds::refused(schema))
}

/// Whether a scene has what splines along a record do not do: clouds, integrals or pairs of points.
pub(crate) fn is_for_one(schema: &schema::Scene) -> bool {
    let is_own = |term: &schema::Term| matches!(term.kind, TermKind::Chamfer { .. } | TermKind::Integral);
    schema.groups.iter().any(|group| group.paired || group.terms.iter().any(is_own))
}

/// Solves a bound problem within its limits, from the start or from a saved state.
pub(crate) fn solve(
    bound: &Bound,
    noise: &Noise,
    limits: Limits,
    from: Option<&Saved>,
    monitor: &mut dyn FnMut(Progress<'_>) -> Flow,
) -> Result<LocalSolution, LocalError> {
    let clock = Clock { start: Instant::now(), limits };
    let is_noisy = noise.is_there(bound.problem.scene().schema);
    let mut points = from.map_or(Ok(between::first(bound, is_noisy)), saved_points).map_err(LocalError::Fault)?;
    let schema = bound.problem.scene().schema;
    let asked = means::asked(bound);
    let proportions = match from {
        Some(saved) => Proportions::restored(saved, schema).map_err(LocalError::Fault)?,
        None => crossings::proportions(bound, points, &asked, noise, &clock)?,
    };
    if from.is_none() {
        points = (points as f64 * proportions.functions()) as usize;
    }
    let mut solver = Solver::new(bound, (points, &proportions), &asked, noise, None)?;
    let mut state = solver.first(noise);
    if let Some(saved) = from {
        state.restore(saved).map_err(LocalError::Fault)?;
    }
    let mut run = Run::go(&mut solver, state, noise, (points, &proportions), &clock, 0.0, monitor)?;
    let (mut strain, mut idle) = (f64::INFINITY, 0);
    let is_measured = solver.is_measured();
    let mut changes = Changes::default();
    while run.status == Status::Converged {
        let before = std::mem::replace(&mut strain, solver.strain(&run.state, noise));
        let missed = solver.missed(&run.state, noise);
        let is_missed = missed > MISSED || solver.alike(&run.state, noise) > 1.0;
        // Where cells miss measurements, which then count as noise, one finer lattice may be too coarse as well.
        let patience = if is_missed || !is_noisy { PATIENCE } else { 1 };
        idle = if strain > EASED * before { idle + 1 } else { 0 };
        // Small errors may grow along an equation. Without noise a finer lattice tells how far an answer is off.
        let is_seen = match is_measured {
            true => is_noisy || changes.last() < SAME || strain < EXACT && changes.taken().is_none(),
            false => changes.off() < NEAR,
        };
        // An equation that is off by less than noise lets on may still move what is learned by more than its deviation.
        let is_resolved = strain < 1.0 && is_seen;
        let is_known = changes.learned().len() == run.state.learned.len();
        let is_still = !is_noisy || is_known && is_still(&run.factor, changes.learned());
        if if is_resolved { is_still } else { idle >= patience } {
            break;
        }
        // An answer that is resolved does not wait for one that leaves no time for error bars.
        let finer = if is_resolved { FINER * (run.seconds + run.bars) } else { 0.0 };
        let has_time =
            |times: &usize| clock.has_time(finer.max(SLOWER * (times / MORE) as f64 * run.seconds + run.bars));
        let factors: &[usize] = if missed > FAR { &[MORE * MORE, MORE] } else { &[MORE] };
        // If the last lattice did not help, this one's answer does not wait for the next. If it did, this one's answer is not the last,
        // and whatever time there is may be enough.
        let is_early = idle == 0 && !is_resolved;
        let any = (is_early && clock.has_time(run.longest)).then_some(&MORE);
        let Some(more) = factors.iter().find(|times| has_time(times)).or(any).map(|times| times * points) else {
            if is_early {
                run.status = Status::Budget;
            }
            break;
        };
        // What is too large for a finer lattice, or cannot be solved there, stays with the one at hand.
        let Ok(mut finer) = Solver::new(bound, (more, &proportions), &asked, noise, None) else { break };
        if finer.cells() <= solver.cells() {
            break;
        }
        let first = State { step: run.state.step, ..finer.first(noise) };
        // What was found of noise and roughness holds there too, unless it is cells that miss the measurements.
        let classes = if is_missed { first.classes } else { run.state.known() };
        let first = State { classes, ..first };
        let Ok(found) = Run::go(&mut finer, first, noise, (more, &proportions), &clock, run.bars, monitor) else {
            break;
        };
        // Steps on a finer lattice begin anew: where they agree with the coarser answer, that is no matter of where they began.
        let learned = found.state.learned.iter().zip(&run.state.learned).map(|(after, before)| (after - before).abs());
        let is_taken = found.status == Status::Converged && (!is_resolved || clock.has_time(ENDING * found.bars));
        if found.status == Status::Converged {
            changes.move_learned(learned.collect(), is_taken);
        }
        changes.add(finer.apart(&found.state, &solver, &run.state), is_taken);
        match found.status {
            Status::Converged if is_taken => (solver, run, points) = (finer, found, more),
            Status::Converged | Status::NotConverged => break,
            status => {
                // If the last lattice did not help, or was fine enough, this one's answer stands without the next.
                run.status = if is_early || status == Status::Interrupted { status } else { run.status };
                (run.checkpoint, run.state.step) = (found.checkpoint, found.state.step);
                break;
            }
        }
    }
    while solver.lacks && run.status == Status::Converged {
        let Some((more, found)) =
            with_more(bound, (&solver, &run, &asked), noise, ((points, &proportions), &clock), monitor)
        else {
            break;
        };
        match found.status {
            // Error bars matter more than that they are short.
            Status::Converged if clock.has_time(found.bars) => (solver, run) = (more, found),
            status => {
                run.status = if status == Status::Interrupted { status } else { run.status };
                (run.checkpoint, run.state.step) = (found.checkpoint, found.state.step);
                break;
            }
        }
    }
    finish(bound, solver, run, noise, (&clock, &changes))
}

/// The answer of all measurements, or of as many as there seems to be time for, from that of some on the same lattice; nothing where
/// these would be hardly more.
fn with_more<'a>(
    bound: &'a Bound,
    (solver, run, asked): (&Solver<'_>, &Run, &(Vec<Asked>, Clashes)),
    noise: &Noise,
    (points, clock): ((usize, &Proportions), &Clock),
    monitor: &mut dyn FnMut(Progress<'_>) -> Flow,
) -> Option<(Solver<'a>, Run)> {
    let (all, used) = (measurements(bound), measurements(&solver.bound));
    let times = all as f64 / used as f64;
    // Seconds of a step are at most in proportion to the measurements.
    let longer = times.min(clock.left() / (STEPS * run.longest + run.bars));
    if longer < times.min(WORTH) {
        return None;
    }
    let most = if longer < times { (longer * solver.most as f64) as usize } else { usize::MAX };
    let mut more = Solver::new(bound, points, asked, noise, Some(most)).ok()?;
    let state = State { classes: run.state.known(), since: 0, ..run.state.clone() };
    let found = Run::go(&mut more, state, noise, points, clock, longer * run.bars, monitor).ok()?;
    Some((more, found))
}

/// Points of the largest equation in a saved state.
fn saved_points(saved: &Saved) -> Result<usize, Fault> {
    saved.counter("points").map(|points| points as usize)
}
