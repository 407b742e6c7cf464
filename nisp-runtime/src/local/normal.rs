//! Normal equations of sparse rows, bordered by the few unknowns that all rows share.

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Mat, Side};
use nalgebra::{DMatrix, DVector};

use super::block::Block;

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

    /// Adds the rows of a block.
    pub(super) fn add(&mut self, block: &Block) {
        let mut kept: Vec<(usize, u32)> = block.kept().collect();
        kept.sort_unstable_by_key(|&(_, dof)| dof);
        let width = block.dofs.len();
        let rows = block.misfits.len();
        let (starts, indices) = (self.pattern.col_ptr(), self.pattern.row_idx());
        let mut line = vec![0.0; kept.len()];
        for (at, &(position, column)) in kept.iter().enumerate() {
            let column = column as usize;
            line[at..].fill(0.0);
            for row in 0..rows {
                let slopes = &block.slopes[row * width..(row + 1) * width];
                let own = slopes[position];
                self.gradient[column] += own * block.misfits[row];
                for learned in 0..self.learned {
                    self.border[learned][column] += own * block.by_learned[row * self.learned + learned];
                }
                if own != 0.0 {
                    for (sum, &(other, _)) in line[at..].iter_mut().zip(&kept[at..]) {
                        *sum += own * slopes[other];
                    }
                }
            }
            let mut place = starts[column];
            let end = starts[column + 1];
            for (sum, &(_, row)) in line[at..].iter().zip(&kept[at..]) {
                let row = row as usize;
                if place < end && indices[place] != row {
                    place += indices[place..end].partition_point(|&index| index < row);
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

    /// Adds to an entry, `row >= column`.
    pub(super) fn add_entry(&mut self, row: u32, column: u32, value: f64) {
        let (row, column) = (row.max(column) as usize, row.min(column) as usize);
        let (starts, indices) = (self.pattern.col_ptr(), self.pattern.row_idx());
        let range = starts[column]..starts[column + 1];
        if let Ok(at) = indices[range.clone()].binary_search(&row) {
            self.values[range.start + at] += value;
        }
    }

    /// Adds a row that depends on all coefficients: `(misfit + slopes . step) / sigma`, by way of one more unknown.
    pub(super) fn add_dense(&mut self, slopes: &[f64], misfit: f64, sigma: f64) {
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

impl Factor {
    /// Solves the bordered system.
    pub(super) fn solve(&self, right: &[f64], below: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut step = solve(&self.factor, right);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let rest = DVector::from_iterator(
            self.border.len(),
            self.border.iter().zip(below).map(|(column, b)| b - dot(column, &step)),
        );
        let shared = if rest.is_empty() { rest } else { self.schur.clone().lu().solve(&rest)? };
        for (solved, shared) in self.solved.iter().zip(shared.iter()) {
            step.iter_mut().zip(solved).for_each(|(step, solved)| *step -= solved * shared);
        }
        Some((step, shared.iter().take(self.learned).copied().collect()))
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

fn solve(factor: &Llt<usize, f64>, right: &[f64]) -> Vec<f64> {
    let right = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    let solution = factor.solve(&right);
    (0..solution.nrows()).map(|i| solution[(i, 0)]).collect()
}
