//! A few rows that depend on the same few coefficients.

use super::lattice::{Lattice, NONE, Place, Span};

/// Rows, and their derivatives by the coefficients of some boxes of functions and by the learned scalars.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) misfits: Vec<f64>,
    /// Numbers of the coefficients; [`NONE`] for functions that are not kept.
    pub(super) dofs: Vec<u32>,
    /// `[row][coefficient]`
    pub(super) slopes: Vec<f64>,
    /// Derivatives of the learned scalars by their parameters.
    learned: Vec<f64>,
    /// `[row][learned parameter]`
    pub(super) by_learned: Vec<f64>,
    /// Head, box, and where its coefficients begin.
    heads: Vec<(usize, Span, usize)>,
}

impl Block {
    pub(super) fn new(rows: usize, learned: &[f64]) -> Self {
        Self {
            misfits: vec![0.0; rows],
            dofs: Vec::new(),
            slopes: Vec::new(),
            learned: learned.to_vec(),
            by_learned: vec![0.0; rows * learned.len()],
            heads: Vec::new(),
        }
    }

    /// Makes room for the functions of a box.
    pub(super) fn add_head(&mut self, head: usize, span: Span, dofs: impl Iterator<Item = u32>) {
        self.heads.push((head, span, self.dofs.len()));
        self.dofs.extend(dofs);
        self.slopes.resize(self.dofs.len() * self.misfits.len(), 0.0);
    }

    /// Adds values of the functions of a place's cell, times a factor of each row.
    pub(super) fn add_cell(
        &mut self,
        head: usize,
        lattice: &Lattice,
        place: &Place,
        values: &[f64],
        factor: impl Fn(usize) -> f64,
    ) {
        let Some(&(_, span, first)) = self.heads.iter().find(|(h, _, _)| *h == head) else { return };
        let (width, count) = (self.dofs.len(), lattice.degree + 1);
        let shift: usize = (0..lattice.dimensions())
            .map(|axis| (place.cell[axis] - span.first[axis]) * span.count.pow(axis as u32))
            .sum();
        for row in 0..self.misfits.len() {
            let factor = factor(row);
            if factor == 0.0 {
                continue;
            }
            let slopes = &mut self.slopes[row * width + first..];
            for (line, values) in values.chunks_exact(count).enumerate() {
                let (mut line, mut start, mut stride) = (line, shift, span.count);
                for _ in 1..lattice.dimensions() {
                    start += line % count * stride;
                    line /= count;
                    stride *= span.count;
                }
                for (slope, value) in slopes[start..start + count].iter_mut().zip(values) {
                    *slope += factor * value;
                }
            }
        }
    }

    /// Adds a share of a block of one of the cells that this one is spread over.
    pub(super) fn add_share(&mut self, of: &Block, share: f64, dimensions: usize) {
        let (width, own) = (self.dofs.len(), of.dofs.len());
        for (&(_, cell, from), &(_, span, first)) in of.heads.iter().zip(&self.heads) {
            let shift: usize =
                (0..dimensions).map(|axis| (cell.first[axis] - span.first[axis]) * span.count.pow(axis as u32)).sum();
            for line in 0..cell.count.pow(dimensions as u32 - 1) {
                let (mut at, mut start, mut stride) = (line, first + shift, span.count);
                for _ in 1..dimensions {
                    start += at % cell.count * stride;
                    at /= cell.count;
                    stride *= span.count;
                }
                for row in 0..self.misfits.len() {
                    let to = &mut self.slopes[row * width + start..][..cell.count];
                    let from = &of.slopes[row * own + from + line * cell.count..][..cell.count];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += share * from);
                }
            }
        }
        self.misfits.iter_mut().zip(&of.misfits).for_each(|(to, from)| *to += share * from);
        self.by_learned.iter_mut().zip(&of.by_learned).for_each(|(to, from)| *to += share * from);
    }

    /// Adds the derivatives of the rows by the learned scalars.
    pub(super) fn add_learned(&mut self, slope: impl Fn(usize, usize) -> f64) {
        let count = self.learned.len();
        for (at, sum) in self.by_learned.iter_mut().enumerate() {
            *sum += slope(at / count, at % count) * self.learned[at % count];
        }
    }

    /// Divides each row.
    pub(super) fn divide(&mut self, by: impl Iterator<Item = f64>) {
        let (width, learned) = (self.dofs.len(), self.learned.len());
        for (row, by) in by.enumerate() {
            self.misfits[row] /= by;
            self.slopes[row * width..(row + 1) * width].iter_mut().for_each(|slope| *slope /= by);
            self.by_learned[row * learned..(row + 1) * learned].iter_mut().for_each(|slope| *slope /= by);
        }
    }

    /// Numbers of the coefficients that are kept.
    pub(super) fn kept(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        self.dofs.iter().enumerate().filter(|&(_, &dof)| dof != NONE).map(|(at, &dof)| (at, dof))
    }
}
