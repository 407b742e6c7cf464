//! Normal equations of sparse rows, bordered by the few unknowns that all rows share.

pub(super) mod factor;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::block::Block;
use super::draws::Draws;
use super::group::Integral;
use super::pattern::{Part, Pattern};
use super::sorted::Sorted;
use crate::simd::Isa;
use crate::solve::vector;
use factor::Factor;

/// Pieces that the matrix is summed up in, at the same time: a fixed number, many enough for all threads.
const PIECES: usize = 32;

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
        let mut column = |(column, of): (usize, &Vec<u32>)| {
            let mut rows = vec![column];
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
            rows
        };
        let columns: Vec<Vec<usize>> = of.iter().enumerate().map(&mut column).collect();
        let pattern = Pattern::new(&columns)?;
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
        let sorted: Vec<Sorted> = blocks.par_iter().map(Sorted::of).collect();
        for block in blocks {
            self.add_corner(block);
            if let Some(draws) = &mut self.draws {
                (0..block.misfits.len()).for_each(|row| draws.add_row(block, row));
            }
        }
        self.add_products(&Sorted::together(sorted));
    }

    /// Adds the products of the rows' slopes with each other, and with what is on the right and in the border, piece by piece of the
    /// matrix: every entry is summed up in the order of the blocks.
    fn add_products(&mut self, blocks: &[Sorted]) {
        let (starts, indices) = (self.pattern.starts(), self.pattern.rows());
        let columns = self.gradient.len();
        let mut pieces = Vec::new();
        let (mut rest, mut first) = (self.values.as_mut_slice(), 0);
        let mut beside: Vec<&mut [f64]> = vec![&mut self.gradient];
        beside.extend(self.border.iter_mut().take(self.learned).map(Vec::as_mut_slice));
        for piece in 1..=PIECES {
            let end = starts.partition_point(|&start| start < indices.len() * piece / PIECES).min(columns);
            let (own, others) = rest.split_at_mut(starts[end] - starts[first]);
            let sums: Vec<&mut [f64]> =
                beside.iter_mut().map(|rest| rest.split_off_mut(..end - first).unwrap_or_default()).collect();
            pieces.push((first..end, own, sums));
            (rest, first) = (others, end);
        }
        let isa = Isa::detect();
        pieces.into_par_iter().for_each(|(columns, values, mut sums)| {
            let origin = starts[columns.start];
            let mut line = Vec::new();
            for block in blocks {
                let from = block.dofs.partition_point(|&dof| (dof as usize) < columns.start);
                for at in from..block.dofs.len() {
                    let column = block.dofs[at] as usize;
                    if column >= columns.end {
                        break;
                    }
                    block.beside(at, sums.iter_mut().map(|sum| &mut sum[column - columns.start]));
                    block.products(isa, at, &mut line);
                    let range = starts[column]..starts[column + 1];
                    let values = &mut values[range.start - origin..range.end - origin];
                    block.scatter(at, &line, &indices[range], values);
                }
            }
        });
    }

    /// Adds what rows say of the learned scalars alone.
    fn add_corner(&mut self, block: &Block) {
        for (row, misfit) in block.misfits.iter().enumerate() {
            let by = &block.by_learned[row * self.learned..(row + 1) * self.learned];
            for (i, a) in by.iter().enumerate() {
                self.border_gradient[i] += a * misfit;
                for (j, b) in by.iter().enumerate() {
                    self.corner[(i, j)] += a * b;
                }
            }
        }
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

    /// Factorises; nothing if the matrix is not positive definite.
    pub(super) fn factor(&self) -> Option<Factor> {
        let part = self.part.clone();
        let factor = match &part {
            Some(part) => part.factor(&self.values),
            None => self.pattern.factor(&self.values),
        }?;
        let mut found = Factor {
            factor,
            part,
            solved: Vec::new(),
            border: self.border.clone(),
            schur: self.corner.clone(),
            learned: self.learned,
        };
        found.solved = found.solve_free(&self.border)?;
        for i in 0..self.border.len() {
            for j in 0..self.border.len() {
                found.schur[(i, j)] -= vector::dot(&self.border[i], &found.solved[j]);
            }
        }
        Some(found)
    }

    /// The step to the minimum of the quadratic model: of the coefficients, and of the learned scalars.
    pub(super) fn step(&self, factor: &Factor) -> Option<(Vec<f64>, Vec<f64>)> {
        self.step_with(factor, &vec![0.0; self.gradient.len()])
    }

    /// The same where unknowns that are not free take the steps `held`, which is zero for those that are free.
    pub(super) fn step_with(&self, factor: &Factor, held: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let slopes = self.slopes_after(held, &[]);
        let right: Vec<f64> = slopes.iter().map(|g| -g).collect();
        let along = self.border.iter().map(|column| vector::dot(column, held));
        let below: Vec<f64> = self.border_gradient.iter().zip(along).map(|(g, along)| -g - along).collect();
        let (mut step, shared) = factor.solve(&right, &below)?;
        step.iter_mut().zip(held).for_each(|(step, held)| *step += held);
        Some((step, shared))
    }

    /// The model's gradient after a step of the coefficients and of the border's unknowns.
    pub(super) fn slopes_after(&self, step: &[f64], shared: &[f64]) -> Vec<f64> {
        let mut slopes = self.gradient.clone();
        if step.iter().any(|step| *step != 0.0) {
            let product = self.pattern.times(&self.values, step);
            slopes.iter_mut().zip(product).for_each(|(slope, product)| *slope += product);
        }
        for (column, shared) in self.border.iter().zip(shared) {
            slopes.iter_mut().zip(column).for_each(|(slope, entry)| *slope += entry * shared);
        }
        slopes
    }
}
