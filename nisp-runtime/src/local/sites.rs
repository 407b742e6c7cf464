//! Points, and the splines at them, which do not change while coefficients do.

use super::bspline::on_cell;
use super::heads::Heads;
use super::lattice::{Exponents, Lattice, Place};

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// Points as programs read them, and the splines of the heads at them.
pub(super) struct Sites {
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) coordinates: Vec<f64>,
    pub(super) columns: Vec<f64>,
    /// By head; of heads that nobody reads here, no points.
    pub(super) splines: Vec<Splines>,
}

/// The splines of a head at points.
#[derive(Default)]
pub(super) struct Splines {
    pub(super) places: Vec<Place>,
    /// Derivatives of the splines along each of their coordinates, `[point][coordinate][order][spline]`: those of the products of splines
    /// are products of these.
    lines: Vec<f64>,
    /// The coordinates that the splines go along.
    axes: Vec<usize>,
    orders: usize,
    /// Splines along a coordinate that do not vanish on a cell.
    count: usize,
}

impl Sites {
    /// Points given flat, point by point, with columns `[column][point]`; `highest` has, by head, the highest derivative that
    /// is read, or nothing.
    pub(super) fn new(heads: &Heads, highest: &[Option<u8>], flat: &[f64], columns: &[Vec<f64>]) -> Self {
        let inputs = heads.lattices[0].inputs();
        let count = flat.len() / inputs;
        let stride = count.next_multiple_of(LANES);
        let spread = |value: &dyn Fn(usize) -> f64| (0..stride).map(|p| value(p.min(count - 1))).collect::<Vec<_>>();
        let splines = |(lattice, highest): (&Lattice, &Option<u8>)| {
            highest.map(|highest| Splines::new(lattice, usize::from(highest), flat)).unwrap_or_default()
        };
        Self {
            count,
            stride,
            coordinates: (0..inputs).flat_map(|i| spread(&|p| flat[p * inputs + i])).collect(),
            columns: columns.iter().flat_map(|column| spread(&|p| column[p])).collect(),
            splines: heads.lattices.iter().zip(highest).map(splines).collect(),
        }
    }
}

impl Splines {
    fn new(lattice: &Lattice, highest: usize, flat: &[f64]) -> Self {
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
