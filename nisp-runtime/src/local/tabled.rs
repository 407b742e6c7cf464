//! The splines of a head at points: tables along each coordinate, whose products are the functions.

use super::bspline::on_cell;
use super::lattice::{Exponents, Lattice, Place};

/// The splines of a head at points.
#[derive(Default)]
pub(super) struct Splines {
    pub(super) places: Vec<Place>,
    /// Derivatives of the splines along each of their coordinates, `[point][coordinate][order][spline]`: those of the products of
    /// splines are products of these.
    lines: Vec<f64>,
    /// The coordinates that the splines go along.
    axes: Vec<usize>,
    orders: usize,
    /// Splines along a coordinate that do not vanish on a cell.
    count: usize,
}

impl Splines {
    /// A table of points given flat, with derivatives up to an order.
    pub(super) fn new(lattice: &Lattice, highest: usize, flat: &[f64]) -> Self {
        let (axes, orders, count) = (lattice.axes().to_vec(), highest + 1, lattice.degree + 1);
        let dimensions = axes.len();
        let places: Vec<Place> = flat.chunks_exact(lattice.inputs()).map(|point| lattice.place(point)).collect();
        let mut lines = vec![0.0; places.len() * dimensions * orders * count];
        for (at, line) in lines.chunks_exact_mut(count).enumerate() {
            let (order, axis, p) = (at % orders, at / orders % dimensions, at / orders / dimensions);
            on_cell(lattice.degree, order, places[p].within[axis], line);
            let scale = lattice.spacing(axis).powi(-(order as i32));
            line.iter_mut().for_each(|value| *value *= scale);
        }
        Self { places, lines, axes, orders, count }
    }

    /// A derivative of the splines along a coordinate.
    fn line(&self, p: usize, axis: usize, order: u8) -> &[f64] {
        let at = (p * self.axes.len() + axis) * self.orders + usize::from(order);
        &self.lines[at * self.count..][..self.count]
    }

    /// A derivative of the functions of a point's cell: the splines along the first coordinate, and into `across` the products
    /// of those along the others, which each line of the cell's functions is to be multiplied with.
    pub(super) fn factors<'a>(&'a self, p: usize, exponents: &Exponents, across: &mut Vec<f64>) -> &'a [f64] {
        across.clear();
        across.push(1.0);
        for (axis, &coordinate) in self.axes.iter().enumerate().skip(1) {
            let filled = across.len();
            let line = self.line(p, axis, exponents[coordinate]);
            for &factor in &line[1..] {
                (0..filled).for_each(|i| across.push(across[i] * factor));
            }
            across[..filled].iter_mut().for_each(|product| *product *= line[0]);
        }
        self.line(p, 0, exponents[self.axes[0]])
    }
}
