//! How thin the layers are that a network over time is to resolve.
//!
//! A source that sets in with the record does so in a layer, which inputs stretched at its start resolve. A source whose value
//! there is a condition does not: it could leave that value at once, and nothing would be known by it. Then noise is what thin
//! layers are filled with: the circuit's source was up to three times as wrong.

use super::weigh::FEW_ROWS;
use crate::network::{Architecture, Inputs, Stretched};
use crate::problem::Bound;
use crate::schema::{Group, Term, TermKind};

/// Range over the width of the thinnest layer, where the source is known at the start.
const RATIO: f64 = 10.0;

/// The architecture with inputs that suit a problem, where the choice is left to us.
pub(super) fn suited(bound: &Bound, architecture: Architecture) -> Architecture {
    let inputs = match architecture.inputs {
        Inputs::Automatic if is_known_at_start(bound) => Inputs::Stretched(Stretched { ratio: RATIO }),
        chosen => chosen,
    };
    Architecture { inputs, ..architecture }
}

/// True if a condition of a few points states the value of a source where the only coordinate begins.
fn is_known_at_start(bound: &Bound) -> bool {
    let schema = bound.problem.scene().schema;
    let least = |points: &[f64]| points.iter().copied().fold(f64::INFINITY, f64::min);
    let start = bound.coordinates.iter().map(|points| least(points)).fold(f64::INFINITY, f64::min);
    let is_value = |group: &Group, term: &Term| {
        let mut jets = term.jets.iter().map(|&jet| &group.jets[jet]);
        let of_source = |head: usize| schema.heads[head].source;
        term.kind == TermKind::Residual
            && !term.jets.is_empty()
            && jets.all(|jet| of_source(jet.head) && jet.is_value())
    };
    let mut groups = schema.groups.iter().zip(&bound.coordinates);
    schema.coordinates.len() == 1
        && groups.any(|(group, points)| {
            points.len() <= FEW_ROWS && least(points) <= start && group.terms.iter().any(|term| is_value(group, term))
        })
}
