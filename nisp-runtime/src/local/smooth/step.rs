//! Gauss-Newton steps: the normal equations about a state, where they lead, and what their rows say of noise and roughness.

use std::sync::Arc;

use rand::SeedableRng;
use rand::rngs::StdRng;

use super::freedom::Unmeasured;
use super::sampled::Sampled;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::LocalError;
use crate::local::block::Block;
use crate::local::normal::factor::Factor;
use crate::local::rows::Evaluated;
use crate::local::surface::Surface;
use crate::local::unseen::Unseen;
use crate::loss::deviation_of_clean;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::solve::vector::root_mean_square;
use crate::tolerance;
use crate::weighed::{Tally, renew};

/// What coefficients are multiplied by in rows that keep those bounded that nothing else speaks of.
const RIDGE: f64 = 1e-6;
/// How much rougher fields may be than the data alone say, times the tolerance of their equations. Where a source sets in, fields
/// change in a small part of the domain and time: a prior that speaks beside the data flattens the source.
const FREE: f64 = 10.0;
/// Standard deviation of the learned scalars' parameters before any row is seen.
const LEARNED: f64 = 10.0;
/// Largest change of a learned parameter in a step.
const FARTHEST: f64 = 1.0;
/// What a source is of the order of where no cloud saw it, beside its size where one did, or its natural one: patches carry twice as
/// much.
const LIKELY: f64 = 0.5;
/// A step is halved so often until it leads downhill, and so often until equations have a value where it leads.
const HALVINGS: u32 = 8;
const MOST_HALVINGS: u32 = 40;

/// What a step found.
pub(super) struct Found {
    pub(super) next: State,
    /// Half the sum of squares of all rows before the step.
    pub(super) loss: f64,
    /// Largest change of a coefficient or parameter.
    pub(super) change: f64,
    /// What it would be of a learned scalar's parameter, were the whole step taken.
    pub(super) ahead: f64,
    /// How far it moved a source, over its size, at most.
    pub(super) moved: f64,
    /// The loss after the step over what noise of inexact measurements leaves of it; nothing where all are exact, or where there
    /// are clouds, whose strays are no noise.
    pub(super) strained: f64,
    /// What the loss is less after the whole step; infinite if only a part of it was taken.
    pub(super) gain: f64,
    pub(super) factor: Factor,
}

/// The rows that take part about a state. Those of groups are linearised whenever they are read: their derivatives would fill the
/// memory.
pub(super) struct Rows {
    pub(super) asked: Vec<Asked>,
    /// Of every cloud, one for each point that has a foot.
    pub(super) clouds: Vec<Vec<Block>>,
    /// Derivatives of the learned scalars by their parameters.
    pub(super) learned: Vec<f64>,
}

/// The rows of a group.
#[derive(Clone)]
pub(super) struct Asked {
    /// The group's number.
    pub(super) at: usize,
    /// By row and place, whether it counts.
    pub(super) counts: Vec<Vec<bool>>,
    pub(super) evaluated: Arc<Evaluated>,
}

impl Solver<'_> {
    /// By row of a group and place, whether it counts in a phase: equations wait until data and conditions on values are
    /// regressed, and of what was not measured nothing is known.
    pub(super) fn counts(&self, at: usize, phase: Phase) -> Vec<Vec<bool>> {
        let group = &self.groups[at];
        let mut counts = vec![vec![false; group.places()]; group.schema.rows];
        let is_asked = |term: &&schema::Term| !matches!(term.kind, TermKind::Chamfer { .. });
        let takes_part = |term: &&schema::Term| takes_part(group.schema, term, phase);
        for term in group.schema.terms.iter().filter(is_asked).filter(takes_part) {
            let measured = self.bound.lacking(at, term).unwrap_or_else(|| vec![true; group.places()]);
            counts[term.first..term.first + term.rows].fill(measured);
        }
        counts
    }

    /// The rows of a group, batch by batch.
    pub(super) fn batches<'b>(&'b self, rows: &'b Rows, asked: &'b Asked) -> impl Iterator<Item = Vec<Block>> + 'b {
        self.groups[asked.at].batches(&self.heads, &asked.evaluated, &rows.learned, &asked.counts)
    }

    /// The heads whose roughness the evidence finds in a phase: sources, or measured fields while only data are regressed.
    pub(super) fn judged(&self, phase: Phase) -> Vec<usize> {
        let observed = self.schema().observed();
        let heads = self.schema().heads.iter().enumerate();
        let is_judged = |&(head, declared): &(usize, &schema::Head)| match phase {
            Phase::Regress => !declared.source && observed.contains(&head),
            Phase::Explain | Phase::Solve => declared.source,
        };
        heads.filter(is_judged).map(|(head, _)| head).collect()
    }

    /// Half the sum of squares of all rows, robust ones by what they cost.
    pub(super) fn loss(&mut self, state: &State) -> f64 {
        self.set_learned(&state.learned);
        self.find_feet(state);
        let clouds = self.surfaces.iter().filter(|surface| self.is_seen(surface, state.phase));
        let mut sum = clouds.map(|surface| surface.loss(self.sigma(state, surface))).sum::<f64>();
        for (at, group) in self.groups.iter().enumerate() {
            let counts = self.counts(at, state.phase);
            if !is_any(&counts) {
                continue;
            }
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            for (term, loss) in group.schema.terms.iter().zip(self.losses(state, at)) {
                for (row, counts) in counts.iter().enumerate().skip(term.first).take(term.rows) {
                    let there = (0..group.places()).filter(|&place| counts[place]);
                    sum += match term.kind {
                        TermKind::Integral => 0.0,
                        _ => there.map(|place| loss.rho(group.over_tolerance(&found, row, place))).sum::<f64>(),
                    };
                }
            }
            let sums = group.sums(&found, &self.scalars).into_iter().filter(|(row, _)| counts[*row].contains(&true));
            sum += sums.map(|(row, misfit)| 0.5 * (misfit / group.sigma[row]).powi(2)).sum::<f64>();
        }
        let priors = (0..self.priors.len()).flat_map(|head| self.prior_rows(state, head));
        sum + priors.map(|block| 0.5 * block.misfits[0].powi(2)).sum::<f64>()
    }

    pub(super) fn prior_rows(&self, state: &State, head: usize) -> Vec<Block> {
        // Equations say of fields what the prior says of sources: it lets fields go as equations tighten, and keeps only those
        // directions bounded of which nothing else speaks.
        let is_free = state.phase.has_equations() && !self.schema().heads[head].source;
        let times = if is_free { FREE / state.tolerance } else { 1.0 };
        let roughness = times * state.classes[self.roughness[head]].size;
        self.priors[head].blocks(&state.theta, roughness, state.learned.len())
    }

    /// One step.
    pub(super) fn step(&mut self, state: &State) -> Result<Found, LocalError> {
        let slopes = self.set_learned(&state.learned);
        self.size(state);
        self.set_sigmas(state);
        for at in 0..self.groups.len() {
            let losses = self.losses(state, at);
            self.groups[at].set_losses(losses.into_iter());
        }
        let loss = self.loss(state);
        let rows = self.rows(state, &slopes)?;
        // While equations are loose, they need no source.
        let is_loose = state.phase.has_equations() && state.tolerance > state.strictest;
        let counts = state.phase.has_equations() && !is_loose;
        let unmeasured = if counts { self.count_unmeasured(state, &rows) } else { Unmeasured::default() };
        self.add_all(state, &rows);
        let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
        let (step, shared) = self.normal.step(&factor).ok_or(LocalError::Factorisation)?;
        let tallies =
            self.tallies(state, &rows, (&step, &shared), (&factor, &unmeasured)).ok_or(LocalError::Factorisation)?;
        let (step, mut shared) = self.within_bounds(state, (step, shared));
        // Behind the learned parameters are multipliers of integrals.
        shared.truncate(state.learned.len());
        let mut share = shared.iter().fold(1.0, |share: f64, x| share.min(FARTHEST / x.abs().max(f64::MIN_POSITIVE)));
        let mut next = state.clone();
        next.unmeasured = unmeasured;
        let (mut gain, mut left) = (f64::INFINITY, loss);
        for halvings in 0..MOST_HALVINGS {
            next.theta = state.theta.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            next.learned = state.learned.iter().zip(&shared).map(|(x, s)| x + share * s).collect();
            let after = self.loss(&next);
            let is_less = after <= loss * (1.0 + 1e-9) + 1e-12;
            if after.is_finite() && (is_less || halvings + 1 >= HALVINGS) {
                gain = if halvings == 0 { (loss - after).abs() } else { f64::INFINITY };
                left = after;
                break;
            }
            share *= 0.5;
            // Where no step has a value, none is taken.
            (next.theta, next.learned) = (state.theta.clone(), state.learned.clone());
        }
        let change = step.iter().chain(&shared).fold(0.0, |most: f64, x| most.max((share * x).abs()));
        let ahead = shared.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let judged: Vec<usize> = self.judged(state.phase).into_iter().map(|head| self.roughness[head]).collect();
        let measured = (0..tallies.len()).filter(|class| !self.roughness.contains(class));
        let measured = measured.filter(|&class| state.classes[class].open.is_some()).map(|class| tallies[class].count);
        let measured: f64 = measured.sum();
        let strained = if measured > 0.0 && self.surfaces.is_empty() { left / (0.5 * measured) } else { 0.0 };
        let is_held = |class| match self.roughness.contains(&class) {
            true => is_loose || !judged.contains(&class),
            // A second start keeps to its noise until sources had a chance.
            false => state.phase == Phase::Explain || state.phase == Phase::Regress && state.earlier.is_some(),
        };
        renew(&mut next.classes, &tallies, is_held);
        if state.phase.has_equations() {
            next.tolerance = tolerance::after(state.tolerance, share, state.strictest);
        }
        (next.step, next.since) = (state.step + 1, state.since + 1);
        let moved = self.heads.moved(self.schema(), &state.theta, &next.theta);
        Ok(Found { next, loss, change, ahead, moved, strained, gain, factor })
    }

    /// The normal equations about a state; returns the rows of all groups that take part, with the group's number.
    pub(super) fn assemble(&mut self, state: &State, slopes: &[f64]) -> Result<Rows, LocalError> {
        self.find_feet(state);
        let all = self.rows(state, slopes)?;
        self.add_all(state, &all);
        Ok(all)
    }

    /// Where no cloud saw the surface that a source acts on.
    pub(super) fn unseen(&self, head: usize) -> Option<Unseen> {
        let lattice = &self.heads.lattices[head];
        let is_of_all = lattice.dimensions() == lattice.inputs();
        (self.schema().heads[head].source && is_of_all).then(|| Unseen::of(&self.surfaces, lattice)).flatten()
    }

    /// Whether a cloud takes part in a phase.
    fn is_seen(&self, surface: &Surface, phase: Phase) -> bool {
        let group = &self.schema().groups[surface.group];
        group.terms.iter().any(|term| term.name == surface.term && takes_part(group, term, phase))
    }

    /// The rows of all groups and clouds that take part about a state, whose feet are found.
    pub(super) fn rows(&self, state: &State, slopes: &[f64]) -> Result<Rows, LocalError> {
        let mut asked = Vec::new();
        for (at, group) in self.groups.iter().enumerate() {
            let counts = self.counts(at, state.phase);
            if !is_any(&counts) {
                continue;
            }
            let evaluated = Arc::new(group.evaluate(&self.heads, &state.theta, &self.scalars, true));
            for (own, row) in group.own_rows().into_iter().enumerate() {
                let counts = |p: usize| !group.tests.is_empty() || counts[row][p];
                let is_lost = |&p: &usize| counts(p) && !evaluated.row(row, p).is_finite();
                if let Some(p) = (0..group.sites.count).find(is_lost) {
                    return Err(LocalError::Fault(Fault::residual(group.name(own), Some(p))));
                }
            }
            asked.push(Asked { at, counts, evaluated });
        }
        let of_cloud = |surface: &Surface| {
            let (group, sigma) = (&self.groups[surface.group], self.sigma(state, surface));
            let rows = || surface.blocks(group, &self.heads, &state.theta, &self.scalars, slopes, sigma);
            if self.is_seen(surface, state.phase) { rows() } else { Vec::new() }
        };
        Ok(Rows { asked, clouds: self.surfaces.iter().map(of_cloud).collect(), learned: slopes.to_vec() })
    }

    /// The normal equations of rows and of what is believed.
    pub(super) fn add_all(&mut self, state: &State, rows: &Rows) {
        self.normal.clear();
        for Asked { at, counts, evaluated } in &rows.asked {
            let batches = self.groups[*at].batches(&self.heads, evaluated, &rows.learned, counts);
            batches.for_each(|blocks| self.normal.add_all(&blocks));
            let integrals = self.groups[*at].integrals(&self.heads, evaluated, &self.scalars, &rows.learned);
            for (_, integral) in integrals.iter().filter(|(row, _)| counts[*row].contains(&true)) {
                self.normal.add_dense(integral);
            }
        }
        rows.clouds.iter().for_each(|blocks| self.normal.add_all(blocks));
        for head in 0..self.priors.len() {
            let mut believed = self.prior_rows(state, head);
            // The answer is what the prior says where nothing was seen; its deviations are not.
            if let Some(unseen) = self.normal.draws.as_ref().and_then(|_| self.unseen(head)) {
                let first = self.heads.first[head];
                let own = &state.theta[first..self.heads.first[head + 1]];
                believed.retain(|row| !row.dofs.iter().any(|&dof| unseen.functions[dof as usize - first]));
                let seen = own.iter().enumerate().filter(|(at, _)| !unseen.functions[*at]).map(|(_, x)| *x);
                let level = LIKELY * root_mean_square(seen).max(1.0) / self.heads.lattices[head].smoothing();
                unseen.add(&mut self.normal, &self.heads, head, level);
            }
            self.normal.add_all(&believed);
        }
        for (at, theta) in state.theta.iter().enumerate() {
            self.normal.add_stiffness(at, RIDGE.powi(2));
            // What no data speak of stays where equations have a value.
            self.normal.gradient[at] += if state.phase.has_equations() { RIDGE.powi(2) * theta } else { 0.0 };
        }
        let precision = LEARNED.powi(-2);
        for (at, parameter) in state.learned.iter().enumerate() {
            self.normal.add_learned(at, precision, precision * parameter);
        }
    }

    /// By class, what is left of its rows after a step, how many there are, and how many of them the answer used up.
    fn tallies(
        &self,
        state: &State,
        rows: &Rows,
        (step, shared): (&[f64], &[f64]),
        (factor, unmeasured): (&Factor, &Unmeasured),
    ) -> Option<Vec<Tally>> {
        let mut tallies = vec![Tally::default(); state.classes.len()];
        let mut random = StdRng::seed_from_u64(0);
        let lens = (step.len(), shared.len());
        for asked in &rows.asked {
            let group = &self.groups[asked.at];
            let terms = group.schema.terms.iter().enumerate();
            let observed = terms.filter(|(_, term)| term.kind == TermKind::Observation);
            let mut observed: Vec<(usize, &schema::Term, Sampled)> = observed
                .map(|(number, term)| {
                    let sampled = Sampled::new(group.sites.count * term.rows, lens, &mut random);
                    (number, term, sampled)
                })
                .collect();
            if observed.is_empty() {
                continue;
            }
            for blocks in self.batches(rows, asked) {
                for (_, term, sampled) in &mut observed {
                    let first = group.first_own(term);
                    let own = blocks.iter().flat_map(|block| (first..first + term.rows).map(move |row| (block, row)));
                    sampled.add(&own.collect::<Vec<_>>(), (step, shared));
                }
            }
            for (number, term, sampled) in observed {
                let counts = asked.counts[term.first..term.first + term.rows].iter().flatten();
                let count = counts.filter(|counts| **counts).count();
                tallies[self.classes[asked.at][number]] = sampled.tally(factor, count)?;
            }
        }
        for (surface, blocks) in self.surfaces.iter().zip(&rows.clouds) {
            let own: Vec<(&Block, usize)> = blocks.iter().map(|block| (block, 0)).collect();
            let mut sampled = Sampled::new(own.len(), lens, &mut random);
            sampled.add(&own, (step, shared));
            let tally = sampled.tally(factor, own.len())?;
            // Clouds have outliers, which are no noise.
            let clean = deviation_of_clean(surface.misfits().collect(), tally.used) / self.sigma(state, surface);
            let squares = clean.powi(2) * (tally.count - tally.used);
            tallies[self.class(surface)] = Tally { squares, ..tally };
        }
        for head in self.judged(state.phase) {
            let blocks = self.prior_rows(state, head);
            let own: Vec<(&Block, usize)> = blocks.iter().map(|block| (block, 0)).collect();
            let tally = &mut tallies[self.roughness[head]];
            tally.count = self.priors[head].rank as f64;
            tally.squares = blocks.iter().map(|block| block.after(0, step, shared).powi(2)).sum();
            tally.used = match state.phase {
                // What data leave of a field is no small difference.
                Phase::Regress => {
                    let mut sampled = Sampled::new(own.len(), lens, &mut random);
                    sampled.add(&own, (step, shared));
                    sampled.used(factor)?
                }
                Phase::Explain | Phase::Solve => {
                    let roughness = state.classes[self.roughness[head]].size;
                    let settled = self.freedoms[head].as_ref()?.settled(factor, step.len(), roughness)?;
                    let before = unmeasured.of(head);
                    tally.squares = (tally.squares - before.squares).max(0.0);
                    tally.count - (settled - before.settled)
                }
            };
        }
        Some(tallies)
    }
}

/// Whether a term takes part in a phase: those with derivatives wait until data and conditions on values are regressed.
fn takes_part(group: &schema::Group, term: &schema::Term, phase: Phase) -> bool {
    phase.has_equations() || is_of_values(group, term)
}

/// Whether a term reads no derivatives.
pub(super) fn is_of_values(group: &schema::Group, term: &schema::Term) -> bool {
    term.jets.iter().all(|&jet| group.jets[jet].degree.iter().all(|&degree| degree == 0))
}

/// Whether any row of a group counts at any of its points.
pub(super) fn is_any(counts: &[Vec<bool>]) -> bool {
    counts.iter().any(|row| row.contains(&true))
}
