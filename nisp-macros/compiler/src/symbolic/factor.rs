//! Common factors of a sum's terms are pulled out: `a b c + a d e` becomes `a (b c + d e)`.

use std::collections::BTreeMap;

use num_traits::{One, Signed, Zero};

use super::graph::{Graph, Id, Node};
use super::rewrite::rewrite;
use crate::rational::Rational;

/// A base with the sign of its exponent: `1/d` and `d` are different factors.
type Key = (Id, bool);

/// Sums longer than this stay as they are: looking for the best factor takes time quadratic in the length.
pub const LONG_SUM: usize = 1000;

/// Pulls common factors out of every sum below `roots`.
pub fn factor(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    rewrite(graph, roots, factor_sum)
}

fn factor_sum(graph: &mut Graph, id: Id) -> Id {
    let Node::Sum(constant, terms) = graph.node(id).clone() else { return id };
    if terms.len() > LONG_SUM {
        return id;
    }
    let Some((base, positive)) = most_frequent(graph, &terms) else { return id };
    let matching = |e: &Rational| e.is_integer() && e.is_positive() == positive;
    let exponent = |graph: &Graph, term: Id| exponent_of(graph, term, base).filter(matching);
    let (with, without): (Vec<_>, Vec<_>) = terms.into_iter().partition(|&(t, _)| exponent(graph, t).is_some());
    let exponents = with.iter().filter_map(|&(term, _)| exponent(graph, term));
    let common = exponents.min_by_key(Signed::abs).unwrap_or_else(Rational::one);
    let mut inner = Vec::new();
    for (term, coefficient) in with {
        inner.push((coefficient, divided(graph, term, base, common)));
    }
    let inner = graph.linear(&inner);
    let inner = factor_sum(graph, inner);
    let pulled = graph.product(&[(base, common), (inner, Rational::one())]);
    if without.is_empty() && constant.is_zero() {
        return pulled;
    }
    let constant = graph.number(constant);
    let rest: Vec<_> = without.into_iter().map(|(t, c)| (c, t)).chain([(Rational::one(), constant)]).collect();
    let rest = graph.linear(&rest);
    let rest = factor_sum(graph, rest);
    graph.add(&[pulled, rest])
}

/// `term / base^exponent` for a factor of the term. The factor is taken away, never multiplied by its inverse: `r * (1/r)`
/// of an inexact number need not be one, and the quotient would go on having a common factor.
fn divided(graph: &mut Graph, term: Id, base: Id, exponent: Rational) -> Id {
    let mut factors = match graph.node(term) {
        Node::Product(factors) => factors.clone(),
        _ => vec![(term, Rational::one())],
    };
    for (factor, power) in &mut factors {
        if *factor == base {
            *power -= exponent;
        }
    }
    graph.product(&factors)
}

fn exponent_of(graph: &Graph, term: Id, base: Id) -> Option<Rational> {
    match graph.node(term) {
        Node::Product(factors) => factors.iter().find(|(b, _)| *b == base).map(|&(_, e)| e),
        _ => (term == base).then(Rational::one),
    }
}

/// The factor that most terms share, if at least two do; the first of equals. A term by itself counts as a factor
/// only of products: `a + a b` stays as it is unless another product has `a`.
fn most_frequent(graph: &Graph, terms: &[(Id, Rational)]) -> Option<Key> {
    let mut counts: BTreeMap<Key, usize> = BTreeMap::new();
    for (term, _) in terms {
        if let Node::Product(factors) = graph.node(*term) {
            for (base, exponent) in factors.iter().filter(|(_, e)| e.is_integer()) {
                *counts.entry((*base, exponent.is_positive())).or_insert(0) += 1;
            }
        }
    }
    let shared = counts.into_iter().filter(|&(_, count)| count > 1);
    shared.max_by_key(|&((base, _), count)| (count, usize::MAX - base)).map(|(key, _)| key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Slot;
    use crate::symbolic::graph::Leaf;

    #[test]
    fn an_inexact_factor_is_pulled_out_once() {
        assert_ne!(49.0 * (1.0 / 49.0), 1.0, "otherwise this proves nothing");
        let mut graph = Graph::default();
        let [a, b] = [0, 1].map(|i| graph.leaf(Leaf::Input(Slot::Parameter, i)));
        let r = graph.real(49.0);
        let (left, right) = (graph.multiply(&[a, b, r]), graph.multiply(&[a, a, r]));
        let sum = graph.add(&[left, right]);
        let inner = graph.add(&[a, b]);
        let expected = graph.multiply(&[a, r, inner]);
        assert_eq!(factor(&mut graph, &[sum]), [expected]);
    }
}
