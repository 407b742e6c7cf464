//! Affine arguments: `P(d/dx) phi(w.x + b) = sum over n of phi[n] P_n(w)`, with `P_n` the part of degree n.

use super::{ChannelSet, Rule};
use crate::program::Slot;
use crate::symbolic::exact::Exact;
use crate::symbolic::graph::{Graph, Id};
use crate::symbolic::horner;

/// The activation of an affine unit.
pub fn affine(set: &ChannelSet) -> Exact<Rule> {
    let mut graph = Graph::default();
    let weights: Vec<Id> = (0..set.coordinates).map(|i| graph.input(Slot::Weight, i)).collect();
    let phis = set.order() as usize + 1;
    let mut results = Vec::new();
    for operator in &set.basis {
        let mut terms = Vec::new();
        for n in 0..=operator.degree() {
            let power = horner::polynomial(&mut graph, &operator.homogeneous_part(n), &weights);
            let phi = graph.input(Slot::Phi, n as usize);
            terms.push(graph.multiply(&[phi, power]));
        }
        results.push(graph.add(&terms));
    }
    let weights = (0..set.coordinates).map(|i| Some((Slot::Weight, i)));
    Ok(Rule { graph, results, phis, inputs: [None].into_iter().chain(weights).collect() })
}
