//! Where the lower triangle of a sparse symmetric matrix has entries.

/// Entries of a lower triangle, column by column.
pub(super) struct Entries {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl Entries {
    /// Columns with entries in these rows, each on and below the diagonal and in order.
    pub(super) fn new(columns: &[Vec<usize>]) -> Self {
        let mut starts = vec![0];
        starts.extend(columns.iter().scan(0, |end, column| {
            *end += column.len();
            Some(*end)
        }));
        Self { starts, rows: columns.concat() }
    }

    /// How many columns there are.
    pub(super) fn columns(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where every column begins, and the end of the last.
    pub(super) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Rows of all entries, column by column.
    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Rows of the entries of a column.
    pub(super) fn rows_of(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }
}
