//! Natural sizes: every sum becomes the sum of its terms' absolute values.

use std::collections::HashMap;

use num_traits::{One, Signed};

use super::graph::{Graph, Id, Node};
use crate::model::Function;

/// The sizes of `roots`.
pub fn magnitude(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut sizes: HashMap<Id, Id> = HashMap::new();
    for id in graph.reachable(roots.iter().copied()) {
        let size = node_size(graph, id, &sizes);
        sizes.insert(id, size);
    }
    roots.iter().map(|id| sizes[id]).collect()
}

fn node_size(graph: &mut Graph, id: Id, sizes: &HashMap<Id, Id>) -> Id {
    match graph.node(id).clone() {
        Node::Number(_) | Node::Real(_) | Node::Leaf(_) => graph.call(Function::Abs, id),
        Node::Sum(constant, terms) => {
            let constant = graph.number(constant.abs());
            let mut parts: Vec<_> = terms.into_iter().map(|(term, c)| (c.abs(), sizes[&term])).collect();
            parts.push((One::one(), constant));
            graph.linear(&parts)
        }
        Node::Product(factors) => {
            let mut powers = Vec::new();
            for (base, exponent) in factors {
                // A sum in a denominator has no cancellation-free size: take its value.
                let size = if exponent.is_negative() { graph.call(Function::Abs, base) } else { sizes[&base] };
                powers.push((size, exponent));
            }
            graph.product(&powers)
        }
        Node::Call(function, x) => call_size(graph, function, x, id, sizes),
        Node::Min(a, b) | Node::Max(a, b) => graph.max(sizes[&a], sizes[&b]),
    }
}

/// Functions that are bounded and vanish somewhere are as large as their bound or their argument; others as large as they are.
fn call_size(graph: &mut Graph, function: Function, x: Id, id: Id, sizes: &HashMap<Id, Id>) -> Id {
    let one = graph.integer(1);
    match function {
        Function::Cos | Function::Sign | Function::Step => one,
        Function::Sin | Function::Tanh | Function::Atan => graph.min(sizes[&x], one),
        Function::Sqrt | Function::Abs => graph.call(function, sizes[&x]),
        _ => graph.call(Function::Abs, id),
    }
}
