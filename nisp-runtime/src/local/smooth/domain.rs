//! Where a group holds, of which points are all that is known.

use crate::ends::ranges;
use crate::local::lattice::MOST_COORDINATES;
use crate::nearest::Nearest;
use crate::problem::Bound;

/// How far a neighbour may be, over the mean distance of the points; and how many points at most that distance is taken from.
const AROUND: f64 = 2.0;
const FEW: usize = 800;

/// A place in a domain, filled up with zeros.
type Place = [f64; MOST_COORDINATES];

/// A domain, by the points of a group in it and those of conditions on its sides. Lengths are over the largest range of those that share a scale:
/// points are even in these, however long and narrow the domain is.
pub(super) struct Domain {
    low: Vec<f64>,
    widths: Vec<f64>,
    points: Vec<Place>,
    /// The same points, to be searched; nothing where there are none.
    tree: Option<Nearest<MOST_COORDINATES>>,
    around: f64,
}

impl Domain {
    /// The domain of a group.
    pub(super) fn new(bound: &Bound, group: usize) -> Self {
        let schema = bound.problem.scene().schema;
        let scales: Vec<usize> = schema.coordinates.iter().map(|axis| axis.scale_group).collect();
        let order = schema.groups[group].order;
        let conditions = (0..schema.groups.len()).filter(|&at| schema.groups[at].is_condition_of(order));
        let conditions = conditions.flat_map(|at| &bound.coordinates[at]).copied().collect::<Vec<f64>>();
        Self::of(&bound.coordinates[group], &conditions, &scales)
    }

    /// The domain of points inside and on the sides, given flat; coordinates with the same number share a scale.
    fn of(inside: &Vec<f64>, sides: &[f64], scales: &[usize]) -> Self {
        let inputs = scales.len();
        let ranges = ranges([inside], inputs);
        let width = |axis: usize| (ranges[axis].1 - ranges[axis].0).max(f64::MIN_POSITIVE);
        let tied = |axis: usize| (0..inputs).filter(move |&other| scales[other] == scales[axis]);
        let widths: Vec<f64> = (0..inputs).map(|axis| tied(axis).map(width).fold(0.0, f64::max)).collect();
        let volume = (0..inputs).map(|axis| width(axis) / widths[axis]).product::<f64>();
        let around = AROUND * (volume / (inside.len() / inputs).min(FEW) as f64).powf((inputs as f64).recip());
        let low = ranges.iter().map(|range| range.0).collect();
        let mut domain = Self { low, widths, points: Vec::new(), tree: None, around };
        let all = inside.chunks_exact(inputs).chain(sides.chunks_exact(inputs));
        domain.points = all.map(|point| domain.scaled(point)).collect();
        domain.tree = Nearest::of(&domain.points);
        domain
    }

    fn scaled(&self, point: &[f64]) -> Place {
        let mut place = Place::default();
        let along = point.iter().zip(self.low.iter().zip(&self.widths));
        place.iter_mut().zip(along).for_each(|(own, (x, (low, width)))| *own = (x - low) / width);
        place
    }

    /// Whether there are points on all sides of this one, none of them far: on either side along every coordinate. Where conditions are
    /// missing, points do not reach the sides.
    pub(super) fn is_inside(&self, point: &[f64]) -> bool {
        let place = self.scaled(point);
        let Some(tree) = &self.tree else { return false };
        let mut is_seen = vec![[false; 2]; self.low.len()];
        for near in tree.by_distance(&place).take_while(|near| near.distance <= self.around) {
            for (sides, (a, b)) in is_seen.iter_mut().zip(place.iter().zip(&self.points[near.index])) {
                sides[usize::from(b > a)] = true;
            }
            if is_seen.iter().all(|sides| *sides == [true; 2]) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Points of an even grid over a box from the origin, those of which count for which something is true.
    fn grid(sides: [f64; 2], pieces: [usize; 2], counts: impl Fn(f64, f64) -> bool) -> Vec<f64> {
        let along = |axis: usize, at: usize| sides[axis] * at as f64 / pieces[axis] as f64;
        let all = (0..=pieces[1]).flat_map(|j| (0..=pieces[0]).map(move |i| [along(0, i), along(1, j)]));
        all.filter(|&[x, y]| counts(x, y)).flatten().collect()
    }

    /// A disc in a box: what is inside by a little is inside, what is outside by more than a neighbour may be away is not.
    #[test]
    fn points_tell_a_disc_from_the_corners_of_its_box() {
        let domain = Domain::of(&grid([2.0, 2.0], [40, 40], |x, y| (x - 1.0).hypot(y - 1.0) <= 1.0), &[], &[0, 0]);
        let mut random = StdRng::seed_from_u64(3);
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..2000 {
            let [x, y]: [f64; 2] = std::array::from_fn(|_| 2.4 * random.random::<f64>() - 0.2);
            let far = (x - 1.0).hypot(y - 1.0);
            if far < 0.9 {
                assert!(domain.is_inside(&[x, y]), "{x} {y}");
                inside += 1;
            } else if far > 1.0 + 2.0 * domain.around {
                assert!(!domain.is_inside(&[x, y]), "{x} {y}");
                outside += 1;
            }
        }
        assert!(inside > 500 && outside > 200, "{inside} {outside}");
    }

    #[test]
    fn a_strip_beside_the_points_belongs_to_the_domain_if_conditions_are_behind_it() {
        let inner = grid([1.0, 1.0], [20, 20], |x, y| x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0);
        let wall: Vec<f64> = (0..=20).flat_map(|at| [0.0, at as f64 / 20.0]).collect();
        let beside = [0.02, 0.513];
        assert!(!Domain::of(&inner, &[], &[0, 0]).is_inside(&beside));
        assert!(Domain::of(&inner, &wall, &[0, 0]).is_inside(&beside));
        assert!(!Domain::of(&inner, &wall, &[0, 0]).is_inside(&[-0.02, 0.513]));
    }

    /// A long and narrow domain with as many points along either side: over a scale of its own each side is as wide as the other.
    #[test]
    fn lengths_without_a_common_scale_count_by_their_ranges() {
        let points = grid([1e3, 1e-3], [20, 20], |_, _| true);
        assert!(Domain::of(&points, &[], &[0, 1]).is_inside(&[512.0, 5.12e-4]));
        assert!(!Domain::of(&points, &[], &[0, 1]).is_inside(&[512.0, -1e-5]));
    }
}
