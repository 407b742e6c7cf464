//! Equations that jump. No spline follows the highest derivative there: asked for at points, such an equation is missed by every answer,
//! and the least sum of squares is one without the jump. In the mean over hats it can be met, as a finite volume is balanced: what flows
//! through its sides is right whatever the splines do inside. Splines of one degree above the equation's order leave a residual of hats, as
//! many as there are means.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

use super::between::stating;
use super::domain::Domain;
use crate::abrupt;
use crate::local::heads::Heads;
use crate::local::lattice::{Lattice, NONE};
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Degree of what equations that jump are tested with: hats.
pub(super) const TESTS: usize = 1;
/// Points of a cell with a jump, about: means are as good as these say where the jump is.
const NEAR: f64 = 216.0;
/// Points along a side of the other cells, and their shares: what is left there is smooth.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Where the equations of a problem jump, by group, flat; nothing of others.
pub(super) fn jumps(bound: &Bound) -> Vec<Vec<f64>> {
    let schema = bound.problem.scene().schema;
    let stating = stating(bound);
    let is_asked = |(at, group): &(usize, &schema::Group)| stating.contains(at) && is_equation(schema, group);
    let of = |own: (usize, &schema::Group)| {
        if is_asked(&own) && is_of_the_whole(bound, own.0) { abrupt::jumps(bound, own.0) } else { Vec::new() }
    };
    schema.groups.iter().enumerate().map(of).collect()
}

/// Whether a group has points along most of every coordinate: a condition on a wall or at the start has not.
fn is_of_the_whole(bound: &Bound, group: usize) -> bool {
    let inputs = bound.problem.scene().schema.coordinates.len();
    let range = |points: &[Vec<f64>], axis: usize| {
        let values = points.iter().flat_map(|points| points.iter().skip(axis).step_by(inputs));
        let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        ends.1 - ends.0
    };
    let own = &bound.coordinates[group..=group];
    (0..inputs).all(|axis| range(own, axis) > 0.5 * range(&bound.coordinates, axis))
}

/// Whether a head is differentiated in an equation that jumps.
pub(super) fn is_abrupt(schema: &schema::Scene, jumps: &[Vec<f64>], head: usize) -> bool {
    let is_read = |group: &schema::Group| {
        group.jets.iter().any(|jet| jet.head == head && jet.degree.iter().any(|&degree| degree > 0))
    };
    schema.groups.iter().zip(jumps).any(|(group, jumps)| !jumps.is_empty() && is_read(group))
}

/// Whether a group is an equation alone, that differentiates a field of all coordinates and reads nothing that is known at its points only.
fn is_equation(schema: &schema::Scene, group: &schema::Group) -> bool {
    let is_residual = |term: &schema::Term| term.kind == TermKind::Residual;
    let is_of_all = |jet: &schema::Jet| {
        jet.degree.iter().any(|&degree| degree > 0) && schema.axes(jet.head).len() == schema.coordinates.len()
    };
    group.columns.is_empty() && !group.paired && group.terms.iter().all(is_residual) && group.jets.iter().any(is_of_all)
}

/// What the means of a group are made from; nothing of a group that is asked for at its points.
#[derive(Clone, Default)]
pub(super) struct Means {
    /// What the points stand for, in cells.
    pub(super) weights: Vec<f64>,
    /// Points in the middle of cells without a jump.
    pub(super) middles: Vec<u32>,
}

/// The problem with points for the means of equations that jump, in the domains that those `within` fill; and what they are by group.
pub(super) fn with_means(
    (bound, within): (&Bound, &Bound),
    heads: &Heads,
    jumps: &[Vec<f64>],
    seed: u64,
) -> (Option<Bound>, Vec<Means>) {
    let mut means = vec![Means::default(); jumps.len()];
    let mut with = None;
    let mut random = StdRng::seed_from_u64(seed);
    let Some(lattice) = heads.lattices.iter().max_by_key(|lattice| lattice.dimensions()) else { return (with, means) };
    for at in (0..jumps.len()).filter(|&at| !jumps[at].is_empty()) {
        let (points, own) = points(lattice, (within, at), &jumps[at], &mut random);
        // Where none of them is known to be in the domain, it is asked for at its own.
        if !points.is_empty() {
            with.get_or_insert_with(|| bound.clone()).coordinates[at] = points;
            means[at] = own;
        }
    }
    (with, means)
}

/// Number of the cell that a point lies in.
fn number(lattice: &Lattice, point: &[f64]) -> usize {
    let cell = lattice.place(point).cell;
    lattice.cells.iter().zip(cell).rev().fold(0, |number, (n, at)| number * n + at)
}

/// Points in the domain of a group, with what they stand for in cells: those of Gauss, or where the equation jumps one at
/// random in each of many equal parts.
fn points(lattice: &Lattice, (bound, group): (&Bound, usize), jumps: &[f64], random: &mut StdRng) -> (Vec<f64>, Means) {
    let inputs = lattice.cells.len();
    let cells: usize = lattice.cells.iter().product();
    let mut is_near = vec![false; cells];
    jumps.chunks_exact(inputs).for_each(|point| is_near[number(lattice, point)] = true);
    let (low, spacing, _) = lattice.parts();
    let (mut points, mut weights, mut is_middle) = (Vec::new(), Vec::new(), Vec::new());
    let parts = NEAR.powf((inputs as f64).recip()).round() as usize;
    for (cell, &is_near) in is_near.iter().enumerate() {
        let along = if is_near { parts } else { GAUSS.len() };
        for part in 0..along.pow(inputs as u32) {
            is_middle.push(!is_near && 2 * part + 1 == along.pow(inputs as u32));
            let (mut cell, mut part, mut weight) = (cell, part, 1.0);
            for axis in 0..inputs {
                let at = part % along;
                let (within, share) = match is_near {
                    true => ((at as f64 + random.random::<f64>()) / along as f64, (along as f64).recip()),
                    false => GAUSS[at],
                };
                points.push(low[axis] + spacing[axis] * ((cell % lattice.cells[axis]) as f64 + within));
                (cell, part, weight) = (cell / lattice.cells[axis], part / along, weight * share);
            }
            weights.push(weight);
        }
    }
    let domain = Domain::new(bound, group);
    let is_inside = |point: &[f64]| {
        let cell = lattice.cell_span(&lattice.place(point));
        lattice.kept(cell).all(|n| n != NONE) && domain.is_inside(point)
    };
    let inside: Vec<bool> = points.par_chunks_exact(inputs).map(is_inside).collect();
    let kept: Vec<usize> = (0..inside.len()).filter(|&p| inside[p]).collect();
    let middles = (0..kept.len() as u32).filter(|&p| is_middle[kept[p as usize]]).collect();
    let points = kept.iter().flat_map(|&p| &points[p * inputs..][..inputs]).copied().collect();
    (points, Means { weights: kept.into_iter().map(|p| weights[p]).collect(), middles })
}
