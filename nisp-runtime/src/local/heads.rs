//! All heads of a scene on their lattices, and the vector of their coefficients.

use rayon::prelude::*;

use super::block::Block;
use super::lattice::{Exponents, Lattice, NONE, Span, contracted};
use super::tabled::Splines;
use crate::bounds::{Limits, limits, sizes};
use crate::problem::Bound;
use crate::schema::Scene;
use crate::solve::vector::root_mean_square;

/// Heads as functions of one vector of coefficients, head after head, each `offset + scale * sum(coefficient * spline)`.
#[derive(Clone, Debug)]
pub(super) struct Heads {
    pub(super) lattices: Vec<Lattice>,
    /// First coefficient of every head, and the end of the last.
    pub(super) first: Vec<usize>,
    pub(super) offset: Vec<f64>,
    pub(super) scale: Vec<f64>,
    /// Bounds of heads that have them.
    pub(super) limits: Vec<Option<Limits>>,
}

/// How far an outermost function may be from a polynomial, in natural sizes of a head and cells of the domain's size.
const UNLIKE: f64 = 5e3;
/// Points whose values are computed together.
const TOGETHER: usize = 1024;

impl Heads {
    /// Rows that let a head's outermost functions, of which little is seen, go on from the next ones as a polynomial does (a ghost
    /// penalty, Burman 2010): the highest difference of the coefficients of each line. A polynomial is off by a power of the cells'
    /// size, and the rows are no stiffer than that.
    pub(super) fn continued(&self, head: usize, lines: &[Vec<u32>], theta: &[f64], learned: usize) -> Vec<Block> {
        let (first, lattice) = (self.first[head] as u32, &self.lattices[head]);
        let degree = lattice.degree;
        let cells = lattice.cells.iter().max().map_or(1.0, |cells| *cells as f64);
        let mut slopes = vec![cells.powi(degree as i32) / UNLIKE];
        for at in 0..degree {
            slopes.push(-slopes[at] * (degree - at) as f64 / (at + 1) as f64);
        }
        let row = |line: &Vec<u32>| {
            let dofs: Vec<u32> = line.iter().map(|number| first + number).collect();
            let misfit = dofs.iter().zip(&slopes).map(|(&dof, slope)| slope * theta[dof as usize]).sum();
            Block { misfits: vec![misfit], by_learned: vec![0.0; learned], dofs, slopes: slopes.clone(), excess: 0.0 }
        };
        lines.iter().map(row).collect()
    }

    /// How far a step moves a source, over its size, at most; nothing without one.
    pub(super) fn moved(&self, schema: &Scene, before: &[f64], after: &[f64]) -> f64 {
        let of = |head: usize| {
            let range = self.first[head]..self.first[head + 1];
            let change = root_mean_square(range.clone().map(|at| after[at] - before[at]));
            if change > 0.0 { change / root_mean_square(range.map(|at| after[at])) } else { 0.0 }
        };
        (0..schema.heads.len()).filter(|&head| schema.heads[head].source).map(of).fold(0.0, f64::max)
    }

    pub(super) fn new(bound: &Bound, lattices: Vec<Lattice>) -> Self {
        let schema = bound.problem.scene().schema;
        let limits = limits(schema, &bound.system);
        let (offset, scale) = sizes(bound, &limits);
        Self::over(lattices, offset, scale, limits)
    }

    /// Heads on lattices, with these offsets, scales and bounds.
    pub(super) fn over(lattices: Vec<Lattice>, offset: Vec<f64>, scale: Vec<f64>, limits: Vec<Option<Limits>>) -> Self {
        let mut first = vec![0];
        for lattice in &lattices {
            first.push(first[first.len() - 1] + lattice.len());
        }
        Self { lattices, first, offset, scale, limits }
    }

    /// A head by itself, without its offset and bounds.
    pub(super) fn alone(&self, head: usize) -> Self {
        Self::over(vec![self.lattices[head].clone()], vec![0.0], vec![self.scale[head]], vec![None])
    }

    /// Number of coefficients.
    pub(super) fn len(&self) -> usize {
        self.first[self.first.len() - 1]
    }

    /// A head's coefficients by the full numbers of its functions; zero for those that are not kept.
    pub(super) fn spread(&self, head: usize, theta: &[f64]) -> Vec<f64> {
        let own = &theta[self.first[head]..self.first[head + 1]];
        self.lattices[head].spread(own)
    }

    /// Numbers of the coefficients of a box of a head's functions; [`NONE`] for those that are not kept.
    pub(super) fn dofs(&self, head: usize, span: Span) -> impl Iterator<Item = u32> + '_ {
        let first = self.first[head] as u32;
        self.lattices[head].kept(span).map(move |n| if n == NONE { NONE } else { first + n })
    }

    /// Sum of coefficients times splines at a point, times the scale; without the offset.
    pub(super) fn sum(&self, head: usize, point: &[f64], theta: &[f64]) -> f64 {
        self.parts(head, point).into_iter().map(|(at, value)| theta[at] * value).sum()
    }

    /// The coefficients that a head's value at a point depends on, and its derivatives by them.
    pub(super) fn parts(&self, head: usize, point: &[f64]) -> Vec<(usize, f64)> {
        self.parts_of(head, point, &Exponents::default())
    }

    /// The same for a derivative of a head.
    pub(super) fn parts_of(&self, head: usize, point: &[f64], exponents: &Exponents) -> Vec<(usize, f64)> {
        let (lattice, scale) = (&self.lattices[head], self.scale[head]);
        let place = lattice.place(point);
        let mut splines = vec![0.0; lattice.per_cell()];
        lattice.values(&place, exponents, &mut splines);
        let dofs = self.dofs(head, lattice.cell_span(&place)).zip(splines);
        dofs.filter(|(dof, _)| *dof != NONE).map(|(dof, value)| (dof as usize, scale * value)).collect()
    }

    /// A head at a point over its scale, without its offset.
    pub(super) fn height(&self, head: usize, point: &[f64], theta: &[f64]) -> f64 {
        self.sum(head, point, theta) / self.scale[head]
    }

    /// Value of a head, within its bounds.
    pub(super) fn value(&self, head: usize, point: &[f64], theta: &[f64]) -> f64 {
        self.bounded(head, self.sum(head, point, theta))
    }

    /// A head's value from the sum of its functions: with its offset, within its bounds.
    fn bounded(&self, head: usize, sum: f64) -> f64 {
        let value = self.offset[head] + sum;
        self.limits[head].map_or(value, |limits| limits.within(value))
    }

    /// Values of a head at points given flat, within its bounds.
    pub(super) fn values(&self, head: usize, points: &[f64], theta: &[f64]) -> Vec<f64> {
        let (lattice, coefficients) = (&self.lattices[head], self.spread(head, theta));
        let (inputs, lines) = (lattice.inputs(), lattice.lines());
        let some = |points: &[f64]| {
            let splines = Splines::new(lattice, 0, points);
            let mut across = Vec::new();
            let value = |p: usize| {
                let along = splines.factors(p, &Exponents::default(), &mut across);
                let cell = &coefficients[lattice.first(&splines.places[p])..];
                self.bounded(head, self.scale[head] * contracted(cell, &lines, &across, along))
            };
            (0..splines.places.len()).map(value).collect::<Vec<_>>()
        };
        points.par_chunks(TOGETHER * inputs).flat_map_iter(some).collect()
    }

    /// The weight of every coefficient in a sum of a head's values at points given flat, each times its weight.
    pub(super) fn sum_weights(&self, head: usize, points: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.len()];
        for (point, weight) in points.chunks_exact(self.lattices[head].inputs()).zip(weights) {
            self.parts(head, point).into_iter().for_each(|(at, value)| sums[at] += weight * value);
        }
        sums
    }

    /// Sums of a head's functions at a point, with each of several vectors of coefficients, times the scale.
    pub(super) fn drawn<'a>(
        &self,
        head: usize,
        point: &[f64],
        vectors: &'a [Vec<f64>],
    ) -> impl Iterator<Item = f64> + use<'a> {
        let parts = self.parts(head, point);
        vectors.iter().map(move |vector| parts.iter().map(|&(at, value)| vector[at] * value).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of splines of degree 3 on 4 by 2 cells, 7 by 5, each line of a coordinate has two ends.
    #[test]
    fn outermost_functions_go_on_as_a_polynomial_does() {
        let lattice = Lattice::new(3, vec![0.0; 2], vec![1.0; 2], vec![4, 2]);
        let heads = Heads::over(vec![lattice], vec![0.0], vec![1.0], vec![None]);
        let lines: Vec<Vec<u32>> = heads.lattices[0].ends().collect();
        assert_eq!(lines.len(), 2 * (7 + 5));
        let misfits = |theta: Vec<f64>| -> Vec<f64> {
            heads.continued(0, &lines, &theta, 0).iter().map(|row| row.misfits[0]).collect()
        };
        let place = |at: usize| ((at % 7) as f64, (at / 7) as f64);
        let square = (0..35).map(place).map(|(i, j)| 3.0 + i - 2.0 * j + i * i - 4.0 * i * j + 0.5 * j * j);
        assert!(misfits(square.collect()).iter().all(|misfit| misfit.abs() < 1e-12));
        // A cube's third difference is six, up or down.
        let stiffness = 4f64.powi(3) / UNLIKE;
        let cube: Vec<f64> = (0..35).map(place).map(|(i, _)| i * i * i).collect();
        for (line, misfit) in lines.iter().zip(misfits(cube)) {
            let expected = if line[0].abs_diff(line[1]) == 1 { 6.0 * stiffness } else { 0.0 };
            assert!((misfit.abs() - expected).abs() < 1e-12, "{line:?} {misfit}");
        }
    }
}
