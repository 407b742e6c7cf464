//! Which linear combinations of derivatives become one operator.
//!
//! Terms with equal cofactor are collected (`D w_xxxx + D w_yyyy` to `D (w_xxxx + w_yyyy)`), then combinations with
//! literal coefficients of one field's derivatives at one site become one operator. Only derivatives that scale alike
//! are combined: their degrees agree in every class of coordinates of equal dimension.

use std::collections::{BTreeMap, BTreeSet};

use num_traits::{One, Zero};

use crate::channels::Operator;
use crate::model::Model;
use crate::rational::Rational;
use crate::symbolic::exact::{self, Exact};
use crate::symbolic::factor::LONG_SUM;
use crate::symbolic::graph::{Graph, Id, Leaf, Node};
use crate::symbolic::rewrite::rewrite;
use crate::symbolic::site::Site;

/// A network output at a site.
type Head = (usize, Site);

/// For each coordinate, the class of coordinates with the same dimension.
pub(super) fn dimension_classes(model: &Model) -> Vec<usize> {
    let dimension = |i: usize| &model.coordinates[i].unit.dimension;
    let first = |i: usize| (0..i).find(|&j| dimension(j) == dimension(i)).unwrap_or(i);
    (0..model.coordinates.len()).map(first).collect()
}

/// Collects terms by cofactor and combines derivatives with literal coefficients into operators.
pub(super) fn collapse(graph: &mut Graph, roots: &[Id], classes: &[usize]) -> Vec<Id> {
    let collected = rewrite(graph, roots, collect_sum);
    rewrite(graph, &collected, |graph, id| collapse_sum(graph, id, classes))
}

/// Merges terms of a sum that have the same cofactor of derivatives of the same head.
fn collect_sum(graph: &mut Graph, id: Id) -> Id {
    let mut sum = id;
    while let Node::Sum(constant, terms) = graph.node(sum).clone() {
        if terms.len() > LONG_SUM {
            break;
        }
        let Some((cofactor, members)) = shared_cofactor(graph, &terms) else { break };
        let mut inner = Vec::new();
        let mut rest = vec![(Rational::one(), graph.number(constant))];
        for (at, &(term, coefficient)) in terms.iter().enumerate() {
            match members.get(&at) {
                Some(&linear) => inner.push((coefficient, linear)),
                None => rest.push((coefficient, term)),
            }
        }
        let inner = graph.linear(&inner);
        let inner = collect_sum(graph, inner);
        let merged = graph.multiply(&[cofactor, inner]);
        rest.push((Rational::one(), merged));
        let next = graph.linear(&rest);
        if graph.fault().is_some() || next == sum {
            break;
        }
        sum = next;
    }
    sum
}

/// The cofactor that most terms share, and those terms by position with what it multiplies.
fn shared_cofactor(graph: &mut Graph, terms: &[(Id, Rational)]) -> Option<(Id, BTreeMap<usize, Id>)> {
    let mut candidates: BTreeMap<(Id, Head), BTreeMap<usize, Id>> = BTreeMap::new();
    for (at, &(term, _)) in terms.iter().enumerate() {
        let Node::Product(factors) = graph.node(term).clone() else { continue };
        for &(base, exponent) in factors.iter().filter(|(_, exponent)| exponent.is_one()) {
            let heads = linear_heads(graph, base);
            if heads.is_empty() {
                continue;
            }
            let cofactor = graph.product(&[(term, Rational::one()), (base, -exponent)]);
            for head in heads {
                candidates.entry((cofactor, head)).or_default().insert(at, base);
            }
        }
    }
    let shared = candidates.into_iter().filter(|(_, members)| members.len() > 1);
    // The first of equals.
    let largest = shared.reduce(|best, next| if next.1.len() > best.1.len() { next } else { best });
    largest.map(|((cofactor, _), members)| (cofactor, members))
}

/// Heads of which an expression contains derivatives with literal coefficients.
fn linear_heads(graph: &Graph, id: Id) -> BTreeSet<Head> {
    let head = |id: Id| match graph.node(id) {
        Node::Leaf(Leaf::Jet { field, site, .. }) => Some((*field, *site)),
        _ => None,
    };
    match graph.node(id) {
        Node::Sum(_, terms) => terms.iter().filter_map(|&(term, _)| head(term)).collect(),
        _ => head(id).into_iter().collect(),
    }
}

fn collapse_sum(graph: &mut Graph, id: Id, classes: &[usize]) -> Id {
    let Node::Sum(constant, terms) = graph.node(id).clone() else { return id };
    let mut groups: BTreeMap<(Head, Vec<u32>), Operator> = BTreeMap::new();
    let mut counts: BTreeMap<(Head, Vec<u32>), usize> = BTreeMap::new();
    let mut rest = vec![(Rational::one(), graph.number(constant))];
    for (term, coefficient) in terms {
        let Node::Leaf(Leaf::Jet { field, site, operator }) = graph.node(term).clone() else {
            rest.push((coefficient, term));
            continue;
        };
        let key = ((field, site), signature(&operator, classes));
        *counts.entry(key.clone()).or_default() += 1;
        if groups.entry(key).or_default().add_scaled(coefficient, &operator).is_err() {
            return id;
        }
    }
    if counts.values().all(|&count| count == 1) {
        return id;
    }
    for (((field, site), _), operator) in groups {
        match normalised(&operator) {
            Ok((content, operator)) => rest.push((content, graph.leaf(Leaf::Jet { field, site, operator }))),
            // Too long for one operator: the parts stay apart.
            Err(exact::Overflow) => return id,
        }
    }
    graph.linear(&rest)
}

/// Total degree in each class of coordinates: derivatives that agree in it scale alike.
fn signature(operator: &Operator, classes: &[usize]) -> Vec<u32> {
    let mut degrees = vec![0; classes.len()];
    if let Some((index, _)) = operator.terms().next() {
        for (&class, &exponent) in classes.iter().zip(index) {
            degrees[class] += exponent;
        }
    }
    degrees
}

fn normalised(operator: &Operator) -> Exact<(Rational, Operator)> {
    let primitive = operator.primitive()?;
    let leading = |operator: &Operator| operator.terms().next().map_or_else(Rational::zero, |(_, &c)| c);
    let content = exact::mul(leading(operator), exact::invert(leading(&primitive))?)?;
    Ok((content, primitive))
}

/// Coordinates that must share a scale because an operator combines derivatives by them, as a class per coordinate.
pub(super) fn scale_groups<'a>(operators: impl Iterator<Item = &'a Operator>, classes: &[usize]) -> Vec<usize> {
    let mut group: Vec<usize> = (0..classes.len()).collect();
    for operator in operators {
        let Some((first, _)) = operator.terms().next() else { continue };
        let differs = |i: &usize| operator.terms().any(|(index, _)| index[*i] != first[*i]);
        let tied: Vec<usize> = (0..classes.len()).filter(differs).collect();
        for (&a, &b) in tied.iter().flat_map(|a| tied.iter().map(move |b| (a, b))) {
            if classes[a] == classes[b] && group[a] != group[b] {
                let (keep, drop) = (group[a].min(group[b]), group[a].max(group[b]));
                group.iter_mut().filter(|g| **g == drop).for_each(|g| *g = keep);
            }
        }
    }
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    for &root in &group {
        let next = numbers.len();
        numbers.entry(root).or_insert(next);
    }
    group.iter().map(|root| numbers[root]).collect()
}
