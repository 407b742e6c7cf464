//! Bottom-up rewriting of expressions.

use std::collections::HashMap;

use super::graph::{Graph, Id, Node};

/// Rebuilds `roots` from their leaves up, passing every rebuilt node through `rule`.
pub fn rewrite(graph: &mut Graph, roots: &[Id], mut rule: impl FnMut(&mut Graph, Id) -> Id) -> Vec<Id> {
    let mut new: HashMap<Id, Id> = HashMap::new();
    for id in graph.reachable(roots.iter().copied()) {
        let rebuilt = rebuild(graph, id, &new);
        let result = rule(graph, rebuilt);
        new.insert(id, result);
    }
    roots.iter().map(|id| new[id]).collect()
}

fn rebuild(graph: &mut Graph, id: Id, new: &HashMap<Id, Id>) -> Id {
    match graph.node(id).clone() {
        Node::Number(_) | Node::Real(_) | Node::Leaf(_) => id,
        Node::Sum(constant, terms) => {
            let constant = graph.number(constant);
            let mut parts: Vec<_> = terms.into_iter().map(|(term, c)| (c, new[&term])).collect();
            parts.push((num_traits::One::one(), constant));
            graph.linear(&parts)
        }
        Node::Product(factors) => {
            let factors: Vec<_> = factors.into_iter().map(|(base, e)| (new[&base], e)).collect();
            graph.product(&factors)
        }
        Node::Call(function, x) => graph.call(function, new[&x]),
        Node::Min(a, b) => graph.min(new[&a], new[&b]),
        Node::Max(a, b) => graph.max(new[&a], new[&b]),
    }
}
