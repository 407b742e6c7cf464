//! Given numbers that may be off together, and what of an answer follows them.

use super::draws::Together;
use super::scored::Asked;
use crate::facts::Known;
use crate::given::size;
use crate::problem::{Bound, Problem};
use crate::solve::vector;
use crate::units::{Number, Si};

/// Every number that may be off, once, without those that are asked about anyway.
pub(super) fn uncertain(problem: &Problem, asked: &[Known]) -> Vec<Known> {
    let mut slots: Vec<usize> = problem.uncertain.iter().flatten().map(|(slot, _)| *slot).collect();
    slots.sort_unstable();
    slots.dedup();
    slots.into_iter().map(Known::Scalar).filter(|own| !asked.contains(own)).collect()
}

/// What follows all that may be off, where this was told of what is known, of which so many scalars are learned.
pub(super) fn together(bound: &Bound, known: &[Known], told: &[Asked], learned: usize) -> Vec<Together> {
    let schema = bound.problem.scene().schema;
    let moved = |amounts: &Vec<(usize, Number<Si>)>| {
        let mut sums = [Vec::new(), Vec::new()];
        for &(slot, amount) in amounts {
            let own = known.iter().position(|known| *known == Known::Scalar(slot)).and_then(|at| told.get(at));
            let Some(Asked { follow, .. }) = own.filter(|own| !own.follow[0].is_empty()) else { continue };
            let amount = bound.system.size(&schema.scalars[slot].unit).back(amount).as_engine();
            let share = amount / size(bound.scalars[slot]);
            for (sum, follow) in sums.iter_mut().zip(follow) {
                sum.resize(follow.len(), 0.0);
                sum.iter_mut().zip(follow).for_each(|(sum, x)| *sum += share * x);
            }
        }
        let [coefficients, mut border] = sums;
        border.truncate(learned);
        Together { coefficients, learned: border }
    };
    let all = bound.problem.uncertain.iter().map(moved);
    all.filter(|moved| !moved.coefficients.is_empty()).collect()
}

/// Variance of a sum of coefficients, each times its weight, by what follows numbers that may be off.
pub(super) fn variance_of_sum(all: &[Together], weights: &[f64]) -> f64 {
    all.iter().map(|own| vector::dot(&own.coefficients, weights).powi(2)).sum()
}
