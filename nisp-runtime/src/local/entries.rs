//! Entries of a sparse symmetric matrix.

/// Entries of the lower triangle of a square matrix, column by column: on and below the diagonal, in order.
pub(super) struct Entries {
    /// Where every column begins, and the end of the last.
    pub(super) starts: Vec<usize>,
    /// Rows of all entries.
    pub(super) rows: Vec<usize>,
}

impl Entries {
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows of a column's entries.
    pub(super) fn column(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }
}
