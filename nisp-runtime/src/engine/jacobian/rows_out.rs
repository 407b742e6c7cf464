//! A matrix whose rows several threads write.

/// Lets tiles write their own rows of a shared matrix.
#[derive(Clone, Copy)]
pub(super) struct RowsOut {
    values: *mut f64,
    len: usize,
    columns: usize,
}

// SAFETY: every row belongs to one point of one group, and every point to one tile; no two threads share a row.
unsafe impl Send for RowsOut {}
// SAFETY: as above.
unsafe impl Sync for RowsOut {}

impl RowsOut {
    pub(super) fn new(values: &mut [f64], columns: usize) -> Self {
        Self { values: values.as_mut_ptr(), len: values.len(), columns }
    }

    /// # Safety
    /// No other thread may touch this row at the same time.
    #[expect(clippy::mut_from_ref, reason = "rows are disjoint, see the type")]
    pub(super) unsafe fn row(&self, row: usize) -> &mut [f64] {
        assert!((row + 1) * self.columns <= self.len, "row outside the matrix");
        // SAFETY: in bounds by the assertion; disjoint by the caller's promise.
        unsafe { std::slice::from_raw_parts_mut(self.values.add(row * self.columns), self.columns) }
    }
}
