//! Which lattices carry a problem's heads, and which of their coefficients meet in a row.

use super::Local;
use super::heads::Heads;
use super::lattice::{Lattice, MOST_COORDINATES, NONE, Span};
use crate::ends::ranges;
use crate::problem::Bound;

/// The lattice of the state: by coordinate, so many cells along the longest of those that share a scale with it.
pub(super) fn base(bound: &Bound, cells: &[f64], tests: usize) -> Lattice {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let (mut low, mut spacing, mut count) = (Vec::new(), Vec::new(), Vec::new());
    let ranges = ranges(&bound.coordinates, inputs);
    for axis in 0..inputs {
        let group = schema.coordinates[axis].scale_group;
        let tied = (0..inputs).filter(|&other| schema.coordinates[other].scale_group == group);
        let longest = tied.map(|other| ranges[other].1 - ranges[other].0).fold(0.0, f64::max);
        // Along a coordinate that all points share, any size will do.
        let h = if longest > 0.0 { longest / cells[axis] } else { 1.0 };
        let (from, to) = ranges[axis];
        // Rounding must not add a cell.
        let own = ((to - from) / h - 1e-9).ceil().max((tests + 1) as f64);
        low.push((from + to - own * h) / 2.0);
        spacing.push(h);
        count.push(own as usize);
    }
    Lattice::new(1, low, spacing, count)
}

/// A head's lattice: splines of at least its highest derivative for a field, hats on finer cells for a source.
pub(super) fn lattice(bound: &Bound, settings: &Local, base: &Lattice, head: usize) -> Lattice {
    let schema = bound.problem.scene().schema;
    if schema.heads[head].source {
        return base.refined(1, settings.finer);
    }
    let jets = schema.groups.iter().flat_map(|group| group.jets).filter(|jet| jet.head == head);
    let order = jets.map(|jet| jet.degree.iter().map(|&n| usize::from(n)).sum::<usize>()).max().unwrap_or(0);
    base.refined(settings.degree.max(order), 1)
}

/// Coefficients that may occur in the same row: those around each test that sees points.
pub(super) fn together(heads: &Heads, base: &Lattice, tests: usize, bound: &Bound) -> Vec<Vec<u32>> {
    let inputs = base.dimensions();
    let mut nodes = std::collections::BTreeSet::new();
    for points in &bound.coordinates {
        for point in points.chunks_exact(inputs) {
            nodes.extend(base.around(&base.place(point), tests));
        }
    }
    let around = |cell: [usize; MOST_COORDINATES]| {
        let mut dofs = Vec::new();
        for (head, lattice) in heads.lattices.iter().enumerate() {
            let times = lattice.cells[0] / base.cells[0];
            let span = Span { first: cell.map(|c| c * times), count: (tests + 1) * times + lattice.degree };
            let kept = lattice.kept(span).filter(|&n| n != NONE);
            dofs.extend(kept.map(|n| heads.first[head] as u32 + n));
        }
        dofs.sort_unstable();
        dofs
    };
    nodes.into_iter().map(around).collect()
}
