//! Partners of points at the edge of a domain: those on its opposite side.

use nisp::schema::{Group, Portion, Region};

use crate::error::PrepareError;
use crate::places::Placed;

/// Refuses pairs of which nothing says the partners.
///
/// # Errors
/// A group of pairs that lies neither on the boundary of an interval or a box nor at a domain's start or end.
pub fn require_partners(group: &Group) -> Result<(), PrepareError> {
    let has_opposite = group.place.is_some_and(|place| match place.portion {
        Portion::Boundary => matches!(place.domain.first(), Some(Region::Box(_))),
        Portion::Start | Portion::End => true,
        Portion::Inside => false,
    });
    if group.paired && !has_opposite { Err(PrepareError::Unpaired { group: group.name }) } else { Ok(()) }
}

/// Gives each point of a portion its partner across a domain between two corners: on a boundary across the side that it lies on, at
/// the start the same place at the end, and the other way round.
pub(crate) fn pair(placed: &mut Placed, portion: Portion, (low, high): &(Vec<f64>, Vec<f64>)) {
    let axes = low.len();
    let is_across = |point: usize, axis: usize| match portion {
        Portion::Boundary => placed.normals.get(axis).is_some_and(|entries| entries[point] != 0.0),
        _ => axis + 1 == axes,
    };
    let across = |(at, x): (usize, &f64)| {
        let axis = at % axes;
        if is_across(at / axes, axis) { low[axis] + high[axis] - x } else { *x }
    };
    placed.points.partners = placed.points.coordinates.iter().enumerate().map(across).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::places::Body;
    use std::path::Path;

    /// The partner of a partner is the point, and both lie on opposite sides.
    #[test]
    fn partners_lie_on_the_opposite_side() {
        let regions = [Region::Box(&[[1.0, 4.0], [-2.0, 0.0]]), Region::Box(&[[0.0, 5.0]])];
        let body = Body::new(&regions, &[], Path::new("")).unwrap();
        for portion in [Portion::Boundary, Portion::Start, Portion::End] {
            let mut placed = body.sample(portion, 60);
            pair(&mut placed, portion, &body.bounds());
            let (points, partners) = (&placed.points.coordinates, &placed.points.partners);
            assert_eq!(points.len(), partners.len());
            for (a, b) in points.chunks(3).zip(partners.chunks(3)) {
                let moved: Vec<usize> = (0..3).filter(|&axis| a[axis] != b[axis]).collect();
                let [axis] = moved[..] else { panic!("{a:?} and {b:?}") };
                assert_eq!(portion == Portion::Boundary, axis < 2);
                let (low, high) = body.bounds();
                let mut ends = [a[axis], b[axis]];
                ends.sort_by(f64::total_cmp);
                assert_eq!(ends, [low[axis], high[axis]]);
            }
        }
    }
}
