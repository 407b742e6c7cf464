//! Places between the given points of an equation, where those are few: it holds there too, and a lattice can only be as fine as
//! it is asked.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::local::meshes::axes;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Points that are enough.
const ENOUGH: usize = 2000;

/// The problem with equations asked between their points as well; nothing where these are enough. Where an equation reads what is
/// known at its points alone it is left as it is, and where a source of all coordinates may be anything between them.
pub(super) fn filled(bound: &Bound) -> Option<Bound> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let is_equation = |group: &schema::Group| group.terms.iter().any(|term| term.kind == TermKind::Residual);
    let is_free = |group: &schema::Group| group.columns.is_empty() && group.order > 0 && is_equation(group);
    let count = |at: usize| bound.coordinates[at].len() / inputs;
    let is_of_all = |head: usize| schema.heads[head].source && axes(schema, head).len() == inputs;
    if (0..schema.heads.len()).any(is_of_all) {
        return None;
    }
    let at = (0..schema.groups.len()).filter(|&at| is_free(&schema.groups[at])).max_by_key(|&at| count(at))?;
    if count(at) >= ENOUGH || count(at) < 2 {
        return None;
    }
    let mut filled = bound.clone();
    let more = between(&bound.coordinates[at], inputs, ENOUGH - count(at));
    filled.coordinates[at].extend(more);
    Some(filled)
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
