//! How noisy a stretch of a record is, and how smooth its sources are: what the evidence of all of its rows says.

use std::time::Instant;

use super::super::cells;
use super::super::heads::Heads;
use super::super::iterate::State;
use super::super::leaning::hedge;
use super::super::solver::Solver;
use super::super::triangle::covariance::Covariance;
use super::super::{KINDS, Place, Run, Tried, kinds};
use super::LiveError;
use crate::facts::Leaning;
use crate::noise::{self, Noise};
use crate::problem::Bound;
use crate::solve::driver::{Flow, Limits, Status};
use crate::verdict::leaning::{FARTHEST, limit};
use crate::weighed::Class;

/// What rows count as known to, in the engine's units.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// How sources are smooth, as a number of [`KINDS`].
    pub(super) kind: usize,
    /// By group and row, what the row is divided by.
    pub(super) sigma: Vec<Vec<f64>>,
    /// By head, how rough and how large it is, where it is a source.
    pub(super) sizes: Vec<Option<(f64, f64)>>,
    /// Scalars that programs read, the learned ones as they were found.
    pub(super) scalars: Vec<f64>,
    /// How far a learned scalar moves where sources may be larger, at most, as a share of itself; less where its deviation says that it may.
    pub(super) leaning: f64,
    /// Parameters of the learned scalars, and their covariances, row by row.
    pub(super) learned: Vec<f64>,
    pub(super) spread: Vec<f64>,
    /// Derivatives of the scalars by their parameters.
    pub(super) by_learned: Vec<f64>,
    /// Noise that differences of neighbours show.
    pub(super) noise: Noise,
    /// The classes to start from the next time.
    classes: Vec<Class>,
}

/// The answer to a stretch of a record.
pub(super) struct Stretch {
    pub(super) weights: Weights,
    heads: Heads,
    theta: Vec<f64>,
    covariance: Covariance,
}

impl Stretch {
    /// Solves a part of a record by itself; from what another part said, where it is known.
    pub(super) fn solve(bound: &Bound, from: Option<&Weights>) -> Result<Self, LiveError> {
        let noise = noise::estimate(bound);
        let breakpoints = cells::breakpoints(bound, &noise);
        // A window has no unknowns that all of its rows share.
        let mut solver = Solver::over(bound, &breakpoints).without_lines();
        // What was the likeliest kind comes first: it knows how large its sources are.
        let mut kinds = kinds(&solver, false, false);
        if let Some(from) = from {
            kinds.sort_by_key(|kind| *kind != from.kind);
        }
        let mut place = Place::first(solver.first(&noise), kinds);
        if let Some(from) = from {
            place.state.classes.clone_from(&from.classes);
        }
        let mut monitor = |_: super::super::Progress<'_>| Flow::Continue;
        let mut run = Run {
            start: Instant::now(),
            limits: Limits::default(),
            longest: 0.0,
            monitor: &mut monitor,
            loss: f64::INFINITY,
            ahead: f64::INFINITY,
        };
        let status = run.go(&mut solver, &mut place, &Place::save)?;
        let best = place.best().filter(|_| status == Status::Converged).cloned();
        let Tried { kind, state, .. } = best.ok_or(LiveError::Open)?;
        // The window's sources are as rough all along. Scalars that are learned beside them need not believe so.
        let (mut learned, mut leaning, mut spread) = (state.learned.clone(), 0.0, None);
        if !learned.is_empty() && solver.has_sources() {
            run.vary(&mut solver, &mut place, &Place::save)?;
            if let Some(best) = place.best().cloned() {
                let (moved, is_weighed) = (solver.leaning(KINDS[best.kind], &best.state)?, place.is_weighed());
                solver.set_smoothness(KINDS[best.kind], &best.state);
                learned.clone_from(&best.state.learned);
                if let Some((state, mut found, _)) = solver.doubted(best.state, &[])? {
                    found.covariance.forget_shared(learned.len());
                    let by_prior = solver.by_prior(&state, &found.covariance)?;
                    found.covariance.stretch_shared(&by_prior.into_iter().map(hedge).collect::<Vec<f64>>());
                    let variances = found.covariance.shared_variances();
                    let far = |(moved, variance): (f64, f64)| {
                        let deviation = Some(variance.max(0.0).sqrt());
                        let own = Leaning { moved: Some(moved), deviation, by_prior: None, is_weighed };
                        moved * FARTHEST / limit(&own)
                    };
                    leaning = moved.into_iter().zip(variances).map(far).fold(0.0, f64::max);
                    spread = Some(found.covariance.corner);
                }
            }
        }
        solver.set_smoothness(KINDS[kind], &state);
        let classes = state.classes.clone();
        let (state, found, _) = solver.doubted(state, &[])?.ok_or(LiveError::Open)?;
        let covariance = found.covariance;
        let weights = Weights {
            kind,
            sigma: sigma(&solver, &state),
            sizes: (0..solver.heads.bases.len()).map(|head| solver.source_sizes(&state, head)).collect(),
            by_learned: solver.set_learned(&learned),
            scalars: solver.scalars(&learned).to_vec(),
            learned,
            spread: spread.unwrap_or_else(|| covariance.corner.clone()),
            leaning,
            noise,
            classes,
        };
        Ok(Self { weights, heads: solver.heads, theta: state.theta, covariance })
    }

    /// A head at a place in the engine's units.
    pub(super) fn value(&self, head: usize, at: f64) -> f64 {
        self.heads.derivative(head, (self.heads.cell(at), at), 0, &self.theta)
    }

    /// Its standard deviation.
    pub(super) fn deviation(&self, head: usize, at: f64) -> f64 {
        let (first, slopes) = self.heads.value_row(head, at);
        self.covariance.of(first, &slopes, &[]).max(0.0).sqrt()
    }
}

fn sigma(solver: &Solver<'_>, state: &State) -> Vec<Vec<f64>> {
    let of = |(at, group): (usize, &crate::schema::Group)| {
        let mut sigma = vec![1.0; group.rows];
        for (number, term) in group.terms.iter().enumerate() {
            for (row, sigma) in sigma.iter_mut().enumerate().skip(term.first).take(term.rows) {
                *sigma = solver.sigma(state, at, number, row);
            }
        }
        sigma
    };
    solver.bound.problem.scene().schema.groups.iter().enumerate().map(of).collect()
}
