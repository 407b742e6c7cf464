//! Rows of a group at its points, as its programs give them.

use super::testing::Test;

/// Values of all rows at all points, and their derivatives.
pub(super) struct Evaluated {
    pub(super) stride: usize,
    /// `[row][point]`
    pub(super) rows: Vec<f64>,
    /// By row: `[jet or learned scalar][point]`.
    pub(super) bars: Vec<Vec<f64>>,
}

impl Evaluated {
    /// Mean of a row over a test's points.
    pub(super) fn mean(&self, test: &Test, row: usize) -> f64 {
        test.points.iter().map(|&(p, share)| share * self.row(row, p as usize)).sum()
    }

    /// Value of a row at a point.
    pub(super) fn row(&self, row: usize, p: usize) -> f64 {
        self.rows[row * self.stride + p]
    }

    /// Derivative of a row at a point by a jet or learned scalar.
    pub(super) fn bar(&self, row: usize, bar: usize, p: usize) -> f64 {
        self.bars[row][bar * self.stride + p]
    }
}
