//! Splines over the only coordinate as a carrier.

use super::carried::{Carried, Carrier, Solved, Values, heads, learned};
use super::course::Course;
use super::undetermined;
use super::{Optimizer, RecoverError, Settings, Width};
use crate::carrier::Kept;
use crate::facts::Answer;
use crate::noise;
use crate::problem::Bound;
use crate::splines::{self, SplineSolution};

/// Splines over the only coordinate.
pub(super) struct OnSplines;

impl Carrier for OnSplines {
    fn name(&self) -> &'static str {
        splines::CARRIER
    }

    fn is_witness(&self) -> bool {
        true
    }

    fn solve(&self, bound: &Bound, _: &Settings, mut course: Course<'_, '_>) -> Result<Solved, RecoverError> {
        if let Some(what) = splines::refused(bound.problem.scene().schema) {
            return Err(RecoverError::Splines(what));
        }
        let (limits, from) = (course.left(), course.from);
        let (noise, conditions) = (noise::estimate(bound), undetermined::conditions(bound));
        let mut found =
            splines::solve(bound, &noise, &conditions, limits, from, &mut |progress| course.watch(progress))?;
        found.warnings.extend(undetermined::of_splines(bound, &found));
        Ok(Solved {
            status: found.status,
            loss: found.loss,
            iterations: found.iterations,
            warnings: found.warnings.clone(),
            state: found.checkpoint.clone(),
            optimizer: Optimizer::Evidence,
            method: "gauss-newton",
            precision: Width::F64,
            carried: Box::new(found),
        })
    }
}

impl Carried for SplineSolution {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        (0..heads(bound)).map(|head| Values::plain(self.kept.evaluate(head, points))).collect()
    }

    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let mut all = self.values(bound, points);
        all.iter_mut().enumerate().for_each(|(head, own)| own.deviations = self.kept.deviations(head, points));
        all
    }

    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)> {
        learned(bound, self.kept.learned().into_iter())
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
