//! Equations that jump, and fields that do. No spline follows the highest derivative there: asked for at points, such an equation is missed by every answer,
//! and the least sum of squares is one without the jump. In the mean over hats it can be met, as a finite volume is balanced: what flows
//! through its sides is right whatever the splines do inside. Splines of one degree above the equation's order leave a residual of hats, as
//! many as there are means.

use rand::SeedableRng;
use rand::rngs::StdRng;
use rayon::prelude::*;

use super::between::stating;
use super::clashes::{Clashes, clashes};
use super::domain::Domain;
use super::quadrature::Quadrature;
use super::shares::shares;
use super::singular::{Singularity, singularities};
use crate::abrupt;
use crate::ends::ranges;
use crate::local::heads::Heads;
use crate::local::lattice::{Lattice, NONE};
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Degree of what equations that jump are tested with: hats.
pub(super) const TESTS: usize = 1;
/// How a group is asked.
#[derive(Clone)]
pub(super) enum Asked {
    /// At every point.
    AtPoints,
    /// In the mean, at its own points that are not beside a singular place: a condition.
    InMean(Vec<Singularity>),
    /// In the mean over the domain: an equation.
    OverDomain(Uneven),
}

/// Where fields are not smooth.
#[derive(Clone)]
pub(super) struct Uneven {
    /// Points, flat, where the equation jumps.
    pub(super) jumps: Vec<f64>,
    /// Points, flat, where conditions contradict each other.
    pub(super) clashes: Vec<f64>,
    /// Where fields are singular: the equation is not asked beside such places.
    pub(super) singular: Vec<Singularity>,
}

impl Uneven {
    fn is_nowhere(&self) -> bool {
        self.jumps.is_empty() && self.clashes.is_empty() && self.singular.is_empty()
    }
}

/// How the groups of a problem are asked, whatever lattice they are asked on: equations that jump, or whose fields are singular somewhere, in
/// the mean, and where conditions contradict each other all equations and conditions.
pub(super) fn asked(bound: &Bound) -> (Vec<Asked>, Clashes) {
    let schema = bound.problem.scene().schema;
    let stating = stating(bound);
    let is_tested =
        |at: usize| stating.contains(&at) && is_equation(schema, &schema.groups[at]) && is_of_the_whole(bound, at);
    let is_any = (0..schema.groups.len()).any(is_tested);
    let clashes = if is_any { clashes(bound) } else { Clashes::default() };
    // Without a source, equations and conditions alone tell what fields are there.
    let has_source = schema.heads.iter().any(|head| head.source);
    let singular = if is_any && has_source { singularities(bound) } else { Vec::new() };
    let conditions = schema.conditions();
    let of = |at: usize| {
        if !is_tested(at) {
            let is_even = clashes.places.is_empty() && singular.is_empty();
            let is_in_mean = !is_even && conditions.contains(&at);
            return if is_in_mean { Asked::InMean(singular.clone()) } else { Asked::AtPoints };
        }
        let jumps = abrupt::jumps(bound, at, &abrupt::even(schema.coordinates.len()));
        let uneven = Uneven { jumps, clashes: clashes.places.clone(), singular: singular.clone() };
        if uneven.is_nowhere() { Asked::AtPoints } else { Asked::OverDomain(uneven) }
    };
    let asked = (0..schema.groups.len()).map(of).collect();
    (asked, clashes)
}

/// How the groups are asked on a lattice of so many cells, which may want to know more finely where equations jump.
pub(super) fn asked_on(bound: &Bound, asked: &[Asked], cells: &[usize]) -> Vec<Asked> {
    let pieces = abrupt::finer(cells);
    let of = |(at, own): (usize, &Asked)| match (own, &pieces) {
        (Asked::OverDomain(uneven), Some(pieces)) if !uneven.jumps.is_empty() => {
            Asked::OverDomain(Uneven { jumps: abrupt::jumps(bound, at, pieces), ..uneven.clone() })
        }
        _ => own.clone(),
    };
    asked.iter().enumerate().map(of).collect()
}

/// Whether a group has points along most of every coordinate: a condition on a wall or at the start has not.
fn is_of_the_whole(bound: &Bound, group: usize) -> bool {
    let inputs = bound.problem.scene().schema.coordinates.len();
    let own = ranges([&bound.coordinates[group]], inputs);
    let all = ranges(&bound.coordinates, inputs);
    own.iter().zip(all).all(|(own, all)| own.1 - own.0 > 0.5 * (all.1 - all.0))
}

/// Whether a head is differentiated in an equation that is asked in the mean.
pub(super) fn is_in_means(schema: &schema::Scene, asked: &[Asked], head: usize) -> bool {
    let is_read = |group: &schema::Group| group.jets.iter().any(|jet| jet.head == head && !jet.is_value());
    schema.groups.iter().zip(asked).any(|(group, asked)| !matches!(asked, Asked::AtPoints) && is_read(group))
}

/// Whether a group is an equation alone, that differentiates a field of all coordinates and reads nothing that is known at its points only.
fn is_equation(schema: &schema::Scene, group: &schema::Group) -> bool {
    let is_residual = |term: &schema::Term| term.kind == TermKind::Residual;
    let is_of_all = |jet: &schema::Jet| !jet.is_value() && schema.axes(jet.head).len() == schema.coordinates.len();
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
            Asked::InMean(singular) => {
                let points = bound.coordinates[at].chunks_exact(lattice.cells.len());
                let is_asked = |point: &[f64]| !singular.iter().any(|place| place.is_near(lattice, point));
                let weight = |(share, point)| if is_asked(point) { share } else { 0.0 };
                means[at].weights = shares(bound, at).into_iter().zip(points).map(weight).collect();
                continue;
            }
            Asked::OverDomain(uneven) => uneven,
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

/// Points in the domain of a group, none where fields are singular, and what its means are made from.
fn points(
    lattice: &Lattice,
    (bound, group): (&Bound, usize),
    uneven: &Uneven,
    random: &mut StdRng,
) -> (Vec<f64>, Means) {
    let inputs = lattice.cells.len();
    let all = Quadrature::new(lattice, [&uneven.jumps, &uneven.clashes], random);
    let domain = Domain::new(bound, group);
    let is_inside = |point: &[f64]| {
        let cell = lattice.cell_span(&lattice.place(point));
        lattice.kept(cell).all(|n| n != NONE)
            && domain.is_inside(point)
            && !uneven.singular.iter().any(|place| place.is_near(lattice, point))
    };
    let inside: Vec<bool> = all.points.par_chunks_exact(inputs).map(is_inside).collect();
    let kept: Vec<usize> = (0..inside.len()).filter(|&p| inside[p]).collect();
    let middles = (0..kept.len() as u32).filter(|&p| all.is_middle[kept[p as usize]]).collect();
    let points = kept.iter().flat_map(|&p| &all.points[p * inputs..][..inputs]).copied().collect();
    (points, Means { weights: kept.into_iter().map(|p| all.weights[p]).collect(), middles })
}
