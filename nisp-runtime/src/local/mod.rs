//! States and sources carried by local functions instead of one global network.
//!
//! A network is one smooth function of all its parameters: at its best for a state that is smooth, and slow to learn an
//! edge. A contact patch is nothing but edges. Here every head is a sum of B-splines on a lattice, so that a row depends on
//! a few coefficients, the normal equations are sparse and a Gauss-Newton step costs a sparse factorisation. Equations,
//! units and derivatives are those of the same compiled programs; they are tested with splines on the lattice (see
//! `group`). Sources may have a prior that knows patches (see [`Patches`]).
//!
//! Meant for two or three coordinates and a few fields; scenes over time are in better hands with a network.

mod assembly;
mod block;
mod bspline;
mod cholesky;
mod counting;
mod course;
mod doubts;
mod draws;
mod entries;
mod evaluated;
mod fill;
mod group;
mod heads;
mod integrals;
mod judged;
mod kept;
mod lattice;
mod linearised;
mod live;
mod meshes;
mod misfits;
mod noise;
mod normal;
mod ordering;
mod pattern;
mod phase;
mod place;
mod prior;
mod refuse;
mod resolved;
mod resting;
mod rows;
mod scored;
mod scores;
mod shape;
mod sites;
pub(crate) mod smooth;
mod solver;
mod sorted;
mod spare;
mod surface;
mod tabled;
mod taken;
mod testing;
mod together;
mod unseen;

use std::time::{Duration, Instant};

use thiserror::Error;

use crate::carrier::Progress;
use crate::facts::{Answer, Score};
use crate::problem::Bound;
use crate::solve::driver::{Flow, Limits, Status, Warning};
use crate::solve::fault::Fault;
use crate::solve::state::State;

pub(crate) use kept::{CARRIER, KeptLattices};
pub(crate) use live::Live;
pub use prior::Patches;

use course::End;
use draws::Together;
use normal::factor::Factor;
use solver::Solver;

/// How fine the local functions are, and what is known of the sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Cells along the longest coordinate.
    pub cells: usize,
    /// How much coarser the lattice is on which a solution is sought first, with sixteen cells at least; one for none.
    /// Coarse splines find the way to it in fewer and cheaper steps, and noise creases them less.
    pub coarser: usize,
    /// Degree of the state's splines; at least the order of its highest derivative.
    pub degree: usize,
    /// Degree of the functions that equations are tested with: 1, hats, where sources have edges; that of the state where it
    /// is smooth, so that no pattern of coefficients escapes all tests.
    pub tests: usize,
    /// Cells of a source along one of the state's.
    pub finer: usize,
    /// Coordinates along which sources are spread: fewer than there are, if they live on a face.
    pub source_dimensions: usize,
    /// Prior of the sources.
    pub patches: Option<Patches>,
}

/// Why local functions cannot solve a problem.
#[derive(Debug, Error)]
pub enum LocalError {
    /// Something that only networks do.
    #[error("local functions do not do {0}; choose a network")]
    Unsupported(&'static str),
    /// A lattice too fine.
    #[error("the lattice is too fine for the memory; choose fewer cells")]
    Memory,
    /// A normal matrix that is not positive definite.
    #[error("the normal matrix cannot be factorised; the data may not determine the answer")]
    Factorisation,
    /// A residual that is not finite.
    #[error("{0}")]
    Fault(Fault),
}

/// Cells of the coarser lattice at least.
const FEWEST: usize = 16;

/// What the fine lattice takes before its first answer, in steps on the coarse one: places of all points, the state taken
/// over, a step.
const FINER: f64 = 10.0;

/// A solved problem on its lattices.
pub(crate) struct LocalSolution {
    pub(crate) kept: KeptLattices,
    pub(crate) status: Status,
    pub(crate) iterations: u64,
    pub(crate) loss: f64,
    pub(crate) warnings: Vec<Warning>,
    factor: Option<Factor>,
    /// What follows given numbers that may be off.
    together: Vec<Together>,
    /// How far cells leave the parameters of learned scalars off; nothing where that is not known.
    off: Vec<f64>,
    /// Where the solver stopped.
    pub(crate) checkpoint: State,
    /// What the verdict is made from.
    pub(crate) answer: Answer,
    /// By group and term.
    pub(crate) misfits: Vec<Vec<misfits::Misfits>>,
}

/// Name of the method in saved states.
const METHOD: &str = "local functions";

/// Solves a bound problem within its limits, from the start or from a saved state; also what goes on from the answer.
pub(crate) fn solve(
    bound: &Bound,
    settings: &Local,
    limits: Limits,
    from: Option<&State>,
    monitor: &mut (dyn FnMut(Progress<'_>) -> Flow + Send),
) -> Result<(LocalSolution, Live), LocalError> {
    let start = Instant::now();
    let coarse = settings.cells.div_ceil(settings.coarser.max(1)).max(FEWEST).min(settings.cells);
    let (lattice, before) = match from {
        None => (0, 0),
        Some(state) => saved_place(state).map_err(LocalError::Fault)?,
    };
    let first_is_coarse = coarse < settings.cells && lattice == 0;
    let mut stage = Stage { start, limits, before, lattice, monitor };
    let mut solver = Solver::new(bound, settings, if first_is_coarse { coarse } else { settings.cells })?;
    let place = match from {
        None => solver.first(),
        Some(state) => solver.restore(state).map_err(LocalError::Fault)?,
    };
    // Places and patterns of the fine lattice do not wait for an answer on the coarse one.
    let set_up = || first_is_coarse.then(|| Solver::new(bound, settings, settings.cells)).transpose();
    let (end, fine) = rayon::join(|| solver.run(place, first_is_coarse, &mut stage), set_up);
    let mut end = end?;
    let goes_on = end.iterations < limits.iterations && stage.has_time(FINER * end.longest);
    if first_is_coarse && end.status != Status::Interrupted && !goes_on {
        end.stay_coarse();
    } else if let (Some(mut fine), true) = (fine?, end.status != Status::Interrupted) {
        let place = fine.taken_over(&solver.heads, &end.state)?;
        (stage.before, stage.lattice) = (end.iterations, 1);
        end = fine.run(place, false, &mut stage)?;
        solver = fine;
    }
    // Of what is no solution, the spread about it says nothing.
    let solved = matches!(end.status, Status::Converged | Status::Budget);
    let has_time_for = |steps: f64| end.status == Status::Converged || stage.has_time(steps * end.longest);
    // What an answer rests on matters more than its error bars.
    let mut asked = solver.known();
    let known = asked.len();
    asked.extend(together::uncertain(&bound.problem, &asked));
    let has_time_to_ask = solved && has_time_for(course::ASKED);
    let mut told = has_time_to_ask.then(|| solver.asked(&asked, &end)).flatten().unwrap_or_default();
    let has_time = has_time_for(course::BARS);
    let heads = solver.heads.clone();
    let is_resolvable = end.status == Status::Converged && stage.has_time(resolved::COST * end.longest);
    let bars = || (solved && has_time).then(|| solver.deviations(&end.state)).flatten().unwrap_or_default();
    let resolve = || is_resolvable.then(|| resolved::unresolved(bound, settings, &heads, &end.state)).flatten();
    let (mut deviations, unresolved) = rayon::join(bars, resolve);
    let together = together::together(bound, &asked, &told, end.state.learned.len());
    deviations.follow(&together);
    told.truncate(known);
    end.warnings.extend(unresolved);
    end.warnings.extend(solver.rests_on_the_prior());
    let mut answer = solver.answer(&end.state);
    answer.moved = (end.status != Status::Converged).then_some(end.moved);
    let scores: Vec<Option<Score>> = told.into_iter().map(|told| told.score).collect();
    answer.scores = scores.iter().copied().flatten().collect();
    let misfits = solver.misfits(&end.state);
    let End { state, status, iterations, loss, warnings, factor, checkpoint, .. } = end;
    let kept = KeptLattices { heads, theta: state.theta.clone(), learned: state.learned.clone(), draws: deviations };
    let solution = LocalSolution {
        kept,
        status,
        iterations,
        loss,
        warnings,
        factor,
        together,
        off: Vec::new(),
        checkpoint,
        answer,
        misfits,
    };
    Ok((solution, Live::new(solver, state, scores)))
}

/// The lattice of a saved state, and the steps before it.
fn saved_place(state: &State) -> Result<(u64, u64), Fault> {
    state.check_method(METHOD)?;
    Ok((state.counter("lattice")?, state.counter("before")?))
}

/// A run on one lattice as part of the whole.
struct Stage<'a> {
    start: Instant,
    limits: Limits,
    /// Steps on lattices before.
    before: u64,
    lattice: u64,
    monitor: &'a mut (dyn FnMut(Progress<'_>) -> Flow + Send),
}

impl Stage<'_> {
    /// True where so many seconds are left.
    fn has_time(&self, seconds: f64) -> bool {
        let enough = |budget: Duration| self.start.elapsed().as_secs_f64() + seconds < budget.as_secs_f64();
        self.limits.budget.is_none_or(enough)
    }
}

impl LocalSolution {
    /// Standard deviation of a learned scalar's parameter.
    pub(crate) fn learned_deviation(&self, at: usize) -> Option<f64> {
        let off = self.off.get(at).map_or(0.0, |off| off * off);
        self.factor.as_ref()?.learned_variance(at).map(|variance| (variance.max(0.0) + off).sqrt())
    }

    /// Covariance of some learned scalars' parameters, row by row.
    pub(crate) fn covariance_of(&self, learned: &[usize]) -> Option<Vec<f64>> {
        self.factor.as_ref()?.covariance_of(learned)
    }

    /// Standard deviation of a weighted sum of a head's values at points in the engine's units, flat.
    pub(crate) fn deviation_of_sum(&self, head: usize, points: &[f64], weights: &[f64]) -> Option<f64> {
        let weights = self.kept.weights_of_sum(head, points, weights);
        self.kept.deviation_of_sum(&weights).or_else(|| {
            let variance = self.factor.as_ref()?.variance_of_sum(&weights)?.max(0.0);
            Some((variance + together::variance_of_sum(&self.together, &weights)).sqrt())
        })
    }
}
