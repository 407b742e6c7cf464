//! Whether an answer would fit better if something that its problem takes for known were otherwise: Rao's score test (1948).
//!
//! Let `r` be all rows, `J` their derivatives by the unknowns, `b` those by a number that is taken for known, and `H` the normal
//! matrix with its priors. If that number were unknown too, a Gauss-Newton step would change it by `-g / h` and lower the loss by
//! `g^2 / 2h`, with `g = b.r` and `h = b.b - (J^T b) . H^-1 (J^T b)`. One more right-hand side of the factorised matrix tells.
//! Steps are no longer than the model may be trusted.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::block::Block;
use super::course::End;
use super::normal::factor::Factor;
use super::phase::Phase;
use super::place::State;
use super::solver::Solver;
use super::surface::Surface;
use crate::facts::{Known, Score};
use crate::schema::Origin;

/// Share of a number by which it is changed to see what rows follow it.
const SMALL: f64 = 1e-4;
/// Share of what rows say of a number that must be left when the unknowns have taken theirs: below it is rounding.
const OPEN: f64 = 1e-9;
/// The longest step: a share of a number or of a cloud's radius, or an angle.
const FARTHEST: f64 = 0.3;

/// What rows say of a number.
struct Sums {
    known: Known,
    /// `J^T b`, by the coefficients, then by the unknowns of the border.
    right: Vec<f64>,
    below: Vec<f64>,
    /// `b.r` and `b.b`.
    slope: f64,
    square: f64,
}

impl Sums {
    fn add(&mut self, block: &Block, by: &[f64]) {
        let width = block.dofs.len();
        let learned = block.by_learned.len() / block.misfits.len().max(1);
        for (row, (by, misfit)) in by.iter().zip(&block.misfits).enumerate().filter(|(_, (by, _))| **by != 0.0) {
            self.slope += by * misfit;
            self.square += by * by;
            block.kept().for_each(|(at, dof)| self.right[dof as usize] += by * block.slopes[row * width + at]);
            let own = &block.by_learned[row * learned..][..learned];
            self.below.iter_mut().zip(own).for_each(|(sum, slope)| *sum += by * slope);
        }
    }
}

impl Solver {
    /// Scores of all that is [known](Solver::known), from the last step's equations if they are those of the answer; none where the matrix
    /// cannot be factorised.
    pub(super) fn scores(&mut self, end: &End) -> Option<Vec<Option<Score>>> {
        let known = self.known();
        if let (Some(linearised), Some(factor)) = (&end.linearised, &end.factor) {
            self.find_feet(linearised);
            return Some(self.scores_of(&known, linearised, factor));
        }
        let state = &end.state;
        self.find_feet(state);
        self.assemble(state, state.noise, Phase::Concave).ok()?;
        self.normal.set_free(Some(&state.free))?;
        let factor = self.normal.factor()?;
        Some(self.scores_of(&known, state, &factor))
    }

    /// Scores of some of what is known, from the normal equations as they are assembled about a state and factorised: they are
    /// those of where a step leads, as far as rows are linear. Nothing of what rows do not tell from the unknowns.
    pub(super) fn scores_of(&mut self, known: &[Known], state: &State, factor: &Factor) -> Vec<Option<Score>> {
        if known.is_empty() {
            return Vec::new();
        }
        let learned = self.set_learned(&state.learned);
        let border = self.normal.border_gradient.len();
        let sums = |&known: &Known| Sums {
            known,
            right: vec![0.0; self.heads.len()],
            below: vec![0.0; border],
            slope: 0.0,
            square: 0.0,
        };
        let mut all: Vec<Sums> = known.iter().map(sums).collect();
        let mut integral = learned.len();
        for at in 0..self.groups.len() {
            integral += self.add_group(at, state, &learned, integral, &mut all);
        }
        for surface in &self.surfaces {
            self.add_surface(surface, state, &learned, &mut all);
        }
        let score = |sums: Sums| {
            let right: Vec<f64> = sums.right.iter().map(|x| -x).collect();
            let below: Vec<f64> = sums.below.iter().map(|x| -x).collect();
            let (step, shared) = factor.solve(&right, &below)?;
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let slope = sums.slope + dot(&self.normal.gradient, &step) + dot(&self.normal.border_gradient, &shared);
            let square = sums.square + dot(&sums.right, &step) + dot(&sums.below, &shared);
            let is_open = square > OPEN * sums.square && square.is_finite();
            let change = (-slope / square).clamp(-FARTHEST, FARTHEST);
            is_open.then(|| Score { known: sums.known, gain: -change * (slope + 0.5 * square * change), change })
        };
        all.into_iter().map(score).collect()
    }

    /// What the problem takes for known: given numbers, and the place, the direction and the size of every cloud that has a
    /// frame of its own.
    pub(super) fn known(&self) -> Vec<Known> {
        let scalars = self.bound.problem.scene().schema.scalars.iter().enumerate();
        let given =
            scalars.filter(|(slot, scalar)| matches!(scalar.origin, Origin::Given(_)) && self.scalars[*slot] != 0.0);
        let given = given.map(|(slot, _)| Known::Scalar(slot));
        let clouds = 0..self.surfaces.len();
        let moved = clouds.flat_map(|cloud| {
            let axes = (0..3).flat_map(move |axis| [Known::Place { cloud, axis }, Known::Direction { cloud, axis }]);
            axes.chain([Known::Size { cloud }])
        });
        given.chain(moved).collect()
    }

    /// Adds the rows of a group, whose integrals begin there in the border; returns how many integrals it has.
    fn add_group(&self, at: usize, state: &State, learned: &[f64], first: usize, all: &mut [Sums]) -> usize {
        let group = &self.groups[at];
        if !group.has_rows() {
            return 0;
        }
        let evaluated = group.evaluate(&self.heads, &state.theta, &self.scalars, true);
        let blocks = group.blocks(&self.heads, &evaluated, learned);
        let weights = group.root_weights(&group.over_tolerances(&evaluated));
        all.par_iter_mut().for_each(|sums| {
            let Known::Scalar(slot) = sums.known else { return };
            let with = |share: f64| {
                let mut scalars = self.scalars.clone();
                scalars[slot] *= 1.0 + share;
                let evaluated = group.evaluate(&self.heads, &state.theta, &scalars, false);
                let integrals: Vec<f64> = group.sums(&evaluated, &scalars).into_iter().map(|(_, sum)| sum).collect();
                (group.over_tolerances(&evaluated), integrals)
            };
            let (more, less) = (with(SMALL), with(-SMALL));
            let slope = |(more, less): (&f64, &f64)| (more - less) / (2.0 * SMALL);
            let by = more.0.iter().zip(&less.0).map(slope).zip(&weights).map(|(by, weight)| by * weight);
            let by: Vec<f64> = by.collect();
            let mut from = 0;
            for block in &blocks {
                sums.add(block, &by[from..][..block.misfits.len()]);
                from += block.misfits.len();
            }
            for (number, by) in more.1.iter().zip(&less.1).map(slope).enumerate() {
                sums.below[first + number] += by;
                sums.square += (by / group.integral_tolerance(number)).powi(2);
            }
        });
        group.sums(&evaluated, &self.scalars).len()
    }

    /// Adds the rows of a cloud.
    fn add_surface(&self, surface: &Surface, state: &State, learned: &[f64], all: &mut [Sums]) {
        let group = &self.groups[surface.group];
        let sigma = surface.sigma(state.noise);
        let blocks = surface.blocks(group, &self.heads, &state.theta, &self.scalars, learned, sigma);
        all.par_iter_mut().for_each(|sums| {
            let moved: Vec<Vector3<f64>> = match sums.known {
                Known::Scalar(slot) => {
                    let with = |share: f64| {
                        let mut scalars = self.scalars.clone();
                        scalars[slot] *= 1.0 + share;
                        surface.images(group, &self.heads, &state.theta, &scalars)
                    };
                    let pairs = with(SMALL).into_iter().zip(with(-SMALL));
                    pairs.map(|(more, less)| (more - less) / (2.0 * SMALL)).collect()
                }
                Known::Place { cloud, .. } | Known::Direction { cloud, .. } | Known::Size { cloud }
                    if !std::ptr::eq(surface, &self.surfaces[cloud]) =>
                {
                    return;
                }
                Known::Place { axis, .. } => surface.moved(|_, radius| -Vector3::ith(axis, radius)),
                Known::Direction { axis, .. } => surface.moved(|arm, _| -Vector3::ith(axis, 1.0).cross(arm)),
                Known::Size { .. } => surface.moved(|arm, _| -arm),
            };
            let by = surface.changes(&moved, sigma);
            blocks.iter().zip(by).for_each(|(block, by)| sums.add(block, &[by]));
        });
    }
}
