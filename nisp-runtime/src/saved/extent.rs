//! Where an answer holds: the range of the points that it was found from, so that nothing is read beyond without a word.

use crate::ends::ends;
use crate::problem::Frame;
use crate::schema::Scene;
use crate::solve::fault::Fault;
use crate::solve::state::State;
use crate::units::Number;

/// Rounding of a coordinate, as a share of its range.
const ROUNDING: f64 = 1e-9;
/// How far the points of a domain may end before it does along one coordinate, as a share of their range.
const SHORT: f64 = 2e-3;

/// A range along every coordinate, and over every two coordinates the convex hull, all in declared units.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Extent {
    /// Lower and upper end of each coordinate.
    pub(crate) ranges: Vec<[f64; 2]>,
    /// How far outside of a hull a point may be along each coordinate: a hull of points lies within the domain that they are
    /// drawn from, by up to the distance of neighbours.
    slack: Vec<f64>,
    hulls: Vec<Hull>,
}

/// The corners of a hull in counter-clockwise order, over two coordinates.
#[derive(Clone, Debug, PartialEq)]
struct Hull {
    axes: [usize; 2],
    corners: Vec<[f64; 2]>,
}

impl Extent {
    /// The extent of points by group, flat and in the engine's units.
    pub(crate) fn of(frame: &Frame, groups: &[Vec<f64>]) -> Self {
        let coordinates = frame.scene.schema.coordinates;
        let axes = coordinates.len();
        let outward: Vec<_> = coordinates.iter().map(|c| frame.system.outward(&c.unit)).collect();
        let outward = &|axis: usize, x: f64| outward[axis].of(Number::engine(x)).as_declared();
        let along = |axis: usize| {
            let values = groups.iter().flat_map(move |points| points.iter().skip(axis).step_by(axes));
            values.map(move |&x| outward(axis, x))
        };
        let ranges: Vec<[f64; 2]> = (0..axes).map(|axis| ends(along(axis)).into()).collect();
        let most = groups.iter().map(|points| points.len() / axes).max().unwrap_or(1).max(1) as f64;
        // Over one coordinate both ends are among the points.
        let share = if axes == 1 { ROUNDING } else { most.powf(-1.0 / axes as f64) };
        let slack = ranges.iter().map(|[low, high]| share * (high - low)).collect();
        let pairs = (0..axes).flat_map(|a| (a + 1..axes).map(move |b| [a, b]));
        let hulls = pairs.map(|axes_of| {
            let points = groups.iter().flat_map(|points| points.chunks_exact(axes));
            let plane = points.map(|point| axes_of.map(|axis| outward(axis, point[axis])));
            Hull { axes: axes_of, corners: hull(plane.collect()) }
        });
        Self { slack, hulls: hulls.collect(), ranges }
    }

    /// True for a point, in declared units, at which the answer holds.
    pub(crate) fn contains(&self, point: &[f64]) -> bool {
        // Over one coordinate both ends are among the points, and nearly so along each of several.
        let share = if self.ranges.len() == 1 { ROUNDING } else { SHORT };
        let is_along = |([low, high], x): (&[f64; 2], &f64)| {
            let slack = share * (high - low);
            (low - slack..=high + slack).contains(x)
        };
        let is_in_range = self.ranges.iter().zip(point).all(is_along);
        is_in_range
            && self
                .hulls
                .iter()
                .all(|hull| hull.contains(hull.axes.map(|a| point[a]), hull.axes.map(|a| self.slack[a])))
    }

    pub(crate) fn save(&self, state: State) -> State {
        let state = state.with("range", self.ranges.as_flattened()).with("slack", &self.slack);
        self.hulls.iter().fold(state, |state, hull| {
            let [a, b] = hull.axes;
            state.with(&format!("hull {a} {b}"), hull.corners.as_flattened())
        })
    }

    pub(crate) fn restored(state: &State, schema: &Scene) -> Result<Self, Fault> {
        let axes = schema.coordinates.len();
        let pairs = |numbers: &[f64]| numbers.as_chunks::<2>().0.to_vec();
        let ranges = pairs(&state.sized::<f64>("range", 2 * axes)?);
        let hulls = (0..axes).flat_map(|a| (a + 1..axes).map(move |b| [a, b]));
        let hulls = hulls.map(|[a, b]| {
            let corners = pairs(state.vector(&format!("hull {a} {b}"))?);
            Ok(Hull { axes: [a, b], corners })
        });
        Ok(Self { ranges, slack: state.sized("slack", axes)?, hulls: hulls.collect::<Result<_, Fault>>()? })
    }
}

impl Hull {
    /// True for a point that no side leaves outside by more than the slack along both axes.
    fn contains(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> bool {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).all(|(from, to)| {
            let (across, along) = (to[1] - from[1], to[0] - from[0]);
            // The product of a side and the way to the point is negative outside.
            let left = along * (y - from[1]) - across * (x - from[0]);
            left >= -(across.abs() * dx + along.abs() * dy)
        })
    }
}

/// The convex hull of points (Andrew's monotone chain), counter-clockwise.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && left(a, b, point) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain
    };
    let (mut lower, mut upper) = (chain(&mut points.iter().copied()), chain(&mut points.iter().rev().copied()));
    // Each chain ends where the other begins.
    lower.pop();
    upper.pop();
    lower.append(&mut upper);
    lower
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_the_corners_and_nothing_between() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [1.0, 0.5], [0.0, 0.0]];
        assert_eq!(hull(points.to_vec()), [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        assert_eq!(hull(vec![[1.0, 2.0]]).len(), 0);
    }

    #[test]
    fn a_disc_has_no_corners() {
        let circle = (0..200).map(|i| f64::from(i) * std::f64::consts::TAU / 200.0).map(|a| [a.cos(), a.sin()]);
        let hull = Hull { axes: [0, 1], corners: hull(circle.collect()) };
        let is_inside = |x: f64, y: f64| hull.contains([x, y], [0.01, 0.01]);
        assert!(is_inside(0.0, 0.0) && is_inside(0.7, 0.7) && is_inside(1.0, 0.0) && is_inside(-0.6, 0.8));
        assert!(!is_inside(0.9, 0.9) && !is_inside(-1.1, 0.0) && !is_inside(0.75, -0.75));
    }
}
