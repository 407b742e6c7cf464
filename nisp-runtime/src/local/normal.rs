//! Normal equations of sparse rows, bordered by the few unknowns that all rows share.

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Mat, Side};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::block::Block;
use super::draws::Draws;

/// The normal matrix's lower triangle with its pattern, its gradient and its border.
pub(super) struct Normal {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
    values: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Rows that all coefficients share: learned scalars first, then integrals.
    border: Vec<Vec<f64>>,
    corner: DMatrix<f64>,
    border_gradient: Vec<f64>,
    learned: usize,
    /// Right-hand sides whose solutions spread as the posterior does, while they are wanted.
    pub(super) draws: Option<Draws>,
}

/// The factorised normal matrix.
pub(super) struct Factor {
    factor: Llt<usize, f64>,
    /// `H^-1` times the border.
    solved: Vec<Vec<f64>>,
    border: Vec<Vec<f64>>,
    schur: DMatrix<f64>,
    learned: usize,
}

impl Normal {
    /// For `len` coefficients and so many learned scalars; `groups` are the coefficients that occur together.
    pub(super) fn new(len: usize, learned: usize, groups: &[Vec<u32>]) -> Option<Self> {
        let mut columns: Vec<Vec<usize>> = (0..len).map(|at| vec![at]).collect();
        for group in groups {
            for (at, &column) in group.iter().enumerate() {
                columns[column as usize].extend(group[at..].iter().map(|&row| row as usize));
                let own = &mut columns[column as usize];
                // Repeats are many: drop them before they fill the memory.
                if own.len() > 4096 {
                    own.sort_unstable();
                    own.dedup();
                }
            }
        }
        let mut starts = vec![0];
        let mut rows = Vec::new();
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            rows.extend_from_slice(column);
            starts.push(rows.len());
        }
        let count = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(len, len, starts, None, rows);
        let symbolic = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).ok()?;
        Some(Self {
            pattern,
            symbolic,
            values: vec![0.0; count],
            gradient: vec![0.0; len],
            border: vec![vec![0.0; len]; learned],
            corner: DMatrix::zeros(learned, learned),
            border_gradient: vec![0.0; learned],
            learned,
            draws: None,
        })
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

    /// Adds the rows of blocks, in their order.
    pub(super) fn add_all(&mut self, blocks: &[Block]) {
        // So many at a time that their products stay in cache.
        for blocks in blocks.chunks(8) {
            let products: Vec<Products> = blocks.par_iter().map(Products::of).collect();
            blocks.iter().zip(&products).for_each(|(block, products)| self.add_products(block, products));
        }
    }

    /// Adds the rows of a block.
    pub(super) fn add(&mut self, block: &Block) {
        self.add_products(block, &Products::of(block));
    }

    fn add_products(&mut self, block: &Block, products: &Products) {
        let rows = block.misfits.len();
        if let Some(draws) = &mut self.draws {
            (0..rows).for_each(|row| draws.add_row(block, row));
        }
        let (starts, indices) = (self.pattern.col_ptr(), self.pattern.row_idx());
        let Products { dofs, slopes, lower } = products;
        let mut first = 0;
        for (at, &column) in dofs.iter().enumerate() {
            let column = column as usize;
            for row in 0..rows {
                let own = slopes[row * dofs.len() + at];
                self.gradient[column] += own * block.misfits[row];
                for learned in 0..self.learned {
                    self.border[learned][column] += own * block.by_learned[row * self.learned + learned];
                }
            }
            let line = &lower[first..first + dofs.len() - at];
            first += line.len();
            let mut place = starts[column];
            let end = starts[column + 1];
            for (sum, &row) in line.iter().zip(&dofs[at..]) {
                let row = row as usize;
                if place < end && indices[place] != row {
                    place = first_from(&indices[..end], place, row);
                }
                if place < end && indices[place] == row {
                    self.values[place] += sum;
                    place += 1;
                }
            }
        }
        for row in 0..rows {
            let by = &block.by_learned[row * self.learned..(row + 1) * self.learned];
            for (i, a) in by.iter().enumerate() {
                self.border_gradient[i] += a * block.misfits[row];
                for (j, b) in by.iter().enumerate() {
                    self.corner[(i, j)] += a * b;
                }
            }
        }
    }

    /// Adds `weight / 2` times the square of a coefficient to the quadratic form.
    pub(super) fn add_stiffness(&mut self, at: usize, weight: f64) {
        self.add_entry(at, at, weight);
        if let Some(draws) = &mut self.draws {
            draws.add(&[(at, weight.sqrt())]);
        }
    }

    /// Adds `weight / 2` times the square of the difference of two coefficients, which is `difference` at present.
    pub(super) fn add_difference(&mut self, [i, j]: [usize; 2], weight: f64, difference: f64) {
        self.gradient[i] -= weight * difference;
        self.gradient[j] += weight * difference;
        self.add_entry(i, i, weight);
        self.add_entry(j, j, weight);
        self.add_entry(i.max(j), i.min(j), -weight);
        if let Some(draws) = &mut self.draws {
            draws.add(&[(i, -weight.sqrt()), (j, weight.sqrt())]);
        }
    }

    /// Adds to an entry, `row >= column`.
    fn add_entry(&mut self, row: usize, column: usize, value: f64) {
        let (starts, indices) = (self.pattern.col_ptr(), self.pattern.row_idx());
        let range = starts[column]..starts[column + 1];
        if let Ok(at) = indices[range.clone()].binary_search(&row) {
            self.values[range.start + at] += value;
        }
    }

    /// Adds a row that depends on all coefficients: `(misfit + slopes . step) / sigma`, by way of one more unknown.
    pub(super) fn add_dense(&mut self, slopes: &[f64], misfit: f64, sigma: f64) {
        if let Some(draws) = &mut self.draws {
            draws.add(&slopes.iter().map(|slope| slope / sigma).enumerate().collect::<Vec<_>>());
        }
        self.border.push(slopes.to_vec());
        let count = self.border.len();
        self.corner = self.corner.clone().resize(count, count, 0.0);
        self.corner[(count - 1, count - 1)] = -sigma * sigma;
        self.border_gradient.push(misfit);
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
        let factor = self.llt()?;
        let solved: Vec<Vec<f64>> = self.border.iter().map(|column| solve(&factor, column)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let schur = DMatrix::from_fn(self.border.len(), self.border.len(), |i, j| {
            self.corner[(i, j)] - dot(&self.border[i], &solved[j])
        });
        Some(Factor { factor, solved, border: self.border.clone(), schur, learned: self.learned })
    }

    /// Of the matrix, or where rounding spoils its definiteness, with some more on the diagonal.
    fn llt(&self) -> Option<Llt<usize, f64>> {
        let try_with = |values: &[f64]| {
            let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
            Llt::try_new_with_symbolic(self.symbolic.clone(), matrix, Side::Lower).ok()
        };
        if !self.values.iter().all(|value| value.is_finite()) {
            return None;
        }
        try_with(&self.values).or_else(|| {
            (-12..=-4).step_by(2).find_map(|exponent| {
                let mut values = self.values.clone();
                // The diagonal is the first entry of every column of a lower triangle.
                for &diagonal in &self.pattern.col_ptr()[..self.gradient.len()] {
                    values[diagonal] *= 1.0 + 10f64.powi(exponent);
                }
                try_with(&values)
            })
        })
    }

    /// The step to the minimum of the quadratic model: of the coefficients, and of the learned scalars.
    pub(super) fn step(&self, factor: &Factor) -> Option<(Vec<f64>, Vec<f64>)> {
        let right: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        let below: Vec<f64> = self.border_gradient.iter().map(|g| -g).collect();
        factor.solve(&right, &below)
    }
}

/// A block's rows by the coefficients that are kept, in ascending order, and the lower triangle of their products.
struct Products {
    dofs: Vec<u32>,
    /// `[row][coefficient]`
    slopes: Vec<f64>,
    /// Column after column, from the diagonal down.
    lower: Vec<f64>,
}

impl Products {
    fn of(block: &Block) -> Self {
        let mut kept: Vec<(usize, u32)> = block.kept().collect();
        kept.sort_unstable_by_key(|&(_, dof)| dof);
        let (width, count) = (block.dofs.len(), kept.len());
        let rows = block.slopes.chunks_exact(width.max(1));
        let slopes: Vec<f64> = rows.flat_map(|row| kept.iter().map(|&(at, _)| row[at])).collect();
        let mut lower = vec![0.0; count * (count + 1) / 2];
        for row in slopes.chunks_exact(count.max(1)) {
            let mut first = 0;
            for (at, &own) in row.iter().enumerate() {
                let line = &mut lower[first..first + count - at];
                first += line.len();
                if own != 0.0 {
                    line.iter_mut().zip(&row[at..]).for_each(|(sum, slope)| *sum += own * slope);
                }
            }
        }
        Self { dofs: kept.into_iter().map(|(_, dof)| dof).collect(), slopes, lower }
    }
}

impl Factor {
    /// Solves the bordered system.
    pub(super) fn solve(&self, right: &[f64], below: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut step = solve(&self.factor, right);
        let shared = self.share(&mut step, below)?;
        Some((step, shared))
    }

    /// From a solution without the border to one with it; returns the learned scalars.
    fn share(&self, step: &mut [f64], below: &[f64]) -> Option<Vec<f64>> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let rest = DVector::from_iterator(
            self.border.len(),
            self.border.iter().zip(below).map(|(column, b)| b - dot(column, step)),
        );
        let shared = if rest.is_empty() { rest } else { self.schur.clone().lu().solve(&rest)? };
        for (solved, shared) in self.solved.iter().zip(shared.iter()) {
            step.iter_mut().zip(solved).for_each(|(step, solved)| *step -= solved * shared);
        }
        Some(shared.iter().take(self.learned).copied().collect())
    }

    /// Solutions for all right-hand sides: deviations of the coefficients, drawn from the posterior.
    pub(super) fn deviations(&self, draws: &Draws) -> Option<Vec<Vec<f64>>> {
        let solutions = self.factor.solve(draws.matrix());
        (0..solutions.ncols())
            .map(|draw| {
                let mut deviation: Vec<f64> = (0..solutions.nrows()).map(|i| solutions[(i, draw)]).collect();
                let mut below = draws.below(draw);
                below.resize(self.border.len(), 0.0);
                self.share(&mut deviation, &below)?;
                Some(deviation)
            })
            .collect()
    }

    /// `vector . H^-1 vector`, of the coefficients alone.
    pub(super) fn inner(&self, vector: &[f64]) -> f64 {
        solve(&self.factor, vector).iter().zip(vector).map(|(a, b)| a * b).sum()
    }

    /// Variance of a learned scalar's parameter.
    pub(super) fn learned_variance(&self, at: usize) -> Option<f64> {
        self.schur.clone().try_inverse().map(|inverse| inverse[(at, at)])
    }
}

/// The first place at or after `from` whose index is not below `row`; usually near.
fn first_from(indices: &[usize], from: usize, row: usize) -> usize {
    let (mut low, mut step) = (from, 1);
    while low + step < indices.len() && indices[low + step] < row {
        low += step;
        step *= 2;
    }
    let high = (low + step).min(indices.len());
    low + indices[low..high].partition_point(|&index| index < row)
}

fn solve(factor: &Llt<usize, f64>, right: &[f64]) -> Vec<f64> {
    let right = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    let solution = factor.solve(&right);
    (0..solution.nrows()).map(|i| solution[(i, 0)]).collect()
}
