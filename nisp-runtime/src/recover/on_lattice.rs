//! Local functions as a carrier.

use nalgebra::{Cholesky, DMatrix};

use super::carried::{Carried, Carrier, Solved, Values, heads, learned};
use super::course::Course;
use super::{Optimizer, RecoverError, Settings, Width, undetermined};
use crate::carrier::Kept;
use crate::facts::Answer;
use crate::local::{self, Live, Local, LocalSolution, smooth};
use crate::noise;
use crate::problem::Bound;
use crate::solve::driver::Warning;

impl Carrier for Local {
    fn name(&self) -> &'static str {
        local::CARRIER
    }

    fn solve(&self, bound: &Bound, _: &Settings, course: Course<'_, '_>) -> Result<Solved, RecoverError> {
        sought(bound, self, course).map(|(solved, _)| solved)
    }
}

/// Splines on a lattice over several coordinates, for measured fields and smooth sources.
pub(super) struct OnLattice;

impl Carrier for OnLattice {
    fn name(&self) -> &'static str {
        smooth::METHOD
    }

    fn is_witness(&self) -> bool {
        true
    }

    fn solve(&self, bound: &Bound, _: &Settings, mut course: Course<'_, '_>) -> Result<Solved, RecoverError> {
        if let Some(what) = smooth::refused(bound.problem.scene().schema) {
            return Err(RecoverError::Splines(what));
        }
        let (limits, from) = (course.left(), course.from);
        let noise = noise::estimate(bound).with_clouds(bound);
        let found = smooth::solve(bound, &noise, limits, from, &mut |progress| course.watch(progress))?;
        let open = undetermined::of_local(bound, &found);
        Ok(solved(found, open, Optimizer::Evidence))
    }
}

/// A problem solved within the limits of a course; also what goes on from its answer to other data.
pub(super) fn sought(bound: &Bound, local: &Local, mut course: Course<'_, '_>) -> Result<(Solved, Live), RecoverError> {
    let (found, live) = local::solve(bound, local, course.left(), course.from, &mut |progress| course.watch(progress))?;
    let open = undetermined::of_local(bound, &found);
    Ok((solved(found, open, Optimizer::Marquardt), live))
}

/// An answer on its lattices, of which `open` says what the data leave open.
pub(super) fn solved(found: LocalSolution, open: Vec<Warning>, optimizer: Optimizer) -> Solved {
    Solved {
        status: found.status,
        loss: found.loss,
        iterations: found.iterations,
        warnings: found.warnings.iter().cloned().chain(open).collect(),
        state: found.checkpoint.clone(),
        optimizer,
        method: "gauss-newton",
        precision: Width::F64,
        carried: Box::new(found),
    }
}

impl Carried for LocalSolution {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        (0..heads(bound)).map(|head| Values::plain(self.kept.evaluate(head, points))).collect()
    }

    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let mut all = self.values(bound, points);
        all.iter_mut().enumerate().for_each(|(head, own)| own.deviations = self.kept.deviations(head, points));
        all
    }

    fn deviation_of_sum(&self, head: usize, points: &[f64], weights: &[f64]) -> Option<f64> {
        LocalSolution::deviation_of_sum(self, head, points, weights)
    }

    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)> {
        learned(bound, self.kept.learned.iter().enumerate().map(|(at, &x)| (x, self.learned_deviation(at))))
    }

    fn together(&self, bound: &Bound, learned: &[usize]) -> Option<Vec<Vec<f64>>> {
        let covariance = DMatrix::from_row_slice(learned.len(), learned.len(), &self.covariance_of(learned)?);
        let root = Cholesky::new(covariance)?.unpack();
        let amount = |(row, &at): (usize, &usize), direction: usize| {
            root[(row, direction)] * bound.learned[at].map.at(self.kept.learned[at]).1
        };
        let direction = |direction: usize| learned.iter().enumerate().map(|at| amount(at, direction)).collect();
        Some((0..learned.len()).map(direction).collect())
    }

    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>) {
        self.misfits[group][term].clone()
    }

    fn answer(&mut self, _: &Bound) -> Answer {
        self.answer.clone()
    }

    fn kept(&mut self, bars: bool) -> Box<dyn Kept> {
        Box::new(if bars { self.kept.clone() } else { self.kept.without_bars() })
    }
}
