//! The product rule: `(f g)_k = sum of c^k_ij f_i g_j`.

use super::{ChannelSet, Rule};
use crate::program::Slot;
use crate::symbolic::exact::Exact;
use crate::symbolic::graph::{Graph, Id};
use crate::symbolic::horner;
use crate::symbolic::polynomial::Polynomial;

/// The product of two jets.
pub fn product(set: &ChannelSet) -> Exact<Rule> {
    let mut graph = Graph::default();
    let size = set.len();
    let inputs: Vec<(Slot, usize)> =
        [Slot::Left, Slot::Right].into_iter().flat_map(|slot| (0..size).map(move |k| (slot, k))).collect();
    let variables: Vec<Id> = inputs.iter().map(|&(slot, k)| graph.input(slot, k)).collect();
    let mut results = Vec::new();
    for channel in 0..size {
        let terms = set.coproduct(channel)?.into_iter().map(|(i, j, coefficient)| {
            let mut index = vec![0; 2 * size];
            index[i] = 1;
            index[size + j] = 1;
            (index, coefficient)
        });
        let bilinear = Polynomial::from_terms(terms)?;
        results.push(horner::polynomial(&mut graph, &bilinear, &variables));
    }
    Ok(Rule { graph, results, phis: 0, inputs: inputs.into_iter().map(Some).collect() })
}
