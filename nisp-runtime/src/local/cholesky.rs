//! Cholesky factors of a sparse symmetric matrix, and what they say of it.
//!
//! Node by node (multifrontal; Duff and Reid 1983): the rows of a node are eliminated as a dense strip, and what they take from the
//! others that they meet waits beside it until their parent subtracts it.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::fill::{Fill, Node};
use crate::aligned::AlignedVec;
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;
use crate::solve::dense::rows::ALIGN;

/// Right-hand sides that are solved for side by side.
const SIDES: usize = 32;

/// The factor `U` of `H = U^T U`.
pub(super) struct Cholesky {
    fill: Arc<Fill>,
    isa: Isa,
    /// The strips of all nodes.
    rows: AlignedVec<f64>,
    /// What the diagonal of `H` was raised by, as a share of itself.
    pub(super) lift: f64,
}

/// A node's rows of the factor, and what is to be subtracted for them from the rows of the others that they meet.
struct Front<'a> {
    rows: &'a mut [f64],
    taken: AlignedVec<f64>,
}

impl Cholesky {
    /// Factors of a matrix, of which the lower triangle is given; nothing where it is not positive definite, or memory too small.
    pub(super) fn of(fill: &Arc<Fill>, values: &[f64]) -> Option<Self> {
        let isa = Isa::detect();
        let len = fill.nodes.iter().map(|node| node.strip.len()).sum();
        let mut rows = fill.spare.zeros(len)?;
        fill.targets.iter().zip(values).for_each(|(&target, value)| rows[target] += value);
        let mut rest = &mut *rows;
        let front = |node: &Node| {
            let (rows, after) = std::mem::take(&mut rest).split_at_mut(node.strip.len());
            rest = after;
            Front { rows, taken: AlignedVec::default() }
        };
        let mut fronts: Vec<Front> = fill.nodes.iter().map(front).collect();
        let (mut rest, mut done) = (fronts.as_mut_slice(), 0);
        let subtree = |subtree: &Range<usize>| {
            let after = std::mem::take(&mut rest).split_at_mut(subtree.start - done).1;
            let (own, after) = after.split_at_mut(subtree.len());
            (rest, done) = (after, subtree.end);
            (subtree.start, own)
        };
        let subtrees: Vec<(usize, &mut [Front])> = fill.subtrees.iter().map(subtree).collect();
        let whole = |(first, own): (usize, &mut [Front])| {
            let mut nodes = first..first + own.len();
            nodes.try_for_each(|node| eliminate(fill, isa, (first, own), node))
        };
        subtrees.into_par_iter().map(whole).collect::<Option<()>>()?;
        let mut above = (0..fill.nodes.len()).filter(|&node| !fill.subtrees.iter().any(|own| own.contains(&node)));
        above.try_for_each(|node| eliminate(fill, isa, (0, &mut fronts), node))?;
        rows[..len].iter().all(|x| x.is_finite()).then(|| Self { fill: fill.clone(), isa, rows, lift: 0.0 })
    }

    /// `H^-1` times vectors; nothing where memory is too small.
    pub(super) fn solve(&self, right: &[impl AsRef<[f64]>]) -> Option<Vec<Vec<f64>>> {
        let right: Vec<&[f64]> = right.iter().map(AsRef::as_ref).collect();
        let some: Option<Vec<Vec<Vec<f64>>>> = right.par_chunks(SIDES).map(|some| self.solve_some(some)).collect();
        Some(some?.into_iter().flatten().collect())
    }

    /// Solves for a few right-hand sides, which lie side by side meanwhile.
    fn solve_some(&self, right: &[&[f64]]) -> Option<Vec<Vec<f64>>> {
        let (fill, isa, sides) = (&*self.fill, self.isa, right.len().next_multiple_of(ALIGN));
        let mut x = fill.spare.zeros(fill.places.len() * sides)?;
        for (side, right) in right.iter().enumerate() {
            fill.places.iter().zip(*right).for_each(|(place, b)| x[place * sides + side] = *b);
        }
        let most = fill.nodes.iter().map(|node| node.others.len()).max().unwrap_or(0);
        let mut of_others = fill.spare.any(most * sides)?;
        let own = |node: &Node| node.first * sides..(node.first + node.strip.width) * sides;
        for node in &fill.nodes {
            let (rows, strip, count) = (self.rows_of(node), node.strip, node.others.len());
            strip.solve_transposed(isa, rows, &mut x[own(node)], (sides, sides));
            let shape = Shape { rows: count, columns: sides, inner: strip.width };
            let right = Right::Rows { elements: &x[own(node)], stride: sides };
            let left = Left::transposed(&rows[strip.others()..], strip.stride);
            gemm(isa, shape, left, right, &mut of_others, sides, Write::Set);
            for (&other, row) in node.others.iter().zip(of_others.chunks_exact(sides)) {
                x[other * sides..][..sides].iter_mut().zip(row).for_each(|(x, row)| *x -= row);
            }
        }
        for node in fill.nodes.iter().rev() {
            let (rows, strip, count) = (self.rows_of(node), node.strip, node.others.len());
            for (&other, row) in node.others.iter().zip(of_others.chunks_exact_mut(sides)) {
                row.copy_from_slice(&x[other * sides..][..sides]);
            }
            let shape = Shape { rows: strip.width, columns: sides, inner: count };
            let right = Right::Rows { elements: &of_others, stride: sides };
            let left = Left::rows(&rows[strip.others()..], strip.stride);
            gemm(isa, shape, left, right, &mut x[own(node)], sides, Write::Subtract);
            strip.solve(isa, rows, &mut x[own(node)], sides);
        }
        let solution = |side: usize| fill.places.iter().map(|place| x[place * sides + side]).collect();
        let solutions = (0..right.len()).map(solution).collect();
        [x, of_others].into_iter().for_each(|vector| fill.spare.give_back(vector));
        Some(solutions)
    }

    fn rows_of(&self, node: &Node) -> &[f64] {
        &self.rows[node.start..][..node.strip.len()]
    }

    /// Logarithm of the determinant of `H`; nothing where rounding has made it another one.
    pub(super) fn log_determinant(&self) -> Option<f64> {
        let of_node = |node: &Node| {
            let diagonal = self.rows_of(node).iter().step_by(node.strip.stride + 1);
            diagonal.map(|x| x.ln()).sum::<f64>()
        };
        (self.lift == 0.0).then(|| 2.0 * self.fill.nodes.iter().map(of_node).sum::<f64>())
    }
}

impl Drop for Cholesky {
    fn drop(&mut self) {
        self.fill.spare.give_back(std::mem::take(&mut self.rows));
    }
}

/// Eliminates a node, whose children were eliminated, among fronts of which the number of the first is given. Nothing where the
/// matrix is not positive definite, or memory too small.
fn eliminate(fill: &Fill, isa: Isa, (first, fronts): (usize, &mut [Front]), at: usize) -> Option<()> {
    let node = &fill.nodes[at];
    let (below, own) = fronts.split_at_mut(at - first);
    let (Front { rows, taken }, strip) = (&mut own[0], node.strip);
    for &child in &node.children {
        let (child, from) = (&fill.nodes[child], &below[child - first].taken);
        child.pass_on(from, 0..strip.width, rows, strip.stride, |own, taken| *own -= taken);
    }
    let len = node.others.len() * strip.apart();
    *taken = fill.spare.any(len)?;
    if !strip.eliminate(isa, rows, &mut taken[..len]) {
        return None;
    }
    for &child in &node.children {
        let from = std::mem::take(&mut below[child - first].taken);
        let columns = strip.others()..strip.stride;
        fill.nodes[child].pass_on(&from, columns, taken, strip.apart(), |own, taken| *own += taken);
        fill.spare.give_back(from);
    }
    Some(())
}

impl Node {
    /// Joins what this node has taken from others, those that are such columns of its parent, to the parent's rows for them, which
    /// begin with the first of these columns.
    fn pass_on(&self, taken: &[f64], own: Range<usize>, rows: &mut [f64], stride: usize, join: impl Fn(&mut f64, f64)) {
        for (number, run) in self.runs.iter().enumerate() {
            let columns = run.column.max(own.start)..(run.column + run.len).min(own.end);
            for column in columns {
                let at = column - run.column;
                let row = &mut rows[(column - own.start) * stride..];
                let from = &taken[(run.first + at) * self.strip.apart()..];
                let mut add = |first: usize, column: usize, len: usize| {
                    let to = &mut row[column - own.start..][..len];
                    to.iter_mut().zip(&from[first..]).for_each(|(own, taken)| join(own, *taken));
                };
                add(run.first + at, column, run.len - at);
                self.runs[number + 1..].iter().for_each(|run| add(run.first, run.column, run.len));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::entries::Entries;

    /// Unknowns on a lattice of nodes with some fields each, which meet those of neighbouring nodes.
    fn lattice(side: usize, fields: usize) -> (Entries, Vec<f64>) {
        let place = |unknown: usize| (unknown / fields % side, unknown / fields / side);
        let near = |a: usize, b: usize| {
            let (a, b) = (place(a), place(b));
            a.0.abs_diff(b.0) < 2 && a.1.abs_diff(b.1) < 2
        };
        let count = side * side * fields;
        let entries = Entries::of((0..count).map(|a| (a..count).filter(|&b| near(a, b)).collect()));
        let entry = |(a, b): (usize, usize)| if a == b { 12.0 * fields as f64 } else { ((a * 7 + b * 3) as f64).sin() };
        let values = (0..count).flat_map(|a| entries.column(a).iter().map(move |&b| entry((a, b)))).collect();
        (entries, values)
    }

    /// Against dense factors, on lattices small enough for one subtree and large enough for several.
    #[test]
    fn solutions_and_determinants_are_those_of_the_dense_matrix() {
        for (side, fields) in [(1, 1), (4, 1), (9, 3), (30, 1)] {
            let (entries, values) = lattice(side, fields);
            let count = entries.len();
            let mut dense = nalgebra::DMatrix::zeros(count, count);
            for column in 0..count {
                for at in entries.starts[column]..entries.starts[column + 1] {
                    dense[(entries.rows[at], column)] = values[at];
                    dense[(column, entries.rows[at])] = values[at];
                }
            }
            let fill = Arc::new(Fill::of(&entries, Arc::default()).unwrap());
            let factor = Cholesky::of(&fill, &values).unwrap();
            let sides: Vec<Vec<f64>> =
                (0..SIDES + 3).map(|side| (0..count).map(|at| ((at * side) as f64 * 0.3).cos()).collect()).collect();
            let dense = dense.cholesky().unwrap();
            for (found, side) in factor.solve(&sides).unwrap().iter().zip(&sides) {
                let expected = dense.solve(&nalgebra::DVector::from_column_slice(side));
                let off = found.iter().zip(expected.iter()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                assert!(off < 1e-12, "{side:?}: {off:e}");
            }
            let expected: f64 = (0..count).map(|at| 2.0 * dense.l_dirty()[(at, at)].ln()).sum();
            assert!((factor.log_determinant().unwrap() - expected).abs() < 1e-9 * count as f64);
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factors() {
        let (entries, mut values) = lattice(6, 2);
        values[entries.starts[17]] = -1.0;
        assert!(Cholesky::of(&Arc::new(Fill::of(&entries, Arc::default()).unwrap()), &values).is_none());
    }
}
