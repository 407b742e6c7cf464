//! What is in either of two regions, or in one and not in the other.
//!
//! There are no closed forms: sizes come from points that fill the smaller region evenly, and are exact where it lies wholly inside
//! or outside of the other.

use super::{Domain, Points, Sampling};

/// Points that tell how large what both have in common is.
const PROBES: usize = 1 << 14;
/// Points of a boundary that tell how much of it is left.
const TRIAL: usize = 4096;
/// Share of a region's extent by which a point is moved to tell the sides of a boundary apart.
const ASIDE: f64 = 1e-7;

/// Two regions of the same coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    pub(super) first: Domain,
    pub(super) second: Domain,
    /// True for what is in either, false for what is in the first and not in the second.
    pub(super) either: bool,
    /// Length, area or volume.
    pub(super) measure: f64,
}

impl Pair {
    pub(super) fn new(first: Domain, second: Domain, either: bool) -> Self {
        let (probed, other) = if first.measure() < second.measure() { (&first, &second) } else { (&second, &first) };
        let probes = probed.interior(PROBES, Sampling::Sobol, 0);
        let inside = probes.iter().filter(|point| other.contains(point)).count();
        let common = probed.measure() * inside as f64 / probes.len().max(1) as f64;
        let only = first.measure() - common;
        let measure = if either { only + second.measure() } else { only };
        Self { first, second, either, measure }
    }

    pub(super) fn contains(&self, point: &[f64]) -> bool {
        let (first, second) = (self.first.contains(point), self.second.contains(point));
        if self.either { first || second } else { first && !second }
    }

    pub(super) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut low, mut high) = self.first.bounds();
        if self.either {
            let (other_low, other_high) = self.second.bounds();
            low.iter_mut().zip(other_low).for_each(|(own, other)| *own = own.min(other));
            high.iter_mut().zip(other_high).for_each(|(own, other)| *own = own.max(other));
        }
        (low, high)
    }

    /// About `count` points of both boundaries, as far as they bound what the pair is.
    pub(super) fn boundary(&self, count: usize) -> Points {
        let share = |points: &Points| points.weights.iter().flatten().sum::<f64>();
        let trial = [self.kept(&self.first, TRIAL, false), self.kept(&self.second, TRIAL, true)];
        let total: f64 = trial.iter().map(share).sum();
        let mut out = self.kept(&self.first, 0, false);
        for ((part, is_second), found) in [(&self.first, false), (&self.second, true)].into_iter().zip(&trial) {
            if share(found) > 0.0 {
                // So many on all of it that those which are kept are as dense as those of the other one.
                let all = count as f64 * part.boundary_measure() / total;
                out.append(self.kept(part, all.ceil() as usize, is_second));
            }
        }
        out
    }

    /// Those points of a part's boundary that bound the pair, with its normals.
    fn kept(&self, part: &Domain, count: usize, is_second: bool) -> Points {
        let mut out = Points { dim: part.dim(), coords: vec![], normals: Some(vec![]), weights: Some(vec![]) };
        if count == 0 {
            return out;
        }
        let (low, high) = self.bounds();
        let aside = ASIDE * low.iter().zip(&high).map(|(a, b)| b - a).fold(0.0, f64::max);
        let all = part.boundary(count);
        for (index, point) in all.iter().enumerate() {
            let sign = if is_second && !self.either { -1.0 } else { 1.0 };
            let normal: Vec<f64> = all.normal(index).unwrap_or_default().iter().map(|x| sign * x).collect();
            let beside =
                |way: f64| -> Vec<f64> { point.iter().zip(&normal).map(|(x, n)| x + way * aside * n).collect() };
            let (inner, outer) = (beside(-1.0), beside(1.0));
            // Where both boundaries run along each other, the first one has the points.
            let is_firsts = is_second && self.first.contains(&inner) && !self.first.contains(&outer);
            if self.contains(&inner) && !self.contains(&outer) && !is_firsts {
                out.add(point, &normal, all.weights.as_ref().map_or(0.0, |weights| weights[index]));
            }
        }
        out
    }
}
