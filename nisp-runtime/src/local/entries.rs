//! Entries of a sparse symmetric matrix.

/// Entries of the lower triangle of a square matrix, column by column: on and below the diagonal, in order.
pub(super) struct Entries {
    /// Where every column begins, and the end of the last.
    pub(super) starts: Vec<usize>,
    /// Rows of all entries.
    pub(super) rows: Vec<usize>,
}

impl Default for Entries {
    /// Of a matrix without columns.
    fn default() -> Self {
        Self { starts: vec![0], rows: Vec::new() }
    }
}

impl Entries {
    /// Of columns with entries in these rows, each on and below the diagonal and in order.
    #[cfg(test)]
    pub(super) fn of(columns: impl IntoIterator<Item = Vec<usize>>) -> Self {
        let mut entries = Self::default();
        columns.into_iter().for_each(|column| entries.push(column.into_iter()));
        entries
    }

    /// Adds a column with entries in these rows, which are on and below the diagonal and in order.
    pub(super) fn push(&mut self, rows: impl Iterator<Item = usize>) {
        self.rows.extend(rows);
        self.starts.push(self.rows.len());
    }

    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows of a column's entries.
    pub(super) fn column(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }
}
