//! A few rows that depend on the same few coefficients.

use super::lattice::{NONE, Span};

/// Rows, and their derivatives by the coefficients of some boxes of functions and by the learned scalars.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) misfits: Vec<f64>,
    /// `[row][learned parameter]`
    pub(super) by_learned: Vec<f64>,
    /// Numbers of the coefficients; [`NONE`] for functions that are not kept.
    pub(super) dofs: Vec<u32>,
    /// `[row][coefficient]`
    pub(super) slopes: Vec<f64>,
    /// What the loss of the rows has beyond half their squares, where robust losses are majorised.
    pub(super) excess: f64,
}

/// How the rows of a point lie in a plain slice: misfits, derivatives by learned parameters, derivatives by the functions of
/// the point's cell, head after head.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) rows: usize,
    pub(super) learned: usize,
    /// Functions of the cell, of all heads.
    pub(super) width: usize,
}

impl Layout {
    /// Numbers of a point.
    pub(super) fn len(&self) -> usize {
        self.rows * (1 + self.learned + self.width)
    }

    /// Misfits, derivatives by learned parameters, and derivatives by functions.
    pub(super) fn split<'a>(&self, record: &'a [f64]) -> (&'a [f64], &'a [f64], &'a [f64]) {
        let (misfits, rest) = record.split_at(self.rows);
        let (by_learned, slopes) = rest.split_at(self.rows * self.learned);
        (misfits, by_learned, slopes)
    }

    /// The parts of a record, to be written.
    pub(super) fn split_mut<'a>(&self, record: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64], &'a mut [f64]) {
        let (misfits, rest) = record.split_at_mut(self.rows);
        let (by_learned, slopes) = rest.split_at_mut(self.rows * self.learned);
        (misfits, by_learned, slopes)
    }
}

impl Block {
    /// The rows of a point, where `dofs` are the functions of its cell.
    pub(super) fn of(layout: Layout, record: &[f64], dofs: Vec<u32>) -> Self {
        let (misfits, by_learned, slopes) = layout.split(record);
        Self { misfits: misfits.to_vec(), by_learned: by_learned.to_vec(), dofs, slopes: slopes.to_vec(), excess: 0.0 }
    }

    /// Rows of nothing yet.
    pub(super) fn new(layout: Layout, dofs: Vec<u32>) -> Self {
        let Layout { rows, learned, .. } = layout;
        let slopes = vec![0.0; rows * dofs.len()];
        Self { misfits: vec![0.0; rows], by_learned: vec![0.0; rows * learned], dofs, slopes, excess: 0.0 }
    }

    /// Adds rows of a cell; for every head, the boxes of functions of the cell and of this block, and their dimensions.
    pub(super) fn add(&mut self, layout: Layout, record: &[f64], boxes: impl Iterator<Item = ((Span, Span), usize)>) {
        let (misfits, by_learned, slopes) = layout.split(record);
        let width = self.dofs.len();
        let (mut from, mut first) = (0, 0);
        for ((cell, span), dimensions) in boxes {
            let shift: usize =
                (0..dimensions).map(|axis| (cell.first[axis] - span.first[axis]) * span.count.pow(axis as u32)).sum();
            for line in 0..cell.count.pow(dimensions as u32 - 1) {
                let (mut at, mut start, mut stride) = (line, first + shift, span.count);
                for _ in 1..dimensions {
                    start += at % cell.count * stride;
                    at /= cell.count;
                    stride *= span.count;
                }
                for row in 0..layout.rows {
                    let to = &mut self.slopes[row * width + start..][..cell.count];
                    let from = &slopes[row * layout.width + from + line * cell.count..][..cell.count];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
                }
            }
            from += cell.count.pow(dimensions as u32);
            first += span.count.pow(dimensions as u32);
        }
        self.misfits.iter_mut().zip(misfits).for_each(|(to, from)| *to += from);
        self.by_learned.iter_mut().zip(by_learned).for_each(|(to, from)| *to += from);
    }

    /// Divides each row.
    pub(super) fn divide(&mut self, by: impl Iterator<Item = f64>) {
        let (width, rows) = (self.dofs.len(), self.misfits.len());
        let learned = self.by_learned.len() / rows.max(1);
        for (row, by) in by.enumerate() {
            self.misfits[row] /= by;
            self.slopes[row * width..(row + 1) * width].iter_mut().for_each(|slope| *slope /= by);
            self.by_learned[row * learned..(row + 1) * learned].iter_mut().for_each(|slope| *slope /= by);
        }
    }

    /// A row after a step of the coefficients and of the learned scalars.
    pub(super) fn after(&self, row: usize, step: &[f64], shared: &[f64]) -> f64 {
        let slopes = &self.slopes[row * self.dofs.len()..];
        let along: f64 = self.kept().map(|(at, dof)| slopes[at] * step[dof as usize]).sum();
        // Behind the learned scalars are unknowns that no row of a block sees.
        let learned = self.by_learned.len() / self.misfits.len();
        let own = &self.by_learned[row * learned..][..learned];
        let beside: f64 = own.iter().zip(shared).map(|(a, x)| a * x).sum();
        self.misfits[row] + along + beside
    }

    /// Leaves nothing of a row.
    pub(super) fn clear(&mut self, row: usize) {
        let (width, learned) = (self.dofs.len(), self.by_learned.len() / self.misfits.len());
        self.misfits[row] = 0.0;
        self.slopes[row * width..][..width].fill(0.0);
        self.by_learned[row * learned..][..learned].fill(0.0);
    }

    /// Adds a row's derivatives, with the other sign if it is `negative`, to a vector of all coefficients and one of the learned
    /// scalars.
    pub(super) fn add_signed(&self, row: usize, negative: bool, by: &mut [f64], below: &mut [f64]) {
        let sign = if negative { -1.0 } else { 1.0 };
        let slopes = &self.slopes[row * self.dofs.len()..];
        self.kept().for_each(|(at, dof)| by[dof as usize] += sign * slopes[at]);
        let learned = self.by_learned.len() / self.misfits.len();
        let by_learned = &self.by_learned[row * learned..][..learned];
        below.iter_mut().zip(by_learned).for_each(|(sum, slope)| *sum += sign * slope);
    }

    /// Numbers of the coefficients that are kept.
    pub(super) fn kept(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        self.dofs.iter().enumerate().filter(|&(_, &dof)| dof != NONE).map(|(at, &dof)| (at, dof))
    }
}
