//! The rows of a group: misfits of its terms at its places, and their derivatives by the coefficients around each.

use super::heads::Heads;
use super::rows::Bundle;
use crate::bounds::{RawAlong, towers};
use crate::facts::Facts;
use crate::kernel::GroupKernel;
use crate::residual::Points;
use crate::schema;
use crate::simd::Isa;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// A group at its places.
pub(super) struct Group {
    pub(super) schema: &'static schema::Group,
    pub(super) kernel: GroupKernel<f64>,
    /// Places at which all of its terms are asked for. The others, behind them, lie between these.
    pub(super) own: usize,
    /// The cell of each place.
    cells: Vec<usize>,
    stride: usize,
    pub(super) coordinates: Vec<f64>,
    columns: Vec<f64>,
    /// Heads that the group reads.
    read: Vec<usize>,
    /// By head and order of a derivative that the group reads, the splines at its places.
    lines: Vec<Lines>,
    /// By jet: its derivatives as indices into the lines, with their coefficients.
    operators: Vec<Vec<(usize, f64)>>,
    /// Jets of bounded heads: values, each with its derivatives behind it.
    towers: Vec<Vec<usize>>,
}

/// A derivative of a head's splines at all places, `[place][spline]`.
struct Lines {
    head: usize,
    order: usize,
    values: Vec<f64>,
}

/// Values of all rows at all places, and their derivatives.
pub(super) struct Evaluated {
    stride: usize,
    /// `[row][place]`
    rows: Vec<f64>,
    /// By row: `[jet or learned scalar][place]`.
    bars: Vec<Vec<f64>>,
}

impl Group {
    /// A column, at its places and the padding.
    pub(super) fn column(&mut self, column: usize) -> &mut [f64] {
        &mut self.columns[column * self.stride..][..self.stride]
    }

    /// A group at places, with columns `[column][place]`.
    pub(super) fn new(
        schema: &'static schema::Group,
        kernel: GroupKernel<f64>,
        heads: &Heads,
        places: &[f64],
        columns: &[Vec<f64>],
    ) -> Self {
        let stride = places.len().next_multiple_of(LANES);
        let padded = |values: &[f64]| (0..stride).map(|p| values[p.min(places.len() - 1)]).collect::<Vec<_>>();
        let places_in_cells: Vec<(usize, f64)> = places.iter().map(|&at| (heads.cell(at), at)).collect();
        let mut lines: Vec<Lines> = Vec::new();
        let mut index = |head: usize, order: usize| {
            let known = lines.iter().position(|lines| (lines.head, lines.order) == (head, order));
            known.unwrap_or_else(|| {
                let basis = &heads.bases[head];
                let line = |&(cell, at): &(usize, f64)| basis.line(cell, at, order).into_iter().take(basis.degree + 1);
                lines.push(Lines { head, order, values: places_in_cells.iter().flat_map(line).collect() });
                lines.len() - 1
            })
        };
        let operator = |jet: &schema::Jet| {
            jet.operator.iter().map(|(order, c)| (index(jet.head, usize::from(order[0])), *c)).collect()
        };
        let operators = schema.jets.iter().map(operator).collect();
        let mut read: Vec<usize> = schema.jets.iter().map(|jet| jet.head).collect();
        read.sort_unstable();
        read.dedup();
        Self {
            schema,
            kernel,
            own: places.len(),
            cells: places_in_cells.into_iter().map(|(cell, _)| cell).collect(),
            stride,
            coordinates: padded(places),
            columns: columns.iter().flat_map(|column| padded(column)).collect(),
            read,
            lines,
            operators,
            towers: towers(schema, |head| heads.limits[head].is_some()).unwrap_or_default(),
        }
    }

    /// Says where on the coordinate the place is that its splines take for zero: what programs read is so much farther on.
    pub(super) fn begin_at(&mut self, places: &[f64], zero: f64) {
        let last = places.len() - 1;
        self.coordinates.iter_mut().enumerate().for_each(|(p, x)| *x = zero + places[p.min(last)]);
    }

    /// Number of places.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// What the heads say at the places.
    pub(super) fn facts(&self, heads: &Heads, theta: &[f64]) -> Facts {
        self.jets(heads, theta).0
    }

    /// The jets, and what programs read of bounded heads, by tower and place.
    fn jets(&self, heads: &Heads, theta: &[f64]) -> (Facts, Vec<Vec<RawAlong>>) {
        let mut jets = vec![0.0; self.schema.jets.len() * self.stride];
        let all = self.schema.jets.iter().zip(&self.operators).zip(jets.chunks_exact_mut(self.stride.max(1)));
        for ((jet, operator), out) in all {
            let width = heads.bases[jet.head].degree + 1;
            for (index, coefficient) in operator {
                let lines = &self.lines[*index];
                let factor = coefficient * heads.scale[jet.head];
                let offset = if lines.order == 0 { coefficient * heads.offset[jet.head] } else { 0.0 };
                for ((out, &cell), line) in out.iter_mut().zip(&self.cells).zip(lines.values.chunks_exact(width)) {
                    let numbers = heads.numbers(jet.head, cell);
                    let sum: f64 = numbers.iter().zip(line).map(|(&n, b)| theta[n] * b).sum();
                    *out += offset + factor * sum;
                }
            }
        }
        let bounded = self.towers.iter().map(|tower| self.bound(tower, heads, &mut jets)).collect();
        if let Some(last) = self.len().checked_sub(1) {
            jets.chunks_exact_mut(self.stride).for_each(|out| {
                let last = out[last];
                out[self.len()..].fill(last);
            });
        }
        let facts = Facts {
            points: self.len(),
            stride: self.stride,
            jets,
            coordinates: self.coordinates.clone(),
            columns: self.columns.clone(),
            means: Vec::new(),
        };
        (facts, bounded)
    }

    /// Replaces the jets of a bounded head by what programs read of it.
    fn bound(&self, tower: &[usize], heads: &Heads, jets: &mut [f64]) -> Vec<RawAlong> {
        let head = self.schema.jets[tower[0]].head;
        let Some(limits) = heads.limits[head] else { return Vec::new() };
        let mut derivatives = Vec::with_capacity(tower.len());
        let read = |p: usize| {
            derivatives.clear();
            derivatives.extend(tower.iter().map(|jet| jets[jet * self.stride + p]));
            let raw = limits.raw_along(heads.scale[head], &derivatives);
            tower.iter().zip(raw.numbers).for_each(|(jet, number)| jets[jet * self.stride + p] = number);
            raw
        };
        (0..self.len()).map(read).collect()
    }

    /// Values of all rows, and their derivatives by jets and so many learned scalars where they are wanted.
    pub(super) fn evaluate(&self, heads: &Heads, theta: &[f64], scalars: &[f64], slopes: Option<usize>) -> Evaluated {
        let (facts, bounded) = self.jets(heads, theta);
        let points = Points {
            count: self.len(),
            stride: self.stride,
            jets: &facts.jets,
            coordinates: &self.coordinates,
            columns: &self.columns,
            scalars,
            seeds: &[],
        };
        let mut rows = vec![0.0; self.schema.rows * self.stride];
        self.kernel.programs.residual(Isa::detect(), points, &mut rows);
        let bars = |row: usize, learned: usize| {
            let mut seeds = vec![0.0; self.schema.rows * self.stride];
            seeds[row * self.stride..][..self.stride].fill(1.0);
            let mut bars = vec![0.0; (self.schema.jets.len() + scalars.len()) * self.stride];
            self.kernel.programs.adjoint(Isa::detect(), Points { seeds: &seeds, ..points }, &mut bars);
            bars.truncate((self.schema.jets.len() + learned) * self.stride);
            bars.shrink_to_fit();
            bars
        };
        let is_beyond = bounded.iter().flatten().any(|raw| raw.rest != 0.0);
        let wanted = slopes.or(is_beyond.then_some(0));
        let mut bars: Vec<Vec<f64>> =
            wanted.map(|learned| (0..self.schema.rows).map(|row| bars(row, learned)).collect()).unwrap_or_default();
        let mut by_numbers = Vec::new();
        for (tower, bounded) in self.towers.iter().zip(&bounded) {
            for (row, bars) in bars.iter_mut().enumerate() {
                for (p, raw) in bounded.iter().enumerate() {
                    by_numbers.clear();
                    by_numbers.extend(tower.iter().map(|jet| bars[jet * self.stride + p]));
                    let by_head = raw.pull(&by_numbers);
                    tower.iter().zip(by_head).for_each(|(jet, bar)| bars[jet * self.stride + p] = bar);
                    rows[row * self.stride + p] += by_head[0] * raw.rest;
                }
            }
        }
        Evaluated { stride: self.stride, rows, bars }
    }

    /// Places by cell, those that count: each cell with its places.
    pub(super) fn by_cell<'a>(
        &'a self,
        counts: impl Fn(usize) -> bool,
    ) -> impl Iterator<Item = (usize, Vec<usize>)> + 'a {
        let mut order: Vec<usize> = (0..self.len()).filter(|&p| counts(p)).collect();
        order.sort_by_key(|&p| self.cells[p]);
        let mut order = order.into_iter().peekable();
        std::iter::from_fn(move || {
            let first = order.next()?;
            let cell = self.cells[first];
            let mut own = vec![first];
            own.extend(std::iter::from_fn(|| order.next_if(|&p| self.cells[p] == cell)));
            Some((cell, own))
        })
    }

    /// The cell of a place.
    pub(super) fn cell(&self, p: usize) -> usize {
        self.cells[p]
    }

    /// The first unknown that a row at a place sees, and how many from there on it may.
    pub(super) fn span(&self, heads: &Heads, p: usize) -> (usize, usize) {
        heads.span(&self.read, self.cells[p])
    }

    /// No rows yet on a cell.
    pub(super) fn bundle(&self, heads: &Heads, cell: usize, shared: usize) -> Bundle {
        let (first, width) = heads.span(&self.read, cell);
        Bundle::new(first, width, shared)
    }

    /// Adds a row at a place of the cell, multiplied with `factor`; `by` are the learned scalars' derivatives by their
    /// parameters.
    pub(super) fn add_row(
        &self,
        heads: &Heads,
        (found, row, p): (&Evaluated, usize, usize),
        by: &[f64],
        factor: f64,
        out: &mut Bundle,
    ) {
        let cell = self.cells[p];
        let (first, _) = heads.span(&self.read, cell);
        let (slopes, shared, value) = out.add();
        let bar = |number: usize| factor * found.bars[row][number * found.stride + p];
        for (number, jet) in self.schema.jets.iter().enumerate() {
            let seed = bar(number) * heads.scale[jet.head];
            if seed == 0.0 {
                continue;
            }
            let width = heads.bases[jet.head].degree + 1;
            for (index, coefficient) in &self.operators[number] {
                let line = &self.lines[*index].values[p * width..][..width];
                for (&n, value) in heads.numbers(jet.head, cell).iter().zip(line) {
                    slopes[n - first] += seed * coefficient * value;
                }
            }
        }
        let jets = self.schema.jets.len();
        shared.iter_mut().zip(by).enumerate().for_each(|(at, (out, by))| *out = bar(jets + at) * by);
        *value = factor * found.row(row, p);
    }
}

impl Evaluated {
    /// Value of a row at a place.
    pub(super) fn row(&self, row: usize, p: usize) -> f64 {
        self.rows[row * self.stride + p]
    }
}
