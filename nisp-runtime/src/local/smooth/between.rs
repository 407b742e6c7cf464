//! Places between the given points of an equation: it holds there too. Where the points are few a lattice can only be as fine as it
//! is asked, and whether an answer holds its equations is told by places that it was not asked at.

use rand::rngs::StdRng;
use rand::seq::index::sample;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

use super::MORE;
use crate::ends::ranges;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Points that are enough, and with which a problem over two coordinates begins for which nothing is measured.
const ENOUGH: usize = 2000;
const FEW: usize = 1000;
/// Other places that an answer is judged at, at least and at most.
const FEWEST_OTHERS: usize = 1000;
const MOST_OTHERS: usize = 4000;
/// How much farther a neighbour may be than its own neighbour in the opposite direction is, as squares.
const MUTUAL: f64 = 9.0;
/// Pairs of points that are looked at, about, to find neighbours; and points at least whose neighbours are looked for.
const PAIRS: usize = 40_000_000;
const FEWEST_BASES: usize = 200;
/// Seeds of places that equations are asked at, and of others.
pub(super) const ASKED: u64 = 0;
pub(super) const OTHERS: u64 = 1;
const PICKED: u64 = 2;
/// Measurements for every point of the equations at most, exact ones, which say no more, and noisy ones while lattices are chosen:
/// these points are twice as many as the unknowns.
const EXACT: usize = 2;
const NOISY: usize = 4;

/// How many points an equation is asked at before it is known whether these are enough. A source of all coordinates may be
/// anything between the given ones. Where nothing is measured, and where noisy measurements are to tell scalars, two lattices tell how far an
/// answer is off, so that the first is coarser: over more than two coordinates it has three cells along each with [`ENOUGH`].
pub(super) fn first(bound: &Bound, is_noisy: bool) -> usize {
    let schema = bound.problem.scene().schema;
    let given = largest(bound).map_or(0, |at| count(bound, at));
    if schema.observed().is_empty() {
        return if schema.coordinates.len() > 2 { ENOUGH } else { FEW };
    }
    let enough = if is_filled(schema) { given.max(ENOUGH) } else { given };
    if is_noisy && !bound.learned.is_empty() { enough / MORE } else { enough }
}

/// True if equations are asked between their points before it is known whether these are enough.
pub(super) fn is_filled(schema: &schema::Scene) -> bool {
    let is_of_all = |head: usize| schema.heads[head].source && schema.axes(head).len() == schema.coordinates.len();
    !(0..schema.heads.len()).any(is_of_all)
}

/// The problem with equations asked at more points, between those that they have: the largest at so many, those of other fields at as many
/// times more. Nothing where the largest has as many, or reads what is known at its points alone.
pub(super) fn filled(bound: &Bound, points: usize) -> Option<Bound> {
    let given = count(bound, largest(bound)?);
    if given >= points {
        return None;
    }
    let mut filled = bound.clone();
    for at in stating(bound) {
        let more = count(bound, at) * (points - given) / given;
        filled.coordinates[at].extend(between(bound, at, more, ASKED));
    }
    Some(filled)
}

/// The problem with at most so many measurements of each group, picked at random; nothing where none has more. What else is stated
/// where they were made is asked at those that are left.
pub(super) fn thinned(bound: &Bound, most: usize) -> Option<Bound> {
    let schema = bound.problem.scene().schema;
    let large: Vec<usize> = measuring(schema).filter(|&at| count(bound, at) > most).collect();
    if large.is_empty() {
        return None;
    }
    let (inputs, mut thinned) = (schema.coordinates.len(), bound.clone());
    for at in large {
        // Measurements in rows, evenly picked, may all be of one place.
        let mut chosen = sample(&mut StdRng::seed_from_u64(PICKED), count(bound, at), most).into_vec();
        chosen.sort_unstable();
        let coordinates = chosen.iter().flat_map(|&p| &bound.coordinates[at][p * inputs..][..inputs]);
        thinned.coordinates[at] = coordinates.copied().collect();
        for (own, all) in thinned.columns[at].iter_mut().zip(&bound.columns[at]) {
            *own = chosen.iter().map(|&p| all[p]).collect();
        }
        thinned.keep_noisiness(at, &chosen);
    }
    Some(thinned)
}

/// The problem with the equations of [`filled`] at other places, and which groups these are; nothing where there are none.
pub(crate) fn others(bound: &Bound) -> Option<(Vec<usize>, Bound)> {
    let groups = stating(bound);
    let mut others = bound.clone();
    for &at in &groups {
        let many = count(bound, at).clamp(FEWEST_OTHERS, MOST_OTHERS);
        others.coordinates[at] = between(bound, at, many, OTHERS);
    }
    (!groups.is_empty()).then_some((groups, others))
}

/// Groups that state what fields obey: of those that may have more points the largest that differentiates a field, for each. There is
/// one for fields that live together, and one for each part of a domain whose fields end where another's begin.
pub(super) fn stating(bound: &Bound) -> Vec<usize> {
    let schema = bound.problem.scene().schema;
    let fields = (0..schema.heads.len()).filter(|&head| !schema.heads[head].source);
    let mut groups: Vec<usize> = fields.filter_map(|field| of_most_points(bound, Some(field))).collect();
    groups.extend(largest(bound));
    groups.sort_unstable();
    groups.dedup();
    groups
}

/// The group of equations with most points that may have more.
fn largest(bound: &Bound) -> Option<usize> {
    of_most_points(bound, None)
}

/// The group with most points among those that differentiate a field.
fn of_most_points(bound: &Bound, field: Option<usize>) -> Option<usize> {
    let schema = bound.problem.scene().schema;
    let is_equation = |group: &schema::Group| group.terms.iter().any(|term| term.kind == TermKind::Residual);
    let is_sum = |group: &schema::Group| group.terms.iter().any(|term| term.kind == TermKind::Integral);
    let is_alone = |group: &schema::Group| !group.paired && !is_sum(group);
    let is_free =
        |group: &schema::Group| group.columns.is_empty() && group.order > 0 && is_equation(group) && is_alone(group);
    let differentiates = |group: &schema::Group| {
        let jets = || group.jets.iter().filter(|jet| !jet.is_value());
        field.is_none_or(|field| jets().any(|jet| jet.head == field))
    };
    let groups = (0..schema.groups.len()).filter(|&at| count(bound, at) > 1);
    let free = groups.filter(|&at| is_free(&schema.groups[at]) && differentiates(&schema.groups[at]));
    free.max_by_key(|&at| count(bound, at))
}

fn count(bound: &Bound, group: usize) -> usize {
    bound.coordinates[group].len() / bound.problem.scene().schema.coordinates.len()
}

/// Groups that measure at their points, and state nothing but equations beside.
fn measuring(schema: &schema::Scene) -> impl Iterator<Item = usize> {
    let measures = |at: &usize| {
        let kinds = || schema.groups[*at].terms.iter().map(|term| &term.kind);
        !schema.groups[*at].paired
            && kinds().any(|kind| *kind == TermKind::Observation)
            && kinds().all(|kind| matches!(kind, TermKind::Observation | TermKind::Residual))
    };
    (0..schema.groups.len()).filter(measures)
}

/// How many measurements there are that may be left out.
pub(super) fn measurements(bound: &Bound) -> usize {
    measuring(bound.problem.scene().schema).map(|at| count(bound, at)).sum()
}

/// Measurements of a group that choose a lattice where equations are asked at so many points. Of exact ones it can use no more.
pub(super) fn enough(points: usize, is_noisy: bool) -> usize {
    (if is_noisy { NOISY } else { EXACT } * points).max(ENOUGH)
}

/// So many places at random between neighbours among the points of an equation and those of conditions, at which it holds too: places
/// in rows would leave patterns of coefficients that vanish at all of them, and a strip along an edge would be free.
fn between(bound: &Bound, group: usize, more: usize, seed: u64) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let is_edge = |at: &usize| schema.groups[*at].is_condition_of(schema.groups[group].order);
    let own = &bound.coordinates[group];
    let ranges = ranges([own], inputs);
    let widths: Vec<f64> = ranges.iter().map(|(low, high)| (high - low).max(f64::MIN_POSITIVE)).collect();
    // Conditions of another part of the domain are no edge of this one.
    let spacing = (count(bound, group) as f64).powf(-(inputs as f64).recip());
    let is_near = |edge: &&[f64]| {
        let along = edge.iter().zip(ranges.iter().zip(&widths));
        along.into_iter().all(|(x, ((low, high), width))| (low - spacing * width..=high + spacing * width).contains(x))
    };
    let edges = (0..schema.groups.len()).filter(is_edge).flat_map(|at| bound.coordinates[at].chunks_exact(inputs));
    let points: Vec<f64> = own.chunks_exact(inputs).chain(edges.filter(is_near)).flatten().copied().collect();
    let count = points.len() / inputs;
    let point = |at: usize| &points[at * inputs..][..inputs];
    let scaled: Vec<f64> = points.iter().zip(widths.iter().cycle()).map(|(x, width)| x / width).collect();
    // The nearest along every coordinate, either way, and how far it is: rows of points may lie close, and far apart from each other.
    let nearest = |at: usize| {
        let mut nearest = vec![(f64::INFINITY, at); 2 * inputs];
        let mut away = vec![0.0; inputs];
        // How far the farthest of them is: most points are farther, but for rounding.
        let mut reach = f64::INFINITY;
        let from = &scaled[at * inputs..][..inputs];
        for (other, place) in scaled.chunks_exact(inputs).enumerate() {
            let mut about = 0.0;
            for axis in 0..inputs {
                about += (place[axis] - from[axis]) * (place[axis] - from[axis]);
            }
            if other == at || about > reach {
                continue;
            }
            for (axis, away) in away.iter_mut().enumerate() {
                *away = (point(other)[axis] - point(at)[axis]) / widths[axis];
            }
            let apart = away.iter().map(|x| x * x).sum::<f64>();
            let farthest = away.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for (axis, away) in away.iter().enumerate().filter(|(_, away)| away.abs() == farthest && farthest > 0.0) {
                let place = &mut nearest[2 * axis + usize::from(*away > 0.0)];
                *place = if apart < place.0 { (apart, other) } else { *place };
            }
            reach = nearest.iter().map(|(apart, _)| apart * (1.0 + 1e-9)).fold(0.0, f64::max);
        }
        nearest
    };
    // Start from the equation's own points only. Starting from conditions too would crowd the places along edges that have many
    // points.
    let bases = own.len() / inputs;
    let few = more.min(bases).min((PAIRS / count).max(FEWEST_BASES));
    let chosen: Vec<usize> = (0..few).map(|number| number * bases / few).collect();
    let ends: Vec<Vec<(f64, usize)>> = chosen.par_iter().map(|&at| nearest(at)).collect();
    // Across a notch or a hole the one is the nearest to the other, but the other has nearer ones in that direction.
    let mut others: Vec<usize> = ends.iter().flatten().map(|(_, other)| *other).collect();
    others.sort_unstable();
    others.dedup();
    let back: Vec<Vec<(f64, usize)>> = others.par_iter().map(|&at| nearest(at)).collect();
    let is_across = |direction: usize, (apart, other): (f64, usize)| {
        others.binary_search(&other).is_ok_and(|found| apart > MUTUAL * back[found][direction ^ 1].0)
    };
    let near = |(&at, ends): (&usize, &Vec<(f64, usize)>)| {
        let ends = ends.iter().enumerate().filter(|(direction, end)| end.1 != at && !is_across(*direction, **end));
        let mut found: Vec<usize> = ends.map(|(_, end)| end.1).collect();
        found.extend(found.is_empty().then_some(at));
        found
    };
    let neighbours: Vec<Vec<usize>> = chosen.iter().zip(&ends).map(near).collect();
    let mut random = StdRng::seed_from_u64(seed);
    let mut place = |number: usize| {
        let (at, near) = (chosen[number % chosen.len()], &neighbours[number % chosen.len()]);
        let mut pick = || near[random.random_range(0..near.len())];
        let corners = [at, pick(), pick()];
        let weights: [f64; 3] = std::array::from_fn(|_| random.random());
        let whole: f64 = weights.iter().sum();
        let of = |axis: usize| {
            corners.iter().zip(&weights).map(|(&at, weight)| weight * point(at)[axis]).sum::<f64>() / whole
        };
        (0..inputs).map(of).collect::<Vec<f64>>()
    };
    (0..more).flat_map(&mut place).collect()
}
