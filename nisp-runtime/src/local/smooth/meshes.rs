//! Which lattices carry fields and smooth sources, and which of their coefficients meet in a row.

use super::means::{Asked, TESTS, is_in_means};
use super::proportions::Proportions;
use crate::local::heads::Heads;
use crate::local::lattice::{Lattice, NONE, Place};
use crate::local::meshes::base;
use crate::local::refuse::HIGHEST_DEGREE;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// Degrees of splines above the order of their highest derivative, at least, and over few coordinates: what is left of an equation
/// falls with the fourth power of a cell, or with the sixth. Over more coordinates too many functions would meet on a cell.
const SMOOTH: usize = 3;
const SMOOTHER: usize = 5;
/// Coordinates at most for splines of the higher degree, with measurements and without. Noise hides what it gains.
const FEW: usize = 2;
const FEW_UNMEASURED: usize = 3;
/// Points of an equation to an unknown of a field, at least: as many more as let no pattern of coefficients escape. Where nothing is
/// measured, over two coordinates, that is not enough: what is left between twice as many points as unknowns is hundreds of times what
/// is left at them, and adds up along the equations.
const POINTS: f64 = 2.0;
const DENSE: f64 = 4.0;
/// Functions of whose highest derivative hardly any point sees anything, as a share of what the others show, are left out.
const UNSEEN: f64 = 1e-9;
/// Cells along a coordinate of an even lattice at most.
const MOST_CELLS: usize = 80;

/// Order of a head's highest derivative.
fn order(schema: &schema::Scene, head: usize) -> usize {
    let jets = schema.groups.iter().flat_map(|group| group.jets).filter(|jet| jet.head == head);
    jets.map(|jet| jet.degree.iter().map(|&n| usize::from(n)).sum()).max().unwrap_or(0)
}

/// Degree of a head's splines, or nothing if it would be too high.
pub(super) fn degree(schema: &schema::Scene, head: usize) -> Option<usize> {
    let order = order(schema, head);
    let few = if schema.observed().is_empty() { FEW_UNMEASURED } else { FEW };
    let smoother = order + if schema.coordinates.len() <= few { SMOOTHER } else { SMOOTH };
    (order + SMOOTH <= HIGHEST_DEGREE).then(|| smoother.min(HIGHEST_DEGREE))
}

/// The lattices of all heads, over cells as fine as the points of the equations can tell; and how many cells these are along
/// every coordinate in the given proportions. Cells are no finer than `most` points can tell: coarser ones come first.
/// Fields whose equations are asked in the mean have splines of the least degree that these leave hats of.
pub(super) fn lattices(
    bound: &Bound,
    proportions: &Proportions,
    most: usize,
    asked: &[Asked],
) -> (Vec<Lattice>, Vec<usize>) {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let degree = |head: usize| match is_in_means(schema, asked, head) {
        true => Some(order(schema, head) + TESTS),
        false => degree(schema, head),
    };
    let degrees: Vec<usize> = (0..schema.heads.len()).map(|head| degree(head).unwrap_or(0)).collect();
    let highest = degrees.iter().copied().max().unwrap_or(0);
    let is_equation =
        |group: &schema::Group| group.order > 0 && group.terms.iter().any(|term| term.kind == TermKind::Residual);
    let groups = schema.groups.iter().zip(&bound.coordinates).filter(|(group, _)| is_equation(group));
    let points = groups.map(|(_, points)| points.len() / inputs).max().unwrap_or(0);
    let is_measured = !schema.observed().is_empty();
    let points = points.min(most);
    let to_unknown = if is_measured || inputs > 2 { POINTS } else { DENSE };
    let functions = |lattice: &Lattice| lattice.cells.iter().map(|n| (n + highest) as f64).product::<f64>();
    let tests = if asked.iter().any(|own| !matches!(own, Asked::AtPoints)) { TESTS } else { 0 };
    let meshes = (1..=MOST_CELLS).map(|cells| base(bound, &proportions.cells(cells), tests));
    let resolved = |mesh: &Lattice| to_unknown * functions(mesh) <= points as f64;
    let base = meshes.take_while(resolved).last().unwrap_or_else(|| self::base(bound, &proportions.cells(1), tests));
    let lattice = |head: usize| {
        let mut lattice = base.refined(degrees[head], 1).along(schema.axes(head));
        let seen =
            schema.groups.iter().zip(&bound.coordinates).filter(|(g, _)| g.jets.iter().any(|jet| jet.head == head));
        let points = seen.flat_map(|(_, points)| points.chunks_exact(inputs));
        let places: Vec<Place> = points.map(|point| lattice.place(point)).collect();
        // What a cell's corner shows of a spline falls with its degree, and of a derivative with the degree less its order.
        let power = lattice.degree as f64 / (lattice.degree - order(schema, head)) as f64;
        lattice.keep(places.into_iter(), UNSEEN.powf(power));
        lattice
    };
    ((0..schema.heads.len()).map(lattice).collect(), base.cells.clone())
}

/// Coefficients that occur in the same row of a pair: those that do not vanish around a point or around its partner.
pub(super) fn across_pairs(heads: &Heads, bound: &Bound) -> Vec<Vec<u32>> {
    let schema = bound.problem.scene().schema;
    let (inputs, all) = (schema.coordinates.len(), || 0..heads.lattices.len());
    let around = |point: &[f64]| -> Vec<u32> {
        let of = |head: usize| heads.dofs(head, heads.lattices[head].cell_span(&heads.lattices[head].place(point)));
        all().flat_map(of).filter(|&dof| dof != NONE).collect()
    };
    let pairs = (0..schema.groups.len()).filter(|&at| schema.groups[at].paired);
    let pairs =
        pairs.flat_map(|at| bound.coordinates[at].chunks_exact(inputs).zip(bound.partners[at].chunks_exact(inputs)));
    let mut together: Vec<Vec<u32>> = pairs
        .map(|(point, partner)| {
            let mut dofs = [around(point), around(partner)].concat();
            dofs.sort_unstable();
            dofs.dedup();
            dofs
        })
        .collect();
    together.sort_unstable();
    together.dedup();
    together
}

/// Coefficients that may occur in the same row: those that do not vanish on the same cell.
pub(super) fn together(heads: &Heads, cells: &[usize]) -> Vec<Vec<u32>> {
    let on_cell = |number: usize| {
        let mut rest = number;
        let cell: Vec<usize> = cells.iter().map(|n| (rest % n, rest /= n).0).collect();
        let mut dofs = Vec::new();
        for (head, lattice) in heads.lattices.iter().enumerate() {
            let mut place = Place::default();
            lattice.axes().iter().enumerate().for_each(|(axis, &coordinate)| place.cell[axis] = cell[coordinate]);
            dofs.extend(heads.dofs(head, lattice.cell_span(&place)).filter(|&n| n != NONE));
        }
        dofs.sort_unstable();
        dofs
    };
    (0..cells.iter().product()).map(on_cell).collect()
}
