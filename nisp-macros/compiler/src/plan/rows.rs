//! Terms to rows: what every kind of term wants to be zero.

use crate::model::{Expr, Term, TermKind};
use crate::rational::ratio;
use crate::symbolic::graph::{Id, ZERO};
use crate::symbolic::lower::Lowering;
use crate::symbolic::lower::Scalar;
use crate::unit::Dimension;

/// Keeps the Fischer-Burmeister root away from its kink; far below any misfit, representable in single precision.
const TINY: f64 = 1e-24;

/// The rows of a term.
pub(super) struct Rows {
    /// One expression per row.
    pub(super) rows: Vec<Id>,
    /// Targets of an integral, one per row.
    pub(super) targets: Vec<Id>,
}

/// Lowers a term; `place` is its group's index in the scene's plan and its own index in the group's.
pub(super) fn rows(lowering: &mut Lowering, term: &Term, place: (usize, usize)) -> Rows {
    let mut plain = |expressions: &[Expr]| expressions.iter().map(|e| lowering.lower(e, 0)).collect::<Vec<Id>>();
    let mut targets = Vec::new();
    let rows = match &term.kind {
        TermKind::Residual(rows) | TermKind::Observation { rows, .. } => plain(rows),
        TermKind::Chamfer { point, .. } => plain(point),
        TermKind::Integral { integrand, target, .. } => {
            targets = plain(target);
            plain(integrand)
        }
        // Violated where negative; at zero the derivative is that of the constant, zero.
        TermKind::Inequality(rows) => {
            let rows = plain(rows);
            rows.into_iter().map(|row| lowering.graph.min(row, ZERO)).collect()
        }
        TermKind::Complementarity { a, b, a_dimension, b_dimension } => {
            let a = side(lowering, a, a_dimension, place, 0);
            let b = side(lowering, b, b_dimension, place, 1);
            vec![fischer_burmeister(lowering, a, b)]
        }
    };
    Rows { rows, targets }
}

/// One side of a complementarity, divided by its natural size.
fn side(lowering: &mut Lowering, expression: &Expr, dimension: &Dimension, place: (usize, usize), side: usize) -> Id {
    let value = lowering.lower(expression, 0);
    let scale = lowering.scalar(Scalar::SideScale(dimension.clone(), place.0, place.1, side));
    lowering.graph.divide(value, scale)
}

/// `a + b - sqrt(a^2 + b^2)`, which is zero exactly where `a` and `b` are non-negative and one of them is zero.
fn fischer_burmeister(lowering: &mut Lowering, a: Id, b: Id) -> Id {
    let graph = &mut lowering.graph;
    let (a2, b2) = (graph.power(a, ratio(2, 1)), graph.power(b, ratio(2, 1)));
    let tiny = graph.real(TINY);
    let sum = graph.add(&[a2, b2, tiny]);
    let root = graph.power(sum, ratio(1, 2));
    graph.linear(&[(ratio(1, 1), a), (ratio(1, 1), b), (ratio(-1, 1), root)])
}
