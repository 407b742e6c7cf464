//! What an answer rests on: given numbers, and the frame of every cloud. [`Scored`] says what it would be if they were otherwise.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::course::End;
use super::normal::factor::Factor;
use super::phase::Phase;
use super::place::State;
use super::scored::{Asked, Scored, asked};
use super::solver::Solver;
use super::surface::Surface;
use crate::facts::Known;
use crate::given::{SMALL, given, size, slope};

impl Solver {
    /// What an answer tells of what is known, from the last step's equations if they are those of the answer; nothing where the matrix
    /// cannot be factorised.
    pub(super) fn asked(&mut self, known: &[Known], end: &End) -> Option<Vec<Asked>> {
        if let (Some(linearised), Some(factor)) = (&end.linearised, &end.factor) {
            self.find_feet(linearised);
            return Some(self.asked_of(known, linearised, factor));
        }
        let state = &end.state;
        self.find_feet(state);
        self.assemble(state, state.noise, Phase::Concave).ok()?;
        self.normal.set_free(Some(&state.free))?;
        let factor = self.normal.factor()?;
        Some(self.asked_of(known, state, &factor))
    }

    /// What is told of some of what is known, from the normal equations as they are assembled about a state and factorised: scores are
    /// those of where a step leads, as far as rows are linear.
    pub(super) fn asked_of(&mut self, known: &[Known], state: &State, factor: &Factor) -> Vec<Asked> {
        if known.is_empty() {
            return Vec::new();
        }
        let learned = self.set_learned(&state.learned);
        let border = self.normal.border_gradient.len();
        let mut all: Vec<Scored> = known.iter().map(|&known| Scored::new(known, self.heads.len(), border)).collect();
        let mut integral = learned.len();
        for at in 0..self.groups.len() {
            integral += self.add_group(at, state, &learned, integral, &mut all);
        }
        for surface in &self.surfaces {
            self.add_surface(surface, state, &learned, &mut all);
        }
        asked(&all, factor, (&self.normal.gradient, &self.normal.border_gradient), true)
    }

    /// What the problem takes for known: given numbers, and the place, the direction and the size of every cloud that has a
    /// frame of its own.
    pub(super) fn known(&self) -> Vec<Known> {
        let given = given(self.bound.problem.scene().schema, &self.scalars).into_iter().map(Known::Scalar);
        let clouds = 0..self.surfaces.len();
        let moved = clouds.flat_map(|cloud| {
            let axes = (0..3).flat_map(move |axis| [Known::Place { cloud, axis }, Known::Direction { cloud, axis }]);
            axes.chain([Known::Size { cloud }])
        });
        given.chain(moved).collect()
    }

    /// Adds the rows of a group, whose integrals begin there in the border; returns how many integrals it has.
    fn add_group(&self, at: usize, state: &State, learned: &[f64], first: usize, all: &mut [Scored]) -> usize {
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
                scalars[slot] += share * size(scalars[slot]);
                let evaluated = group.evaluate(&self.heads, &state.theta, &scalars, false);
                let integrals: Vec<f64> = group.sums(&evaluated, &scalars).into_iter().map(|(_, sum)| sum).collect();
                (group.over_tolerances(&evaluated), integrals)
            };
            let (more, less) = (with(SMALL), with(-SMALL));
            let by = more.0.into_iter().zip(less.0).map(slope).zip(&weights).map(|(by, weight)| by * weight);
            let by: Vec<f64> = by.collect();
            let mut from = 0;
            for block in &blocks {
                sums.add(block, &by[from..][..block.misfits.len()]);
                from += block.misfits.len();
            }
            for (number, by) in more.1.into_iter().zip(less.1).map(slope).enumerate() {
                sums.below[first + number] += by;
            }
        });
        group.sums(&evaluated, &self.scalars).len()
    }

    /// Adds the rows of a cloud.
    fn add_surface(&self, surface: &Surface, state: &State, learned: &[f64], all: &mut [Scored]) {
        let group = &self.groups[surface.group];
        let sigma = surface.sigma(state.noise);
        let blocks = surface.blocks(group, &self.heads, &state.theta, &self.scalars, learned, sigma);
        all.par_iter_mut().for_each(|sums| {
            let moved: Vec<Vector3<f64>> = match sums.known {
                Known::Scalar(slot) => {
                    let with = |share: f64| {
                        let mut scalars = self.scalars.clone();
                        scalars[slot] += share * size(scalars[slot]);
                        surface.images(group, &self.heads, &state.theta, &scalars)
                    };
                    let pairs = with(SMALL).into_iter().zip(with(-SMALL));
                    pairs.map(|(more, less)| (more - less) / (2.0 * SMALL)).collect()
                }
                // A cloud's rows read no column.
                Known::Offset { .. } | Known::Standing { .. } => return,
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
