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
    /// The points of all groups that say how large heads are, in the engine's units.
    pub(super) fn points_over_domain(&self) -> Vec<&[f64]> {
        let inputs = self.scene().coordinates.len();
        self.bound.coordinates.iter().flat_map(|group| some(group, inputs)).collect()
    }

    /// Values of all heads there, `[head][point]` in the engine's units.
    pub(super) fn values_over_domain(&self) -> Vec<Vec<f64>> {
        let outward: Vec<_> = self.scene().coordinates.iter().map(|c| self.bound.system.outward(&c.unit)).collect();
        let along = self.points_over_domain().into_iter().flatten().zip(outward.iter().cycle());
        let points: Vec<f64> = along.map(|(&x, outward)| outward.of(Number::engine(x)).as_declared()).collect();
        let inward = |estimate: Estimate| {
            let inward = self.bound.system.inward(&estimate.unit);
            estimate.values.into_iter().map(|x| inward.of(Number::declared(x)).as_engine()).collect()
        };
        self.evaluate(&points).into_iter().map(inward).collect()
    }

    /// At which of these points a group reads a head, `[head][point]`: beyond its part of the domain it may be anything. Everywhere for a
    /// head that only clouds or nothing read.
    pub(super) fn read_over_domain(&self, answer: &Answer) -> Vec<Vec<bool>> {
        let mut read = vec![Vec::new(); self.scene().heads.len()];
        let kernels = self.bound.problem.scene().double();
        for ((group, facts), kernel) in self.scene().groups.iter().zip(&answer.facts).zip(kernels) {
            let own = where_read(facts, kernel.programs, group, (read.len(), &answer.scalars));
            let some = own.into_iter().map(|own| own.into_iter().step_by(step(facts.points)));
            read.iter_mut().zip(some).for_each(|(read, own)| read.extend(own));
        }
        read.iter_mut().filter(|own| !own.contains(&true)).for_each(|own| own.fill(true));
        read
    }

    /// Of values over the domain those where a group reads the head.
    pub(super) fn where_read(&self, values: &[Vec<f64>], answer: &Answer) -> Vec<Vec<f64>> {
        let read = self.read_over_domain(answer);
        values.iter().zip(&read).map(|(own, read)| where_is(own, read)).collect()
    }
}

/// What belongs to the points at which a head is read.
pub(super) fn where_is<T: Copy>(all: &[T], read: &[bool]) -> Vec<T> {
    all.iter().zip(read).filter(|(_, read)| **read).map(|(own, _)| *own).collect()
}
