//! Places between the given points of an equation, where those are few: it holds there too, and a lattice can only be as fine as
//! it is asked.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::local::meshes::axes;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Points that are enough.
const ENOUGH: usize = 2000;

/// How many points an equation is asked at before it is known whether these are enough. A source of all coordinates may be
/// anything between the given ones.
pub(super) fn first(bound: &Bound) -> usize {
    let schema = bound.problem.scene().schema;
    let is_of_all = |head: usize| schema.heads[head].source && axes(schema, head).len() == schema.coordinates.len();
    let given = largest(bound).map_or(0, |at| count(bound, at));
    if (0..schema.heads.len()).any(is_of_all) { given } else { given.max(ENOUGH) }
}

/// The problem with an equation asked at so many points, between those that it has; nothing where it has as many, or reads what is
/// known at its points alone.
pub(super) fn filled(bound: &Bound, points: usize) -> Option<Bound> {
    let at = largest(bound)?;
    let inputs = bound.problem.scene().schema.coordinates.len();
    if count(bound, at) >= points {
        return None;
    }
    let mut filled = bound.clone();
    let more = between(&bound.coordinates[at], inputs, points - count(bound, at));
    filled.coordinates[at].extend(more);
    Some(filled)
}

/// The group of equations with most points that may have more.
fn largest(bound: &Bound) -> Option<usize> {
    let schema = bound.problem.scene().schema;
    let is_equation = |group: &schema::Group| group.terms.iter().any(|term| term.kind == TermKind::Residual);
    let is_free = |group: &schema::Group| group.columns.is_empty() && group.order > 0 && is_equation(group);
    let free = (0..schema.groups.len()).filter(|&at| is_free(&schema.groups[at]) && count(bound, at) > 1);
    free.max_by_key(|&at| count(bound, at))
}

fn count(bound: &Bound, group: usize) -> usize {
    bound.coordinates[group].len() / bound.problem.scene().schema.coordinates.len()
}

/// So many places at random between points and their neighbours: places in rows would leave patterns of coefficients that vanish at
/// all of them.
fn between(points: &[f64], inputs: usize, more: usize) -> Vec<f64> {
    let point = |at: usize| &points[at * inputs..][..inputs];
    let count = points.len() / inputs;
    let width = |axis: usize| {
        let values = points.iter().skip(axis).step_by(inputs);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        (high - low).max(f64::MIN_POSITIVE)
    };
    let widths: Vec<f64> = (0..inputs).map(width).collect();
    // The nearest along every coordinate, either way: rows of points may lie close, and far apart from each other.
    let along = |at: usize, axis: usize, sign: f64| {
        let away = |other: usize| -> Vec<f64> {
            point(other).iter().zip(point(at)).zip(&widths).map(|((b, a), width)| sign * (b - a) / width).collect()
        };
        let ahead = |other: &usize| {
            let away = away(*other);
            away[axis] > 0.0 && away.iter().all(|other| other.abs() <= away[axis])
        };
        let apart = |other: usize| away(other).iter().map(|x| x * x).sum::<f64>();
        (0..count).filter(ahead).min_by(|&a, &b| apart(a).total_cmp(&apart(b)))
    };
    let near = |at: usize| {
        let found = (0..inputs).flat_map(|axis| [along(at, axis, 1.0), along(at, axis, -1.0)]).flatten();
        let found: Vec<usize> = found.collect();
        if found.is_empty() { vec![at] } else { found }
    };
    let neighbours: Vec<Vec<usize>> = (0..count).map(near).collect();
    let mut random = StdRng::seed_from_u64(0);
    let mut place = |number: usize| {
        let at = number % count;
        let mut pick = || neighbours[at][random.random_range(0..neighbours[at].len())];
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
