//! Equations that jump. No spline follows the highest derivative there: asked for at points, such an equation is missed by every answer,
//! and the least sum of squares is one without the jump. In the mean over hats it can be met, as a finite volume is balanced: what flows
//! through its sides is right whatever the splines do inside. Splines of one degree above the equation's order leave a residual of hats, as
//! many as there are means.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

use super::between::stating;
use super::clashes::{Clashes, clashes, conditions};
use super::domain::Domain;
use super::shares::shares;
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

/// How a group is asked.
pub(super) enum Asked {
    /// At every point.
    AtPoints,
    /// In the mean, at its own points: a condition.
    InMean,
    /// In the mean over the domain: an equation. Points, flat, where it jumps, and where conditions contradict each other.
    OverDomain {
        /// Where it jumps.
        jumps: Vec<f64>,
        /// Where conditions do not agree.
        clashes: Vec<f64>,
    },
}

/// How the groups of a problem are asked: equations that jump in the mean, and where conditions contradict each other all equations and
/// conditions.
pub(super) fn asked(bound: &Bound) -> (Vec<Asked>, Clashes) {
    let schema = bound.problem.scene().schema;
    let stating = stating(bound);
    let is_tested =
        |at: usize| stating.contains(&at) && is_equation(schema, &schema.groups[at]) && is_of_the_whole(bound, at);
    let clashes = if (0..schema.groups.len()).any(is_tested) { clashes(bound) } else { Clashes::default() };
    let conditions = conditions(schema);
    let of = |at: usize| {
        if !is_tested(at) {
            return if !clashes.places.is_empty() && conditions.contains(&at) {
                Asked::InMean
            } else {
                Asked::AtPoints
            };
        }
        let (jumps, clashes) = (abrupt::jumps(bound, at), clashes.places.clone());
        if jumps.is_empty() && clashes.is_empty() { Asked::AtPoints } else { Asked::OverDomain { jumps, clashes } }
    };
    let asked = (0..schema.groups.len()).map(of).collect();
    (asked, clashes)
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

/// Whether a head is differentiated in an equation that is asked in the mean.
pub(super) fn is_in_means(schema: &schema::Scene, asked: &[Asked], head: usize) -> bool {
    let is_read = |group: &schema::Group| {
        group.jets.iter().any(|jet| jet.head == head && jet.degree.iter().any(|&degree| degree > 0))
    };
    schema.groups.iter().zip(asked).any(|(group, asked)| !matches!(asked, Asked::AtPoints) && is_read(group))
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
    /// Points in the middle of cells without a jump and where conditions agree.
    pub(super) middles: Vec<u32>,
}

/// The problem with points for the means of equations that jump, in the domains that those `within` fill; and what they are by group.
pub(super) fn with_means(
    (bound, within): (&Bound, &Bound),
    heads: &Heads,
    asked: &[Asked],
    seed: u64,
) -> (Option<Bound>, Vec<Means>) {
    let mut means = vec![Means::default(); asked.len()];
    let mut with = None;
    let mut random = StdRng::seed_from_u64(seed);
    let Some(lattice) = heads.lattices.iter().max_by_key(|lattice| lattice.dimensions()) else { return (with, means) };
    for (at, asked) in asked.iter().enumerate() {
        let uneven = match asked {
            Asked::AtPoints => continue,
            Asked::InMean => {
                means[at].weights = shares(bound, at);
                continue;
            }
            Asked::OverDomain { jumps, clashes } => [jumps.as_slice(), clashes],
        };
        let (points, own) = points(lattice, (within, at), uneven, &mut random);
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
/// random in each of many equal parts. Where conditions contradict each other there are as many, in the middle of such parts: the
/// derivatives are largest there, and an equation is as large as they are at its points.
fn points(
    lattice: &Lattice,
    (bound, group): (&Bound, usize),
    [jumps, clashes]: [&[f64]; 2],
    random: &mut StdRng,
) -> (Vec<f64>, Means) {
    let inputs = lattice.cells.len();
    let cells: usize = lattice.cells.iter().product();
    let cells_with = |points: &[f64]| {
        let mut is_near = vec![false; cells];
        points.chunks_exact(inputs).for_each(|point| is_near[number(lattice, point)] = true);
        is_near
    };
    let (is_near, is_clash) = (cells_with(jumps), cells_with(clashes));
    let (low, spacing, _) = lattice.parts();
    let (mut points, mut weights, mut is_middle) = (Vec::new(), Vec::new(), Vec::new());
    let parts = NEAR.powf((inputs as f64).recip()).round() as usize;
    for (cell, (&is_near, &is_clash)) in is_near.iter().zip(&is_clash).enumerate() {
        let is_dense = is_near || is_clash;
        let along = if is_dense { parts } else { GAUSS.len() };
        for part in 0..along.pow(inputs as u32) {
            is_middle.push(!is_dense && 2 * part + 1 == along.pow(inputs as u32));
            let (mut cell, mut part, mut weight) = (cell, part, 1.0);
            for axis in 0..inputs {
                let at = part % along;
                let mut beside = || if is_near { random.random::<f64>() } else { 0.5 };
                let (within, share) = match is_dense {
                    true => ((at as f64 + beside()) / along as f64, (along as f64).recip()),
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
