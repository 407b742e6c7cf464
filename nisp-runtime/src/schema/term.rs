//! The conditions of a group.

use super::{Loss, Unit};
use crate::units::{Number, Si};

/// One condition of a group.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// Its name.
    pub name: &'static str,
    /// The condition as plain text.
    pub equation: &'static str,
    /// The condition as LaTeX.
    pub latex: &'static str,
    /// Unit of its rows.
    pub unit: Unit,
    /// How its rows are meant.
    pub kind: TermKind,
    /// How a row's misfit counts.
    pub loss: Loss,
    /// The user's weight.
    pub weight: f64,
    /// How far rows may be off, if the user says so: the noise of data, the tolerance of a condition, the spread of a prior.
    pub within: Option<Number<Si>>,
    /// The unit of the points' weights, if the term is an integral.
    pub measure: Option<Unit>,
    /// First row.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// What its rows read of the heads, by index in [`Group::jets`](super::Group::jets).
    pub jets: &'static [usize],
    /// The column that each row compares with, by index in [`Group::columns`](super::Group::columns), if the term is an observation.
    pub columns: &'static [usize],
    /// True where its rows read columns: they have a value at the points of the group alone.
    pub known: bool,
    /// True for `a >= b` and for `0 <= a _|_ b >= 0`, which turn from one side to the other where they may.
    pub bound: bool,
}

/// How a term's rows are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TermKind {
    /// Wanted zero at every point.
    Residual,
    /// Wanted zero up to measurement noise.
    Observation,
    /// The weighted sum over the group is wanted to equal a target.
    Integral,
    /// Rows are coordinates of a surface that passes through a cloud.
    Chamfer {
        /// Both directions, not only cloud to surface.
        symmetric: bool,
        /// Only the distance across the surface, not that along it.
        plane: bool,
        /// What the coordinates of its points are called, as people write the rows; none where they do not write them one by one.
        components: &'static [&'static str],
    },
}
