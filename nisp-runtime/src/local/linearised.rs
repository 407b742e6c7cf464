//! Derivatives of a group's rows by the coefficients around its points and its tests.

use rayon::prelude::*;

use super::block::{Block, Layout};
use super::group::{BATCH, Group};
use super::heads::Heads;
use super::lattice::{MOST_COORDINATES, NONE, Span};
use super::rows::Evaluated;
use super::sites::Sites;
use super::testing::Test;

/// What is kept from a point to the next.
struct Kept {
    record: Vec<f64>,
    across: Vec<f64>,
    /// The point whose cell `dofs` are of.
    point: Option<u32>,
    dofs: Vec<u32>,
}

impl Group {
    /// Rows over their tolerances and their derivatives: of every test, or of every point where equations are asked of points.
    pub(super) fn blocks(&self, heads: &Heads, evaluated: &Evaluated, learned: &[f64]) -> Vec<Block> {
        if self.own_rows().is_empty() {
            return Vec::new();
        }
        if self.tests.is_empty() {
            let points: Vec<u32> = (0..self.sites.count as u32).collect();
            return self.at_points(heads, evaluated, learned, &points);
        }
        self.at_tests(heads, evaluated, learned)
    }

    /// The rows of every test, linearised.
    fn at_tests(&self, heads: &Heads, evaluated: &Evaluated, learned: &[f64]) -> Vec<Block> {
        let rows = self.own_rows();
        let layout = self.layout(heads, rows.len(), learned.len());
        let mut records = vec![0.0; self.weights.len() * layout.len()];
        let record = |across: &mut Vec<f64>, (number, record): (usize, &mut [f64])| {
            // It is zero already, but fresh pages that are read before they are written are mapped twice.
            record.fill(0.0);
            self.record(heads, evaluated, learned, (number, &rows), (layout, record), across);
        };
        records.par_chunks_exact_mut(layout.len()).enumerate().for_each_init(Vec::new, record);
        let record = |p: usize| &records[p * layout.len()..][..layout.len()];
        let tested = |sum: &mut Vec<f64>, (place, test): (usize, &Test)| {
            let mut block = Block::new(layout, self.dofs(heads, |(_, head)| self.span(heads, test, head)));
            let cells = |p: u32| self.sites.cells(p);
            for points in test.points.chunk_by(|&(p, _), &(q, _)| cells(p).eq(cells(q))) {
                sum.clear();
                sum.resize(layout.len(), 0.0);
                for &(p, share) in points {
                    sum.iter_mut().zip(record(p as usize)).for_each(|(sum, value)| *sum += share * value);
                }
                let p = points[0].0 as usize;
                let boxes = self.read(heads).map(|slot| (self.cell(heads, p, slot), self.span(heads, test, slot.1)));
                let dimensions = self.read(heads).map(|(_, head)| heads.lattices[head].dimensions());
                block.add(layout, sum, boxes.zip(dimensions));
            }
            block.divide(rows.iter().map(|&row| self.divisor(row, place)));
            self.majorise(&mut block, &rows);
            block
        };
        self.tests.par_iter().enumerate().map_init(Vec::new, tested).collect()
    }

    /// The rows of all points and their derivatives, batch by batch, so that memory is bounded however many points there are, or those of
    /// all tests; zeros where `counts`, by row and place, says that a row does not count.
    pub(super) fn batches(
        &self,
        heads: &Heads,
        evaluated: &Evaluated,
        learned: &[f64],
        counts: &[Vec<bool>],
    ) -> impl Iterator<Item = Vec<Block>> {
        let rows = self.own_rows();
        // Means are made from the rows of all points at once.
        let together = if self.tests.is_empty() { BATCH } else { self.places() };
        self.order.chunks(together).map(move |places| {
            let mut blocks = match self.tests.is_empty() {
                true => self.at_points(heads, evaluated, learned, places),
                false => self.at_tests(heads, evaluated, learned),
            };
            for (&place, block) in places.iter().zip(&mut blocks) {
                let left_out = rows.iter().enumerate().filter(|&(_, &row)| !counts[row][place as usize]);
                left_out.for_each(|(at, _)| block.clear(at));
            }
            blocks
        })
    }

    /// Rows over their tolerances at points, and their derivatives.
    fn at_points(&self, heads: &Heads, evaluated: &Evaluated, learned: &[f64], points: &[u32]) -> Vec<Block> {
        let rows = self.own_rows();
        let layout = self.layout(heads, rows.len(), learned.len());
        let at_point = |kept: &mut Kept, &p: &u32| {
            let Kept { record, across, point, dofs } = kept;
            let p = p as usize;
            record.fill(0.0);
            self.record(heads, evaluated, learned, (p, &rows), (layout, record), across);
            if point.is_none_or(|other| !self.sites.cells(other).eq(self.sites.cells(p as u32))) {
                *dofs = self.dofs(heads, |slot| self.cell(heads, p, slot));
                *point = Some(p as u32);
            }
            let mut block = Block::of(layout, record, dofs.clone());
            block.divide(rows.iter().map(|&row| self.divisor(row, p)));
            self.majorise(&mut block, &rows);
            block
        };
        let kept = || Kept { record: vec![0.0; layout.len()], across: Vec::new(), point: None, dofs: Vec::new() };
        points.par_iter().map_init(kept, at_point).collect()
    }

    /// The rows of a point and their derivatives, added to a record of zeros.
    fn record(
        &self,
        heads: &Heads,
        evaluated: &Evaluated,
        learned: &[f64],
        (p, rows): (usize, &[usize]),
        (layout, record): (Layout, &mut [f64]),
        across: &mut Vec<f64>,
    ) {
        for (misfit, &row) in record.iter_mut().zip(rows) {
            *misfit = evaluated.row(row, p);
        }
        let seed = |at: usize, bar| evaluated.bar(rows[at], bar, p);
        self.add_slopes(heads, &self.sites, p, (layout, record), learned, seed, across);
    }

    /// Multiplies rows over their tolerances so that their squares have the slopes of robust losses.
    fn majorise(&self, block: &mut Block, rows: &[usize]) {
        let robust = |row: usize| Some(self.losses[row]).filter(|(loss, _)| loss.is_robust());
        if rows.iter().all(|&row| robust(row).is_none()) {
            return;
        }
        let majorants = rows.iter().zip(&block.misfits).map(|(&row, misfit)| {
            robust(row).map_or((1.0, 0.0), |(loss, times)| {
                let (weight, rest) = loss.majorant(misfit / times.sqrt());
                (weight, 0.5 * times * rest)
            })
        });
        let (weights, excess): (Vec<f64>, Vec<f64>) = majorants.unzip();
        block.divide(weights.into_iter().map(|weight| weight.sqrt().recip()));
        block.excess = excess.into_iter().sum();
    }

    /// How rows at a point lie in memory.
    fn layout(&self, heads: &Heads, rows: usize, learned: usize) -> Layout {
        Layout { rows, learned, width: self.read(heads).map(|(_, head)| heads.lattices[head].per_cell()).sum() }
    }

    /// Functions of a head around a test.
    fn span(&self, heads: &Heads, test: &Test, head: usize) -> Span {
        let lattice = &heads.lattices[head];
        let times = lattice.cells[0] / self.base[lattice.axes()[0]];
        let mut first = [0; MOST_COORDINATES];
        lattice.axes().iter().zip(&mut first).for_each(|(&axis, first)| *first = test.cell[axis] * times);
        Span { first, count: (self.degree + 1) * times + lattice.degree }
    }

    /// Coefficients that occur together in the tests.
    pub(super) fn together(&self, heads: &Heads) -> Vec<Vec<u32>> {
        let of = |test: &Test| {
            let mut dofs = self.dofs(heads, |(_, head)| self.span(heads, test, head));
            dofs.retain(|dof| *dof != NONE);
            dofs
        };
        self.tests.iter().map(of).collect()
    }

    /// Functions of a head on the cell of one of the group's points, or of its partner.
    fn cell(&self, heads: &Heads, p: usize, (slot, head): (usize, usize)) -> Span {
        heads.lattices[head].cell_span(&self.sites.splines[slot].places[p])
    }

    /// Numbers of the coefficients of boxes of functions.
    fn dofs(&self, heads: &Heads, span: impl Fn((usize, usize)) -> Span) -> Vec<u32> {
        self.read(heads).flat_map(|slot| heads.dofs(slot.1, span(slot))).collect()
    }

    /// A row at a point of which the misfit is known, and by `seed(jet or learned scalar)` the derivatives.
    pub(super) fn at_point(
        &self,
        heads: &Heads,
        (sites, p): (&Sites, usize),
        learned: &[f64],
        misfit: f64,
        seed: impl Fn(usize) -> f64,
    ) -> Block {
        let layout = self.layout(heads, 1, learned.len());
        let mut record = vec![0.0; layout.len()];
        record[0] = misfit;
        self.add_slopes(heads, sites, p, (layout, &mut record), learned, |_, bar| seed(bar), &mut Vec::new());
        let cell = |(slot, head): (usize, usize)| heads.lattices[head].cell_span(&sites.splines[slot].places[p]);
        Block::of(layout, &record, self.dofs(heads, cell))
    }

    /// Adds to the rows of a point their derivatives, of which `seed(row, jet or learned scalar)` gives those by jets.
    #[expect(clippy::too_many_arguments)]
    fn add_slopes(
        &self,
        heads: &Heads,
        sites: &Sites,
        p: usize,
        (layout, record): (Layout, &mut [f64]),
        learned: &[f64],
        seed: impl Fn(usize, usize) -> f64,
        across: &mut Vec<f64>,
    ) {
        let (_, by_learned, slopes) = layout.split_mut(record);
        let mut first = vec![0; self.highest.len()];
        let mut width = 0;
        for (slot, head) in self.read(heads) {
            first[slot] = width;
            width += heads.lattices[head].per_cell();
        }
        for (number, (jet, operator)) in self.schema.jets.iter().zip(&self.operators).enumerate() {
            let slot = self.slots[number];
            for (exponents, coefficient) in operator {
                let along = sites.splines[slot].factors(p, exponents, across);
                let factor = coefficient * heads.scale[jet.head];
                for row in 0..layout.rows {
                    let factor = factor * seed(row, number);
                    if factor == 0.0 {
                        continue;
                    }
                    let slopes = &mut slopes[row * layout.width + first[slot]..];
                    for (line, across) in slopes.chunks_exact_mut(along.len()).zip(across.iter()) {
                        let factor = factor * across;
                        line.iter_mut().zip(along).for_each(|(slope, along)| *slope += factor * along);
                    }
                }
            }
        }
        for (row, by_learned) in by_learned.chunks_exact_mut(learned.len().max(1)).enumerate() {
            for (at, (sum, learned)) in by_learned.iter_mut().zip(learned).enumerate() {
                *sum += seed(row, self.schema.jets.len() + at) * learned;
            }
        }
    }
}
