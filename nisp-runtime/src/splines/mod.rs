//! Splines over one coordinate: a carrier for records and for equations on a line.
//!
//! A network is one smooth function of few parameters; a record with many periods has more to say than it can hold. Here every
//! head is a sum of B-splines with a breakpoint at every measurement. Equations are asked to hold at as many places as their
//! residual has freedom, all unknowns are found together by Gauss-Newton steps on a banded triangle, and time and memory are
//! linear in the measurements. The size of the noise, and the size and roughness of every source, are those with the largest
//! evidence (MacKay 1992), and so is the kind of smoothness.

mod assembly;
mod bars;
mod basis;
mod between;
mod blurred;
mod bounded;
mod cells;
mod clean;
mod correlated;
mod course;
mod drives;
mod expected;
mod group;
mod heads;
mod iterate;
mod jumps;
mod kept;
mod leaning;
mod lengths;
pub mod live;
mod marginal;
mod place;
mod prior;
mod resolved;
mod rows;
mod scores;
mod sharing;
mod solution;
mod solver;
mod starts;
mod step;
mod straight;
mod told;
mod triangle;
mod uneven;

use std::time::Instant;

use crate::bounds;
use crate::carrier::Progress;
use crate::facts::{Answer, Known, Leaning, OTHER_THAN_SPLINES};
use crate::memory;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Flow, Limits, Status, Warning, WarningKind};
use crate::solve::state;

use bars::Bars;
use course::Run;
use iterate::State;
use place::{ALL_SHARED, Place, Tried};
use prior::{Course, HIGHEST_NOISY, KINDS, Smoothness};
pub(crate) use solution::{Root, SplineError, SplineSolution};
use solver::Solver;

/// Coefficients up to which it is looked for what is open.
const MANY: usize = 20_000;
/// Name of the method in saved states.
pub(crate) const METHOD: &str = "splines";

pub(crate) use kept::{CARRIER, KeptSplines};

/// What splines over one coordinate cannot do, of a scene; nothing if they can do all of it.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    let terms = || schema.groups.iter().flat_map(|group| group.terms);
    let refused = [
        (schema.coordinates.len() != 1, "more than one coordinate"),
        (schema.groups.iter().any(|group| group.paired), "paired points"),
        (terms().any(|term| matches!(term.kind, TermKind::Integral)), "integrals"),
        (terms().any(|term| matches!(term.kind, TermKind::Chamfer { .. })), "clouds"),
        (cells::degrees(schema).is_none(), "derivatives of such an order"),
    ];
    refused.into_iter().find(|(is_so, _)| *is_so).map(|(_, what)| what).or_else(|| bounds::refused(schema))
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
    let first = solver.first(noise);
    let asleep = solver.asleep(&first);
    let mut place = Place::first(first, kinds(&solver, cells::stretches(bound), noise.is_exact()));
    let mut run = Run { start, limits, longest: 0.0, monitor, loss: f64::INFINITY, ahead: f64::INFINITY };
    let begun = |saved: &&state::State| saved.indices("kinds").is_ok();
    match (from.filter(begun), cells::middle(bound, &breakpoints)) {
        (Some(saved), _) => place.restore(saved, solver.source_functions())?,
        // A part of a long record says how smooth the sources are, and how large the noise is.
        (None, Some(middle)) => {
            let part = cells::part(bound, middle);
            let mut solver = Solver::over(&part, middle);
            let mut trial = Place::first(solver.first(noise), kinds(&solver, false, noise.is_exact()));
            // A run that ends here begins anew.
            let save = |place: &Place| state::State::new(METHOD).with_counter("iterations", place.state.step);
            let own = kinds(&solver, false, noise.is_exact());
            let mut ended = run.go(&mut solver, &mut trial, &save)?;
            if ended == Status::Converged
                && let Some(blurred) = solver.blurred(noise, &trial)
            {
                trial.blur(blurred, kinds(&solver, false, noise.is_exact()));
                ended = run.go(&mut solver, &mut trial, &save)?;
                trial.choose_blurred();
            }
            if ended == Status::Converged
                && run.correlate((&mut solver, noise, own), &mut trial, &save)? == Flow::Continue
                && (!solver.has_sources()
                    || trial.is_filtered()
                    || run.vary(&mut solver, &mut trial, &save)? == Flow::Continue)
                && let Some(Tried { kind, state, .. }) = trial.best().cloned()
            {
                place.kinds = vec![kind];
                place.state.classes = state.classes;
                place.state.step = trial.state.step;
                (place.state.blurred, place.is_blurred) = (state.blurred, trial.is_blurred);
                (place.state.sharing, place.shared) = (state.sharing, ALL_SHARED);
                // What one roughness describes in a part, it describes in all.
                place.is_even = state.uneven.is_empty();
            }
        }
        (None, None) => {}
    }
    let mut status = run.go(&mut solver, &mut place, &Place::save)?;
    if status == Status::Converged
        && let Some(again) = solver.again(noise, &place)
    {
        place.again(again, kinds(&solver, cells::stretches(bound), noise.is_exact()));
        // Where the second start does not end, the first has.
        let ended = run.go(&mut solver, &mut place, &Place::save)?;
        status = if ended == Status::Interrupted { ended } else { status };
    }
    if status == Status::Converged
        && let Some(blurred) = solver.blurred(noise, &place)
    {
        place.blur(blurred, kinds(&solver, cells::stretches(bound), noise.is_exact()));
        let ended = run.go(&mut solver, &mut place, &Place::save)?;
        status = if ended == Status::Interrupted { ended } else { status };
    }
    if status == Status::Converged {
        place.choose_blurred();
    }
    let own = kinds(&solver, cells::stretches(bound), noise.is_exact());
    if status == Status::Converged && run.correlate((&mut solver, noise, own), &mut place, &Place::save)? == Flow::Stop
    {
        status = Status::Interrupted;
    }
    if status == Status::Converged
        && solver.has_sources()
        && !place.is_filtered()
        && run.vary(&mut solver, &mut place, &Place::save)? == Flow::Stop
    {
        status = Status::Interrupted;
    }
    let (loss, mut ahead) = (run.loss, (status != Status::Converged).then_some(run.ahead));
    let checkpoint = place.save();
    let mut warnings: Vec<Warning> = asleep.iter().map(|&head| Warning::open_sign(schema.heads[head].name)).collect();
    if let Some(Tried { state, .. }) = place.best().cloned() {
        place.state = State { step: place.state.step, ..state };
        if status == Status::Converged
            && solver.has_sources()
            && let Some(best) = place.best()
        {
            solver.set_smoothness(KINDS[best.kind], &best.state);
            place.state = State { step: place.state.step, ..solver.expected(place.state.clone(), &run)? };
        }
        // A kind of smoothness was tried to its end.
        ahead = None;
    }
    // Only a minimum has error bars.
    let is_noisy = noise.is_there(schema);
    let likely = if status == Status::Converged && is_noisy { place.likely() } else { Vec::new() };
    let has_time = status != Status::Budget && run.has_time_for(likely.len());
    if is_noisy && !has_time {
        warnings.push(Warning::no_bars());
    }
    let bars = Bars::of(&mut solver, if has_time { likely } else { Vec::new() }, &place.state.theta)?;
    if bars.is_open {
        status = Status::NotConverged;
    }
    let (mut moved, is_weighed) = (Vec::new(), place.is_weighed());
    if let Some(best) = place.best().filter(|_| status == Status::Converged && run.has_time_for(leaning::STEPS)) {
        moved = solver.leaning(KINDS[best.kind], &best.state)?;
    }
    let is_blurred = place.best().is_some_and(|best| best.state.blurred);
    // Noise of a column that a number multiplies makes the number look too large.
    let known = solver.known().into_iter().filter(|known| !is_blurred || !matches!(known, Known::Scalar(_)));
    let known: Vec<Known> = known.collect();
    let mut scores = Vec::new();
    if status == Status::Converged
        && solver.heads.len() <= MANY
        && !known.is_empty()
        && run.has_time_for(1 + known.len())
        && let Some(best) = place.best()
    {
        scores = solver.scores(KINDS[best.kind], &best.state, &known)?;
    }
    let mut roots = Vec::new();
    if status == Status::Converged
        && solver.heads.len() <= MANY
        && let Some(best) = place.best()
    {
        solver.set_smoothness(KINDS[best.kind], &best.state);
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
    let shared = solver.all_shared(&place.state);
    warnings.extend(solver.shared_noise(&place.state));
    let misfits = solver.misfits(&place.state);
    let course = place.best().map(|best| KINDS[best.kind].course);
    let State { theta, learned, step: iterations, .. } = place.state;
    let is_beside_sources = solver.is_beside_sources();
    let (heads, facts, between) = solver.into_facts(&breakpoints, &theta);
    let (kept, told) = bars.keep((heads, theta, learned), course);
    let own = kept.learned().into_iter().filter(|_| is_beside_sources).enumerate();
    let leaning = own
        .map(|(at, (_, deviation))| Leaning { moved: moved.get(at).copied(), deviation, by_prior: None, is_weighed })
        .collect();
    let answer = Answer {
        facts,
        between,
        clouds: Vec::new(),
        scalars,
        scores,
        told,
        leaning,
        ahead,
        moved: None,
        left_to_learned: Vec::new(),
        strain: None,
        loose: None,
        is_coarse: false,
        shared,
        used: 1.0,
        refined: None,
        finer: OTHER_THAN_SPLINES,
    };
    Ok(SplineSolution { kept, roots, status, iterations, loss, warnings, checkpoint, answer, misfits })
}

/// Kinds of smoothness that are tried. How smooth sources are says what a scalar beside them is, so that the smoothest kind is tried there,
/// too: a stiffness beside smooth forces was ten deviations off with third orders, and right with fifth ones.
fn kinds(solver: &Solver<'_>, stretches: bool, is_exact: bool) -> Vec<usize> {
    let is_any = is_exact || solver.is_beside_sources();
    if !solver.has_sources() {
        return vec![0];
    }
    let is_tried = |kind: &usize| {
        let Smoothness { order, course } = KINDS[*kind];
        (stretches || course == Course::Steady) && (is_any || order <= HIGHEST_NOISY)
    };
    (0..KINDS.len()).filter(is_tried).collect()
}
