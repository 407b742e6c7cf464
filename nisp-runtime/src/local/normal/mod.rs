//! Normal equations of sparse rows, bordered by the few unknowns that all rows share.

pub(super) mod factor;
mod products;
mod steps;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::block::Block;
use super::draws::Draws;
use super::entries::Entries;
use super::integrals::Integral;
use super::pattern::{Part, Pattern};
use super::sorted::Sorted;

/// The normal matrix's lower triangle with its pattern, its gradient and its border.
pub(super) struct Normal {
    pattern: Pattern,
    /// The unknowns that are free, where not all are.
    part: Option<Arc<Part>>,
    values: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Rows that all coefficients share: learned scalars first, then integrals.
    border: Vec<Vec<f64>>,
    corner: DMatrix<f64>,
    pub(super) border_gradient: Vec<f64>,
    learned: usize,
    /// Right-hand sides whose solutions spread as the posterior does, while they are wanted.
    pub(super) draws: Option<Draws>,
}

/// What rows were summed up to.
pub(super) struct Sums {
    values: Vec<f64>,
    gradient: Vec<f64>,
    border: Vec<Vec<f64>>,
    corner: DMatrix<f64>,
    border_gradient: Vec<f64>,
}

impl Normal {
    /// For `len` coefficients and so many learned scalars; `groups` are the coefficients that occur together.
    pub(super) fn new(len: usize, learned: usize, groups: &[Vec<u32>]) -> Option<Self> {
        let mut of: Vec<Vec<u32>> = vec![Vec::new(); len];
        for (number, group) in groups.iter().enumerate() {
            group.iter().for_each(|&column| of[column as usize].push(number as u32));
        }
        // By row, the last column that it was seen in.
        let mut last = vec![usize::MAX; len];
        let (mut rows, mut entries) = (Vec::new(), Entries::default());
        for (column, of) in of.iter().enumerate() {
            rows.push(column);
            last[column] = column;
            for group in of.iter().map(|&number| &groups[number as usize]) {
                for row in group.iter().map(|&row| row as usize).filter(|&row| row > column) {
                    if last[row] != column {
                        last[row] = column;
                        rows.push(row);
                    }
                }
            }
            rows.sort_unstable();
            entries.push(rows.drain(..));
        }
        let pattern = Pattern::new(entries)?;
        Some(Self {
            values: vec![0.0; pattern.rows().len()],
            pattern,
            part: None,
            gradient: vec![0.0; len],
            border: vec![vec![0.0; len]; learned],
            corner: DMatrix::zeros(learned, learned),
            border_gradient: vec![0.0; learned],
            learned,
            draws: None,
        })
    }

    /// Solves for the marked unknowns alone from now on, or for all of them. Returns nothing where memory is too small.
    pub(super) fn set_free(&mut self, free: Option<&[bool]>) -> Option<()> {
        let Some(free) = free.filter(|free| free.contains(&false)) else {
            self.part = None;
            return Some(());
        };
        if self.part.as_ref().is_none_or(|part| part.free != free) {
            self.part = Some(Arc::new(self.pattern.part(free)?));
        }
        Some(())
    }

    /// What the rows so far were summed up to.
    pub(super) fn sums(&self) -> Sums {
        Sums {
            values: self.values.clone(),
            gradient: self.gradient.clone(),
            border: self.border.clone(),
            corner: self.corner.clone(),
            border_gradient: self.border_gradient.clone(),
        }
    }

    /// Forgets the rows that came after these.
    pub(super) fn go_back(&mut self, sums: &Sums) {
        self.values.clone_from(&sums.values);
        self.gradient.clone_from(&sums.gradient);
        self.border.clone_from(&sums.border);
        self.corner.clone_from(&sums.corner);
        self.border_gradient.clone_from(&sums.border_gradient);
    }

    /// Forgets all rows.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
        self.gradient.fill(0.0);
        self.border.truncate(self.learned);
        self.border.iter_mut().for_each(|column| column.fill(0.0));
        self.corner = DMatrix::zeros(self.learned, self.learned);
        self.border_gradient.truncate(self.learned);
        self.border_gradient.fill(0.0);
    }

    /// Adds the rows of blocks.
    pub(super) fn add_all(&mut self, blocks: &[Block]) {
        let alike: Vec<&[Block]> = blocks.chunk_by(|one, other| one.dofs == other.dofs).collect();
        let sorted: Vec<Sorted> = alike.into_par_iter().map(Sorted::of).collect();
        for block in blocks {
            self.add_corner(block);
            if let Some(draws) = &mut self.draws {
                (0..block.misfits.len()).for_each(|row| draws.add_row(block, row));
            }
        }
        self.add_products(&Sorted::together(sorted));
    }

    /// Adds `weight / 2` times the square of a coefficient to the quadratic form.
    pub(super) fn add_stiffness(&mut self, at: usize, weight: f64) {
        self.add_diagonal(at, weight);
        if let Some(draws) = &mut self.draws {
            draws.add(&[(at, weight.sqrt())]);
        }
    }

    /// Adds `weight / 2` times the square of the difference of two coefficients, which is `difference` at present.
    pub(super) fn add_difference(&mut self, [i, j]: [usize; 2], weight: f64, difference: f64) {
        self.gradient[i] -= weight * difference;
        self.gradient[j] += weight * difference;
        self.add_diagonal(i, weight);
        self.add_diagonal(j, weight);
        self.add_entry(i.max(j), i.min(j), -weight);
        if let Some(draws) = &mut self.draws {
            draws.add(&[(i, -weight.sqrt()), (j, weight.sqrt())]);
        }
    }

    /// How stiff the rows hold a coefficient of a range: the median of those that they see, zero if they see none.
    pub(super) fn typical(&self, range: Range<usize>) -> f64 {
        // A column of the lower triangle begins with its diagonal.
        let starts = self.pattern.starts();
        let mut seen: Vec<f64> = range.map(|at| self.values[starts[at]]).filter(|&value| value > 0.0).collect();
        seen.sort_by(f64::total_cmp);
        seen.get(seen.len() / 2).copied().unwrap_or(0.0)
    }

    /// Adds a share of its own to the stiffness of every coefficient.
    pub(super) fn lift(&mut self, share: f64) {
        for at in 0..self.gradient.len() {
            self.add_stiffness(at, share * self.values[self.pattern.starts()[at]]);
        }
    }

    /// Adds to an entry of the diagonal, the first of its column in a lower triangle.
    fn add_diagonal(&mut self, at: usize, value: f64) {
        self.values[self.pattern.starts()[at]] += value;
    }

    /// Adds to an entry, `row >= column`.
    fn add_entry(&mut self, row: usize, column: usize, value: f64) {
        let (starts, indices) = (self.pattern.starts(), self.pattern.rows());
        let range = starts[column]..starts[column + 1];
        if let Ok(at) = indices[range.clone()].binary_search(&row) {
            self.values[range.start + at] += value;
        }
    }

    /// Adds a row that depends on all coefficients: `(misfit + slopes . step) / sigma`, by way of one more unknown.
    pub(super) fn add_dense(&mut self, row: &Integral) {
        let Integral { misfit, slopes, by_learned, sigma } = row;
        if let Some(draws) = &mut self.draws {
            draws.add_dense(row);
        }
        self.border.push(slopes.clone());
        let last = self.border.len() - 1;
        self.corner = self.corner.clone().resize(last + 1, last + 1, 0.0);
        for (at, by) in by_learned.iter().enumerate() {
            (self.corner[(last, at)], self.corner[(at, last)]) = (*by, *by);
        }
        self.corner[(last, last)] = -sigma * sigma;
        self.border_gradient.push(*misfit);
    }

    /// Adds to the precision of a learned scalar.
    pub(super) fn add_learned(&mut self, at: usize, precision: f64, gradient: f64) {
        self.corner[(at, at)] += precision;
        self.border_gradient[at] += gradient;
        if let Some(draws) = &mut self.draws {
            draws.add_learned(at, precision.sqrt());
        }
    }
}
