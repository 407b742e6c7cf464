//! Where fields are singular though all conditions agree: at corners of a domain that point inwards, and where a part of a side with its value
//! given ends. Second derivatives grow without bounds there, and no spline follows them. Asked for an equation beside such a place, splines
//! make up a source there.

use std::num::NonZero;

use nalgebra::DMatrix;

use super::clashes::rows;
use super::shares::width;
use crate::local::lattice::{Lattice, MOST_COORDINATES};
use crate::nearest::{Nearest, Neighbour};
use crate::problem::Bound;
use crate::solve::outcome::Warning;

/// Neighbours of a point on the boundary, and inside, by which such a place is told.
const NEAR: NonZero<usize> = NonZero::new(24).unwrap();
/// Of these neighbours the nearest ones, among which a corner is as sharp as among all, and an arc is not.
const NEAREST: usize = 8;
/// Spread of the boundary across itself over that along it, squared, from which on it has a corner: one that turns by 48 degrees.
const SHARP: f64 = 0.2;
/// Mean cosine of the angles between the points inside and the direction that the boundary turns to. In a right angle it is 0.9, and
/// outside of one -0.3.
const OUTWARDS: f64 = 0.3;
/// Points of either part, at least, where a part of a side ends.
const PART: usize = 8;
/// Cells of a lattice on either side in which splines are far from what they should follow: as many as a hat is wide, and a half, since the
/// place lies somewhere in a cell.
const CELLS: f64 = 2.5;

type Place = [f64; MOST_COORDINATES];

/// A place where fields are singular, by its coordinates in space. Over others, like time, it is one all along.
#[derive(Clone)]
pub(super) struct Singularity {
    axes: Vec<usize>,
    /// A point there; other coordinates than those in space are of no account.
    point: Vec<f64>,
}

impl Singularity {
    /// Whether a point is so close that splines on a lattice do not follow the fields there.
    pub(super) fn is_near(&self, lattice: &Lattice, point: &[f64]) -> bool {
        let (_, spacing, _) = lattice.parts();
        self.axes.iter().all(|&axis| (point[axis] - self.point[axis]).abs() < CELLS * spacing[axis])
    }
}

/// Tells the user of such places; nothing where there are none.
pub(super) fn warning(bound: &Bound, all: &[Singularity]) -> Option<Warning> {
    let places: Vec<String> = all.iter().map(|own| bound.place_along(&own.axes, &own.point)).collect();
    (!places.is_empty()).then(|| Warning::singular(&places.join("; ")))
}

/// Places where the fields of a problem are singular. Coordinates of one scale make up the space.
pub(super) fn singularities(bound: &Bound) -> Vec<Singularity> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let scale = |axis: usize| schema.coordinates[axis].scale_group;
    let is_shared = |&axis: &usize| (0..inputs).any(|other| other != axis && scale(other) == scale(axis));
    let axes: Vec<usize> = (0..inputs).filter(is_shared).collect();
    if axes.is_empty() {
        return Vec::new();
    }
    // A condition at the start holds all over the space.
    let along = |at: usize, axis: usize| bound.coordinates[at].iter().skip(axis).step_by(inputs);
    let is_wall = |&at: &usize| {
        let is_one = |axis: usize| along(at, axis).is_sorted_by(|a, b| a == b);
        (0..inputs).all(|axis| axes.contains(&axis) || !is_one(axis))
    };
    let walls: Vec<usize> = schema.conditions().into_iter().filter(is_wall).collect();
    let others = (0..schema.groups.len()).filter(|at| !walls.contains(at));
    let size = axes.iter().map(|&axis| width(bound, &walls, axis)).fold(0.0, f64::max);
    let points = |at: usize| bound.coordinates[at].chunks_exact(inputs);
    let place = |point: &[f64]| {
        let mut place = Place::default();
        place.iter_mut().zip(&axes).for_each(|(own, &axis)| *own = point[axis] / size);
        place
    };
    let sides = walls.iter().flat_map(|&at| points(at).map(place).zip(given(bound, at)));
    let sides: Vec<Side> = sides.map(|(place, given)| Side { place, given }).collect();
    let inside: Vec<Place> = others.flat_map(points).map(place).collect();
    let singularity = |place: Place| {
        let mut point = vec![0.0; inputs];
        axes.iter().zip(place).for_each(|(&axis, x)| point[axis] = x * size);
        Singularity { axes: axes.clone(), point }
    };
    singular(&sides, &inside, axes.len()).into_iter().map(singularity).collect()
}

/// The heads whose values a group's conditions give, by point.
fn given(bound: &Bound, group: usize) -> Vec<Vec<usize>> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let count = bound.coordinates[group].len() / inputs;
    let mut given = vec![Vec::new(); count];
    for (number, row) in rows(bound, group, &vec![1.0; inputs]).into_iter().enumerate() {
        let read = schema.groups[group].jets.iter().zip(row.slopes).filter(|(_, slope)| *slope != 0.0);
        let read: Vec<_> = read.map(|(jet, _)| jet).collect();
        if read.iter().all(|jet| jet.is_value()) {
            given[number % count].extend(read.iter().map(|jet| jet.head));
        }
    }
    given
}

/// A point on the boundary: where it is, and the heads whose values are given there.
struct Side {
    place: Place,
    given: Vec<usize>,
}

/// Singular places of a boundary, by points on it and inside: the mean of such points beside each other.
fn singular(sides: &[Side], inside: &[Place], dimensions: usize) -> Vec<Place> {
    let boundary: Vec<Place> = sides.iter().map(|side| side.place).collect();
    let (Some(on_boundary), Some(interior)) = (Nearest::of(&boundary), Nearest::of(inside)) else {
        return Vec::new();
    };
    let near: Vec<Vec<Neighbour>> = boundary.iter().map(|own| on_boundary.some(own, NEAR)).collect();
    let sharp: Vec<f64> =
        boundary.iter().zip(&near).map(|(own, near)| sharpness(own, near, &boundary, dimensions)).collect();
    let is_singular = |at: usize| {
        let sharpest = near[at].iter().map(|next| sharp[next.index]).fold(sharp[at], f64::max);
        if sharpest <= SHARP {
            return is_end(&sides[at], &near[at].iter().map(|next| &sides[next.index]).collect::<Vec<&Side>>());
        }
        sharp[at] == sharpest && points_inwards(&boundary[at], (&near[at], &boundary), (&interior, inside))
    };
    let mut clusters: Vec<(f64, Vec<Place>)> = Vec::new();
    for (at, own) in boundary.iter().enumerate().filter(|(at, _)| is_singular(*at)) {
        let is_beside = |(radius, places): &&mut (f64, Vec<Place>)| norm(&offset(own, &places[0])) <= *radius;
        match clusters.iter_mut().find(is_beside) {
            Some((_, places)) => places.push(*own),
            None => clusters.push((near[at].last().map_or(0.0, |last| last.distance), vec![*own])),
        }
    }
    clusters.iter().map(|(_, places)| mean(places)).collect()
}

/// Spread of a boundary across itself over that along it, squared, about a point.
fn sharpness(own: &Place, near: &[Neighbour], boundary: &[Place], dimensions: usize) -> f64 {
    let around: Vec<Place> = near.iter().map(|next| offset(own, &boundary[next.index])).collect();
    let among = |count: usize| {
        let spread = DMatrix::from_fn(count, dimensions, |row, axis| around[row][axis]).singular_values();
        (spread.min() / spread.max().max(f64::MIN_POSITIVE)).powi(2)
    };
    among(around.len()).min(among(NEAREST.min(around.len())))
}

/// Whether the corner of a boundary at a point turns away from the points inside.
fn points_inwards(
    own: &Place,
    (near, boundary): (&[Neighbour], &[Place]),
    (interior, inside): (&Nearest<MOST_COORDINATES>, &[Place]),
) -> bool {
    let turned = mean(&near.iter().map(|next| offset(own, &boundary[next.index])).collect::<Vec<Place>>());
    let ways = interior.some(own, NEAR).into_iter().map(|next| offset(own, &inside[next.index]));
    let cosines: Vec<f64> =
        ways.map(|way| dot(&way, &turned) / (norm(&way) * norm(&turned)).max(f64::MIN_POSITIVE)).collect();
    cosines.iter().sum::<f64>() < OUTWARDS * cosines.len() as f64
}

/// Whether a part of a side ends among the neighbours of a point, where other values are given from then on: the points of both parts lie
/// apart.
fn is_end(own: &Side, near: &[&Side]) -> bool {
    let (same, others): (Vec<&Side>, Vec<&Side>) = near.iter().partition(|next| next.given == own.given);
    if same.len().min(others.len()) < PART {
        return false;
    }
    let [same, others] = [same, others].map(|part| part.iter().map(|side| side.place).collect::<Vec<Place>>());
    let across = offset(&mean(&same), &mean(&others));
    let last = same.iter().map(|place| dot(place, &across)).fold(f64::NEG_INFINITY, f64::max);
    others.iter().all(|place| dot(place, &across) > last)
}

fn mean(places: &[Place]) -> Place {
    std::array::from_fn(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
}

fn offset(from: &Place, to: &Place) -> Place {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

fn norm(a: &Place) -> f64 {
    dot(a, a).sqrt()
}

fn dot(a: &Place, b: &Place) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many points along a closed line through corners, with the head given where something is true.
    fn outline(corners: &[[f64; 2]], count: usize, is_given: impl Fn(f64, f64) -> bool) -> Vec<Side> {
        let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
        let point = |from: &[f64; 2], to: &[f64; 2], share: f64| {
            from.map(|x| x * (1.0 - share)).iter().zip(to.map(|x| x * share)).map(|(a, b)| a + b).collect::<Vec<f64>>()
        };
        let side = |(from, to): (&[f64; 2], &[f64; 2])| {
            let (from, to) = (*from, *to);
            (0..count).map(move |at| point(&from, &to, (at as f64 + 0.5) / count as f64))
        };
        let side_of = |point: Vec<f64>| {
            let mut place = Place::default();
            place[..2].copy_from_slice(&point);
            Side { place, given: if is_given(point[0], point[1]) { vec![0] } else { Vec::new() } }
        };
        pairs.flat_map(side).map(side_of).collect()
    }

    /// Points of a grid over the unit square where something is true.
    fn grid(counts: impl Fn(f64, f64) -> bool) -> Vec<Place> {
        let all = (0..900).map(|at| [f64::from(at % 30) + 0.5, f64::from(at / 30) + 0.5].map(|x| x / 30.0));
        all.filter(|&[x, y]| counts(x, y))
            .map(|[x, y]| {
                let mut place = Place::default();
                (place[0], place[1]) = (x, y);
                place
            })
            .collect()
    }

    fn places(found: Vec<Place>) -> Vec<[f64; 2]> {
        found.into_iter().map(|place| [place[0], place[1]].map(|x| (100.0 * x).round() / 100.0)).collect()
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    const ELL: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.4, 0.4], [0.4, 1.0], [0.0, 1.0]];

    #[test]
    fn of_six_corners_the_one_that_points_inwards_is_singular() {
        let inside = grid(|x, y| x < 0.4 || y < 0.4);
        assert_eq!(places(singular(&outline(&ELL, 80, |_, _| true), &inside, 2)), [[0.4, 0.4]]);
        assert_eq!(places(singular(&outline(&SQUARE, 80, |_, _| true), &grid(|_, _| true), 2)), [[0.0; 2]; 0]);
    }

    #[test]
    fn a_round_hole_has_no_corner_and_a_square_one_has_four() {
        let ring: Vec<[f64; 2]> =
            (0..40).map(|at| 0.157 * f64::from(at)).map(|a| [0.5 + 0.2 * a.cos(), 0.5 + 0.2 * a.sin()]).collect();
        let outer = || outline(&SQUARE, 80, |_, _| true);
        for count in [1, 4] {
            let round = outer().into_iter().chain(outline(&ring, count, |_, _| true)).collect::<Vec<Side>>();
            assert_eq!(places(singular(&round, &grid(|x, y| (x - 0.5).hypot(y - 0.5) > 0.2), 2)), [[0.0; 2]; 0]);
        }
        let hole = SQUARE.map(|corner| corner.map(|x| 0.3 + 0.4 * x));
        let square = outer().into_iter().chain(outline(&hole, 40, |_, _| true)).collect::<Vec<Side>>();
        let inside = grid(|x, y| !(0.3..0.7).contains(&x) || !(0.3..0.7).contains(&y));
        assert_eq!(places(singular(&square, &inside, 2)).len(), 4);
    }

    /// In a right angle fields stay smooth if the value is given on one side of it.
    #[test]
    fn a_part_of_a_side_ends_at_a_singular_place() {
        let inside = grid(|_, _| true);
        assert_eq!(places(singular(&outline(&SQUARE, 80, |_, y| y == 0.0), &inside, 2)), [[0.0; 2]; 0]);
        let half = outline(&SQUARE, 80, |x, y| y == 0.0 && x < 0.3);
        let found = places(singular(&half, &inside, 2));
        assert!(found.len() == 1 && (found[0][0] - 0.3).abs() < 0.02 && found[0][1] == 0.0, "{found:?}");
        // Where a plate is clamped, value and slope are given, each at points of its own.
        let both = outline(&SQUARE, 80, |_, _| true).into_iter().chain(outline(&SQUARE, 77, |_, _| false));
        assert_eq!(places(singular(&both.collect::<Vec<Side>>(), &inside, 2)), [[0.0; 2]; 0]);
    }
}
