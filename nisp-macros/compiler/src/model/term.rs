//! What must hold at the points of a group.

use super::{Expr, Name};
use crate::loss::Robust;
use crate::unit::{Dimension, Unit};

/// One condition of a group.
#[derive(Clone, Debug)]
pub struct Term {
    /// Its name.
    pub name: Name,
    /// What it asks.
    pub kind: TermKind,
    /// How a row's misfit counts.
    pub loss: Option<Robust>,
    /// The user's weight (1 if none is written).
    pub weight: f64,
    /// How far rows may be off, in SI units: the noise of data, the tolerance of a condition, the spread of a prior.
    pub within: Option<f64>,
    /// The unit shared by all rows; dimension and text of both sides.
    pub unit: Unit,
    /// The condition as plain text.
    pub equation: String,
    /// The condition as LaTeX.
    pub latex: String,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// What a term asks of the expressions in it; each entry of a vector is one scalar row per point.
#[derive(Clone, Debug)]
// There are a handful of terms; plain variants read better than boxes.
#[allow(clippy::large_enum_variant)]
pub enum TermKind {
    /// `a == b`, as `a - b`.
    Residual(Vec<Expr>),
    /// `observe a ~ column`: like a residual, but the misfit is measurement noise.
    Observation {
        /// `a - column`
        rows: Vec<Expr>,
        /// The column of each row, by index in the group.
        columns: Vec<usize>,
    },
    /// `a >= b`, as `a - b`, wanted non-negative.
    Inequality(Vec<Expr>),
    /// `0 <= a _|_ b >= 0`: both non-negative and one of them zero; each with its own dimension.
    Complementarity {
        /// One side.
        a: Expr,
        /// The other side.
        b: Expr,
        /// Dimension of `a`.
        a_dimension: Dimension,
        /// Dimension of `b`.
        b_dimension: Dimension,
    },
    /// `integral(e) == target`: a sum over the group with the points' quadrature weights.
    Integral {
        /// Integrand, one entry per row.
        integrand: Vec<Expr>,
        /// Target value; contains parameters and numbers only.
        target: Vec<Expr>,
        /// Unit of the points' weights: a length, an area, a volume or an extent of coordinates, as declared; absent
        /// where units are off or nothing tells.
        measure: Option<Unit>,
    },
    /// The surface `point` passes through a measured cloud.
    Chamfer {
        /// Deformed position, one entry per dimension of the cloud.
        point: Vec<Expr>,
        /// The entries as people write them, where they are written one by one.
        names: Vec<String>,
        /// Both directions, not only cloud to surface.
        symmetric: bool,
        /// Only the distance across the surface, not that along it.
        plane: bool,
    },
}
