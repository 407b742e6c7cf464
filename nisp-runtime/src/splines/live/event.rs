//! What is asked for at a place.

use crate::schema::Term;

/// Something that is asked for at a place: what was measured there, a condition, or an equation.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub(super) group: usize,
    /// In the engine's units.
    pub(super) at: f64,
    /// Columns of the group there, NaN where nothing was measured.
    pub(super) columns: Vec<f64>,
    /// Whether its row is a stray: what was observed there does not count.
    pub(super) is_stray: bool,
}

impl Event {
    /// A condition or an equation, which nothing is measured for.
    pub(super) fn plain(group: usize, at: f64) -> Self {
        Self { group, at, columns: Vec::new(), is_stray: false }
    }

    /// Whether all that a term compares with was measured.
    pub(super) fn measures(&self, term: &Term) -> bool {
        term.columns.iter().all(|&column| !self.columns[column].is_nan())
    }
}
