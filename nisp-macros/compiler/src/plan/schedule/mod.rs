//! From expressions to straight-line programs with few operations.
//!
//! Products become lists of factors, powers repeated factors; what several lists have in common is computed once;
//! whatever depends on scalars only is kept together, so that code generation can hoist it out of the loop over
//! points; products in sums become fused multiply-adds.

mod emit;
mod flat;
mod share;

use crate::program::{Program, Slot};
use crate::symbolic::graph::{Graph, Id, Leaf, ZERO};

/// The program that computes `outputs`; the constant zero becomes a structural zero. `slot` places the inputs.
pub(super) fn schedule(graph: &Graph, outputs: &[Id], slot: &dyn Fn(&Leaf) -> (Slot, usize)) -> Program {
    let mut flat = flat::Flat::default();
    let roots: Vec<Option<usize>> =
        flat.import(graph, outputs, slot).into_iter().zip(outputs).map(|(f, &id)| (id != ZERO).then_some(f)).collect();
    share::share(&mut flat, &roots);
    emit::emit(&flat, &roots)
}

/// The program of a rule, whose inputs are already in their slots.
pub(super) fn schedule_rule(graph: &Graph, outputs: &[Id]) -> Program {
    schedule(graph, outputs, &|leaf| match leaf {
        Leaf::Input(slot, index) => (*slot, *index),
        Leaf::Jet { field, .. } => (Slot::Jet, *field),
    })
}
