//! The normal equations about a state: rows of all groups and clouds, and priors. The prior of the sources is majorised anew
//! for every step.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use super::block::Block;
use super::draws::{Deviations, Draws};
use super::heads::Heads;
use super::phase::Phase;
use super::place::State;
use super::prior::Sparse;
use super::solver::Solver;
use super::unseen::Unseen;
use super::{Local, LocalError};
use crate::problem::Bound;
use crate::solve::driver::Warning;
use crate::solve::fault::Fault;

/// Stiffness of coefficients, and of their differences, for those that rows hardly see: functions at the edge of the domain.
const RIDGE: f64 = 1e-6;
const STIFFNESS: f64 = 1e-3;
/// Length over which the first step, which only regresses the data, smooths them, in cells: noise cannot crease the state.
const SMOOTHED: f64 = 2.0;
/// Random vectors for the trace of the influence matrix (Hutchinson).
const PROBES: usize = 2;
/// Stiffness of a parameter that is held.
const HELD: f64 = 1e30;

impl Solver {
    /// The normal equations about a state whose feet are found; also the loss, how many rows there are, and random
    /// combinations of the clouds' rows.
    pub(super) fn assemble(
        &mut self,
        state: &State,
        noise: f64,
        phase: Phase,
    ) -> Result<(f64, usize, Vec<Vec<f64>>), LocalError> {
        let slopes = self.set_learned(&state.learned);
        let theta = &state.theta;
        let regress = phase == Phase::Regress;
        self.surfaces.iter_mut().for_each(|surface| surface.set_near(phase == Phase::Concave));
        let mut probes = vec![vec![0.0; theta.len()]; PROBES];
        let mut random = StdRng::seed_from_u64(0);
        self.normal.clear();
        let (mut loss, mut rows) = (0.0, 0);
        for group in &self.groups {
            // The first step regresses data and pointwise conditions; equations come after.
            if regress && !group.tests.is_empty() {
                continue;
            }
            if !group.has_rows() {
                continue;
            }
            let evaluated = group.evaluate(&self.heads, theta, &self.scalars, true);
            let blocks = group.blocks(&self.heads, &evaluated, &slopes);
            for block in &blocks {
                loss += half_square(block, |at| {
                    Fault::residual(group.name(at), group.first_without_value(&evaluated, at))
                })?;
                rows += block.misfits.len();
            }
            self.normal.add_all(&blocks);
            if regress {
                continue;
            }
            for (_, integral) in group.integrals(&self.heads, &evaluated, &self.scalars, &slopes) {
                loss += 0.5 * (integral.misfit / integral.sigma).powi(2);
                self.normal.add_dense(&integral);
            }
        }
        for surface in &self.surfaces {
            let group = &self.groups[surface.group];
            // Before the equations are solved, clouds are farther off than their noise.
            let sigma = if regress { noise } else { surface.sigma(noise) };
            let blocks = surface.blocks(group, &self.heads, theta, &self.scalars, &slopes, sigma);
            for block in &blocks {
                let term = || format!("{}.{}", group.schema.name, surface.term);
                half_square(block, |_| Fault::residual(term(), None))?;
                for probe in &mut probes {
                    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
                    block.kept().for_each(|(at, dof)| probe[dof as usize] += sign * block.slopes[at]);
                }
            }
            self.normal.add_all(&blocks);
            rows += surface.misfits().count();
            loss += surface.loss(sigma);
        }
        for (at, parameter) in state.learned.iter().enumerate() {
            // Parameters wait until the state is one of the equations' solutions. Their own scale is of the order of one.
            let stiffness = if matches!(phase, Phase::Regress | Phase::Convex { held: true }) { HELD } else { 1e-2 };
            self.normal.add_learned(at, stiffness, 1e-2 * parameter);
        }
        self.add_priors(state, noise, regress, phase == Phase::Concave);
        for at in 0..theta.len() {
            self.normal.add_stiffness(at, RIDGE);
        }
        Ok((loss, rows, probes))
    }

    /// Priors of sources, or of all heads' roughness while only data are regressed.
    fn add_priors(&mut self, state: &State, noise: f64, regress: bool, concave: bool) {
        let theta = &state.theta;
        let schema = self.bound.problem.scene().schema;
        for (head, declared) in schema.heads.iter().enumerate() {
            let first = self.heads.first[head];
            if !regress {
                let learned = state.learned.len();
                self.normal.add_all(&self.heads.continued(head, &self.outer[head], theta, learned));
            }
            let stiffness = if regress {
                let seen = self.normal.typical(first..self.heads.first[head + 1]);
                (SMOOTHED * SMOOTHED * seen).max(STIFFNESS)
            } else {
                STIFFNESS
            };
            for axis in (0..schema.coordinates.len()).filter(|_| regress || !declared.source) {
                for (a, b) in self.heads.lattices[head].neighbours(axis) {
                    let (i, j) = (first + a as usize, first + b as usize);
                    self.normal.add_difference([i, j], stiffness, theta[j] - theta[i]);
                }
            }
            if regress {
                continue;
            }
            // The answer is what the prior says where nothing was seen; its deviations are not.
            let unseen = self.normal.draws.as_ref().and_then(|_| self.unseen(head));
            let Some(sparse) = sparse(&self.bound, &self.settings, &self.heads, head, noise / self.cell) else {
                continue;
            };
            let sparse = Sparse { unseen, ..sparse };
            sparse.add(&mut self.normal, theta, concave);
        }
    }

    /// Where no cloud saw the surface that a source with a prior acts on. A source on a face of a body is told by the shape of the
    /// rest.
    fn unseen(&self, head: usize) -> Option<Unseen> {
        let lattice = &self.heads.lattices[head];
        let is_on_face = self.settings.source_dimensions < lattice.dimensions();
        self.settings.patches.filter(|_| !is_on_face).and_then(|_| Unseen::of(&self.surfaces, lattice))
    }

    /// Says which sources act where no cloud saw the surface.
    pub(super) fn rests_on_the_prior(&self) -> Vec<Warning> {
        let heads = self.bound.problem.scene().schema.heads.iter().enumerate().filter(|(_, head)| head.source);
        heads.filter_map(|(at, head)| Some(self.unseen(at)?.warning(head.name))).collect()
    }

    /// What priors add to the loss, but for a constant.
    pub(super) fn penalty(&self, state: &State, noise: f64, concave: bool) -> f64 {
        let schema = self.bound.problem.scene().schema;
        let sources = schema.heads.iter().enumerate().filter(|(_, head)| head.source);
        let of_sources: f64 = sources
            .filter_map(|(head, _)| {
                let sparse = sparse(&self.bound, &self.settings, &self.heads, head, noise / self.cell)?;
                Some(sparse.value(&state.theta, concave))
            })
            .sum();
        of_sources + state.learned.iter().map(|x| 0.5e-2 * x * x).sum::<f64>()
    }

    /// Half the sum of squares of all rows.
    pub(super) fn loss(&mut self, state: &State, noise: f64) -> f64 {
        self.find_feet(state);
        let groups = self.groups.iter().map(|group| group.loss(&self.heads, &state.theta, &self.scalars));
        groups.sum::<f64>() + self.surfaces.iter().map(|surface| surface.loss(surface.sigma(noise))).sum::<f64>()
    }

    /// Deviations of all unknowns, drawn from the posterior about a state. The patch is taken as it is: what the prior
    /// holds at zero stays there, where it was seen.
    pub(super) fn deviations(&mut self, state: &State) -> Option<Deviations> {
        self.find_feet(state);
        self.normal.draws = Some(Draws::new(state.theta.len(), state.learned.len()));
        let assembled = self.assemble(state, state.noise, Phase::Concave);
        let draws = self.normal.draws.take()?;
        assembled.ok()?;
        self.normal.set_free(None)?;
        self.normal.factor()?.deviations(&draws)
    }
}

/// The prior of a head where the clouds are off by `noise` cells; none of a field, or where nothing is known.
pub(super) fn sparse<'a>(
    bound: &Bound,
    settings: &Local,
    heads: &'a Heads,
    head: usize,
    noise: f64,
) -> Option<Sparse<'a>> {
    let declared = &bound.problem.scene().schema.heads[head];
    let prior = settings.patches.filter(|_| declared.source)?;
    let is_below = heads.limits[head].is_some_and(|limits| limits.is_below(heads.offset[head]));
    let sign = if is_below { -1.0 } else { 1.0 };
    let level = prior.least(bound, head) / heads.scale[head] * sign;
    Some(Sparse {
        heads,
        head,
        prior,
        level,
        finer: settings.finer,
        dimensions: settings.source_dimensions,
        noise,
        unseen: None,
    })
}

/// The loss of a block's rows; `fault` says of a row that it is not finite.
fn half_square(block: &Block, fault: impl Fn(usize) -> Fault) -> Result<f64, LocalError> {
    match block.misfits.iter().position(|misfit| !misfit.is_finite()) {
        Some(row) => Err(LocalError::Fault(fault(row))),
        None => Ok(block.misfits.iter().map(|misfit| 0.5 * misfit * misfit).sum::<f64>() + block.excess),
    }
}
