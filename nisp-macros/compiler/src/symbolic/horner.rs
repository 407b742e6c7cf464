//! Polynomials as expressions with few operations: common variables are pulled out greedily.

use num_traits::One;

use super::graph::{Graph, Id};
use super::polynomial::Polynomial;
use crate::rational::Rational;

/// A monomial as (variable, exponent) pairs, with its coefficient.
type Term = (Vec<(usize, u32)>, Rational);

/// The polynomial in the given variables, factored.
pub fn polynomial(graph: &mut Graph, polynomial: &Polynomial, variables: &[Id]) -> Id {
    let sparse = |index: &[u32]| index.iter().enumerate().filter(|(_, e)| **e > 0).map(|(v, &e)| (v, e)).collect();
    let terms: Vec<Term> = polynomial.terms().rev().map(|(index, &c)| (sparse(index), c)).collect();
    factored(graph, terms, variables)
}

fn factored(graph: &mut Graph, terms: Vec<Term>, variables: &[Id]) -> Id {
    let Some(variable) = most_frequent(&terms) else {
        let parts: Vec<_> = terms.iter().map(|(powers, c)| (*c, monomial(graph, powers, variables))).collect();
        return graph.linear(&parts);
    };
    let exponent = |powers: &[(usize, u32)]| powers.iter().find(|(v, _)| *v == variable).map_or(0, |&(_, e)| e);
    let (with, without): (Vec<Term>, Vec<Term>) = terms.into_iter().partition(|(powers, _)| exponent(powers) > 0);
    let common = with.iter().map(|(powers, _)| exponent(powers)).min().unwrap_or(0);
    let lower = |(powers, c): Term| {
        let lowered = powers.into_iter().map(|(v, e)| if v == variable { (v, e - common) } else { (v, e) });
        (lowered.filter(|&(_, e)| e > 0).collect(), c)
    };
    let inner = factored(graph, with.into_iter().map(lower).collect(), variables);
    let power = graph.power(variables[variable], Rational::from_integer(i128::from(common)));
    let product = graph.multiply(&[power, inner]);
    if without.is_empty() {
        return product;
    }
    let rest = factored(graph, without, variables);
    graph.add(&[product, rest])
}

/// The variable that most terms share, if at least two do; the first of equals.
fn most_frequent(terms: &[Term]) -> Option<usize> {
    let mut counts = std::collections::BTreeMap::new();
    for (variable, _) in terms.iter().flat_map(|(powers, _)| powers) {
        *counts.entry(*variable).or_insert(0usize) += 1;
    }
    counts.into_iter().filter(|&(_, count)| count > 1).max_by_key(|&(v, count)| (count, usize::MAX - v)).map(|(v, _)| v)
}

fn monomial(graph: &mut Graph, powers: &[(usize, u32)], variables: &[Id]) -> Id {
    let factors: Vec<_> = powers.iter().map(|&(v, e)| (variables[v], Rational::from_integer(i128::from(e)))).collect();
    if factors.is_empty() { graph.number(Rational::one()) } else { graph.product(&factors) }
}
