//! Derivatives: one table of local partial derivatives, used forwards (by a coordinate) and in reverse (adjoints).

use std::collections::{BTreeMap, BTreeSet, HashMap};

use num_traits::One;

use super::function;
use super::graph::{Fault, Graph, Id, Leaf, Node, ZERO};
use super::polynomial::Polynomial;
use crate::model::Function;
use crate::program::Slot;
use crate::rational::{Rational, ratio};

/// Derivatives by coordinates that are already known.
pub type Memo = HashMap<(Id, usize), Id>;

/// The partial derivatives of a node by its children: the one place where a rule of differentiation is written.
pub fn partials(graph: &mut Graph, id: Id) -> Vec<(Id, Id)> {
    match graph.node(id).clone() {
        Node::Number(_) | Node::Real(_) | Node::Leaf(_) => Vec::new(),
        Node::Sum(_, terms) => terms.into_iter().map(|(term, c)| (term, graph.number(c))).collect(),
        Node::Product(factors) => (0..factors.len()).map(|i| product_partial(graph, &factors, i)).collect(),
        Node::Call(f, x) => vec![(x, function::derivative(graph, f, x, id))],
        Node::Min(a, b) => choice_partials(graph, a, b, b, a),
        Node::Max(a, b) => choice_partials(graph, a, b, a, b),
    }
}

fn product_partial(graph: &mut Graph, factors: &[(Id, Rational)], i: usize) -> (Id, Id) {
    let (base, exponent) = factors[i];
    let mut rest = factors.to_vec();
    rest[i].1 = exponent - Rational::one();
    let product = graph.product(&rest);
    (base, graph.scale(exponent, product))
}

/// `a` is chosen where `greater > smaller`, `b` elsewhere.
fn choice_partials(graph: &mut Graph, a: Id, b: Id, greater: Id, smaller: Id) -> Vec<(Id, Id)> {
    let difference = graph.subtract(greater, smaller);
    let step = graph.call(Function::Step, difference);
    let one = graph.integer(1);
    let rest = graph.subtract(one, step);
    vec![(a, step), (b, rest)]
}

/// The total derivative of an expression by a coordinate, of which there are `coordinates`.
pub fn derivative(graph: &mut Graph, memo: &mut Memo, root: Id, coordinate: usize, coordinates: usize) -> Id {
    let order: Vec<Id> = pending(graph, memo, root, coordinate).into_iter().collect();
    for id in order {
        let result = match graph.node(id).clone() {
            Node::Leaf(leaf) => leaf_derivative(graph, leaf, coordinate, coordinates),
            _ => {
                // Constant children contribute nothing: do not build their partials' products.
                let parts = partials(graph, id);
                let mut terms = Vec::new();
                for (child, partial) in parts {
                    let inner = memo.get(&(child, coordinate)).copied().unwrap_or(ZERO);
                    if inner != ZERO {
                        terms.push(graph.multiply(&[partial, inner]));
                    }
                }
                graph.add(&terms)
            }
        };
        memo.insert((id, coordinate), result);
        if graph.fault().is_some() {
            return ZERO;
        }
    }
    memo.get(&(root, coordinate)).copied().unwrap_or(ZERO)
}

/// Nodes below `root` whose derivative is not yet known, children first.
fn pending(graph: &Graph, memo: &Memo, root: Id, coordinate: usize) -> BTreeSet<Id> {
    let mut open = vec![root];
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !memo.contains_key(&(id, coordinate)) && found.insert(id) {
            open.extend(graph.children(id));
        }
    }
    found
}

fn leaf_derivative(graph: &mut Graph, leaf: Leaf, coordinate: usize, coordinates: usize) -> Id {
    match leaf {
        Leaf::Jet { site, .. } if site.holds(coordinate) => ZERO,
        Leaf::Jet { field, site, operator } => match operator.times(&Polynomial::variable(coordinate, coordinates)) {
            Ok(operator) => graph.leaf(Leaf::Jet { field, site, operator }),
            Err(_) => graph.fail(Fault::Overflow),
        },
        // Coordinates of the partner follow those of the point.
        Leaf::Input(Slot::Coordinate, index) => graph.integer(i128::from(index % coordinates == coordinate)),
        Leaf::Input(Slot::Column, _) => graph.fail(Fault::ColumnDerivative),
        Leaf::Input(..) => ZERO,
    }
}

/// Reverse accumulation: the adjoint of each wanted node, given the adjoints of some roots.
pub fn reverse(graph: &mut Graph, seeds: &[(Id, Id)], wanted: &[Id]) -> Vec<Id> {
    let below = graph.reachable(seeds.iter().map(|&(root, _)| root));
    let active = depends_on(graph, &below, wanted);
    let mut adjoints: BTreeMap<Id, Vec<Id>> = BTreeMap::new();
    for &(root, seed) in seeds {
        adjoints.entry(root).or_default().push(seed);
    }
    let mut totals: BTreeMap<Id, Id> = BTreeMap::new();
    for &id in active.iter().rev() {
        let Some(parts) = adjoints.remove(&id) else { continue };
        let adjoint = graph.add(&parts);
        totals.insert(id, adjoint);
        if adjoint == ZERO || wanted.contains(&id) && graph.children(id).is_empty() {
            continue;
        }
        let kept = |(child, _): &(Id, Id)| active.contains(child);
        for (child, partial) in partials(graph, id).into_iter().filter(kept).collect::<Vec<_>>() {
            let share = graph.multiply(&[adjoint, partial]);
            adjoints.entry(child).or_default().push(share);
        }
    }
    wanted.iter().map(|id| totals.get(id).copied().unwrap_or(ZERO)).collect()
}

/// Those of `nodes` (children first) from which a wanted node can be reached.
fn depends_on(graph: &Graph, nodes: &BTreeSet<Id>, wanted: &[Id]) -> BTreeSet<Id> {
    let mut active = BTreeSet::new();
    for &id in nodes {
        if wanted.contains(&id) || graph.children(id).iter().any(|child| active.contains(child)) {
            active.insert(id);
        }
    }
    active
}

/// The adjoint of an activation's argument: the derivative of `phi[n]` is `phi[n + 1]`.
pub fn activation_adjoint(graph: &mut Graph, phi_adjoints: &[Id]) -> Id {
    let mut terms = Vec::new();
    for (n, &adjoint) in phi_adjoints.iter().enumerate() {
        let next = graph.input(Slot::Phi, n + 1);
        let share = graph.multiply(&[adjoint, next]);
        terms.push((ratio(1, 1), share));
    }
    graph.linear(&terms)
}
