//! What an answer says all over its domain.

use super::Solution;
use crate::carrier::Estimate;
use crate::facts::Answer;
use crate::reads::where_read;
use crate::units::Number;

/// Points of a group that say how large a head is, at most.
const MOST: usize = 2000;

/// Every so many of a group's points say how large a head is.
fn step(points: usize) -> usize {
    points.div_ceil(MOST).max(1)
}

/// Those of a group's points that say how large a head is.
pub(super) fn some(points: &[f64], inputs: usize) -> impl Iterator<Item = &[f64]> {
    points.chunks_exact(inputs).step_by(step(points.len() / inputs))
}

impl Solution {
    /// Values of all heads at points of all groups, `[head][point]` in the engine's units.
    pub(super) fn values_over_domain(&self) -> Vec<Vec<f64>> {
        let inputs = self.scene().coordinates.len();
        let outward: Vec<_> = self.scene().coordinates.iter().map(|c| self.bound.system.outward(&c.unit)).collect();
        let some = |group: &Vec<f64>| {
            let along = some(group, inputs).flatten().zip(outward.iter().cycle());
            along.map(|(&x, outward)| outward.of(Number::engine(x)).as_declared()).collect::<Vec<f64>>()
        };
        let points: Vec<f64> = self.bound.coordinates.iter().flat_map(some).collect();
        let inward = |estimate: Estimate| {
            let inward = self.bound.system.inward(&estimate.unit);
            estimate.values.into_iter().map(|x| inward.of(Number::declared(x)).as_engine()).collect()
        };
        self.evaluate(&points).into_iter().map(inward).collect()
    }

    /// Of values over the domain those where a group reads the head: beyond its part of the domain it may be anything. All of a head
    /// that only clouds or nothing read.
    pub(super) fn where_read(&self, values: Vec<Vec<f64>>, answer: &Answer) -> Vec<Vec<f64>> {
        let mut read = vec![Vec::new(); values.len()];
        let kernels = self.bound.problem.scene().double();
        for ((group, facts), kernel) in self.scene().groups.iter().zip(&answer.facts).zip(kernels) {
            let own = where_read(facts, kernel.programs, group, (values.len(), &answer.scalars));
            let some = own.into_iter().map(|own| own.into_iter().step_by(step(facts.points)));
            read.iter_mut().zip(some).for_each(|(read, own)| read.extend(own));
        }
        let own = |(values, read): (Vec<f64>, Vec<bool>)| {
            let own: Vec<f64> = values.iter().zip(&read).filter(|(_, read)| **read).map(|(value, _)| *value).collect();
            if own.is_empty() { values } else { own }
        };
        values.into_iter().zip(read).map(own).collect()
    }
}
