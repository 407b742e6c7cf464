//! The minimal channel set: the span of all derivatives of the operators that are read.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use num_traits::{One, Zero};

use super::span::Span;
use super::{MultiIndex, Operator};
use crate::rational::Rational;
use crate::symbolic::exact::{self, Exact};

/// One term of a coproduct: left channel, right channel, coefficient.
pub type Share = (usize, usize, Rational);

/// The channels that every hidden unit carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelSet {
    /// Channel operators, by degree; the first is the value, and no other has a constant term.
    pub basis: Vec<Operator>,
    /// Number of coordinates.
    pub coordinates: usize,
    /// For each channel, the functional on coefficients that reads it off an operator in the span.
    dual: Vec<BTreeMap<MultiIndex, Rational>>,
}

impl ChannelSet {
    /// The smallest set that carries the operators exactly through a network. It always has the value.
    ///
    /// Plain partial derivatives are preferred; the rest are derivatives of the operators.
    pub fn minimal<'a>(operators: impl IntoIterator<Item = &'a Operator>, coordinates: usize) -> Exact<Self> {
        let mut span = Span::default();
        span.insert(&Operator::one(coordinates))?;
        let operators: Vec<&Operator> = operators.into_iter().collect();
        for operator in &operators {
            span.close(operator, coordinates)?;
        }
        let mut basis: Vec<Operator> = span.monomials().cloned().map(Operator::monomial).collect();
        let plain = basis.len();
        complete(&mut basis, &span, &operators, coordinates)?;
        let dual = dual(&basis, plain)?;
        let mut order: Vec<usize> = (0..basis.len()).collect();
        order.sort_by_key(|&k| (basis[k].degree(), k >= plain, Reverse(basis[k].clone())));
        Ok(Self {
            basis: order.iter().map(|&k| basis[k].clone()).collect(),
            coordinates,
            dual: order.iter().map(|&k| dual[k].clone()).collect(),
        })
    }

    /// Number of channels.
    pub fn len(&self) -> usize {
        self.basis.len()
    }

    /// Never: every set carries the value.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Largest order of a derivative in it.
    pub fn order(&self) -> u32 {
        self.basis.iter().map(Operator::degree).max().unwrap_or(0)
    }

    /// An operator in terms of the channels: (channel, coefficient). `None` if it is not in the span.
    pub fn express(&self, operator: &Operator) -> Exact<Option<Vec<(usize, Rational)>>> {
        let mut rest = operator.clone();
        let mut combination = Vec::new();
        for (channel, functional) in self.dual.iter().enumerate() {
            let mut coefficient = Rational::zero();
            for (index, &factor) in functional {
                coefficient = exact::add(coefficient, exact::mul(factor, operator.coefficient(index))?)?;
            }
            if !coefficient.is_zero() {
                rest.add_scaled(-coefficient, &self.basis[channel])?;
                combination.push((channel, coefficient));
            }
        }
        Ok(rest.is_empty().then_some(combination))
    }

    /// The coproduct of a channel: `b_k(xi + eta) = sum of c b_i(xi) b_j(eta)`, as (i, j, c).
    pub fn coproduct(&self, channel: usize) -> Exact<Vec<Share>> {
        let readers = self.readers();
        let mut shares: BTreeMap<(usize, usize), Rational> = BTreeMap::new();
        for (index, &coefficient) in self.basis[channel].terms() {
            // The coefficient of P(xi + eta) at xi^p eta^q is that of P at p + q, times the binomial of p + q over p.
            for p in below(index) {
                let q: MultiIndex = index.iter().zip(&p).map(|(n, k)| n - k).collect();
                let (Some(left), Some(right)) = (readers.get(&p), readers.get(&q)) else { continue };
                let mut term = coefficient;
                for (&n, &k) in index.iter().zip(&p) {
                    term = exact::mul(term, exact::binomial(n, k)?)?;
                }
                for &(i, a) in left {
                    for &(j, b) in right {
                        let share = exact::mul(term, exact::mul(a, b)?)?;
                        let total = shares.entry((i, j)).or_insert_with(Rational::zero);
                        *total = exact::add(*total, share)?;
                    }
                }
            }
        }
        Ok(shares.into_iter().filter(|(_, c)| !c.is_zero()).map(|((i, j), c)| (i, j, c)).collect())
    }

    /// For each pivot monomial, the channels that are read off it.
    fn readers(&self) -> BTreeMap<&MultiIndex, Vec<(usize, Rational)>> {
        let mut readers: BTreeMap<&MultiIndex, Vec<(usize, Rational)>> = BTreeMap::new();
        for (channel, functional) in self.dual.iter().enumerate() {
            for (pivot, &weight) in functional {
                readers.entry(pivot).or_default().push((channel, weight));
            }
        }
        readers
    }
}

/// All multi-indices that are nowhere larger.
fn below(index: &[u32]) -> Vec<MultiIndex> {
    index.iter().fold(vec![Vec::new()], |prefixes, &n| {
        let extend = |prefix: MultiIndex| (0..=n).map(move |k| prefix.iter().copied().chain([k]).collect());
        prefixes.into_iter().flat_map(extend).collect()
    })
}

/// Adds derivatives of the operators, reduced by the plain partials in the span, until the basis is complete.
fn complete(basis: &mut Vec<Operator>, span: &Span, operators: &[&Operator], coordinates: usize) -> Exact<()> {
    let mut covered = Span::default();
    for monomial in basis.iter() {
        covered.insert(monomial)?;
    }
    let plain = covered.clone();
    let mut candidates: Vec<Operator> = operators.iter().map(|&operator| operator.clone()).collect();
    let mut next = 0;
    while next < candidates.len() {
        for variable in 0..coordinates {
            let derivative = plain.reduce(&candidates[next].derivative(variable)?)?;
            if !derivative.is_empty() {
                let derivative = derivative.primitive()?;
                if !candidates.contains(&derivative) {
                    candidates.push(derivative);
                }
            }
        }
        next += 1;
    }
    candidates.sort_by_key(|operator| (operator.degree(), Reverse(operator.clone())));
    for candidate in candidates {
        if covered.rank() == span.rank() {
            break;
        }
        let reduced = plain.reduce(&candidate)?;
        if !reduced.is_empty() && covered.insert(&reduced)? {
            basis.push(reduced.primitive()?);
        }
    }
    Ok(())
}

/// The dual basis, supported on one pivot monomial per channel.
///
/// The first `plain` channels are monomials and occur in no other channel; the others are inverted by elimination.
fn dual(basis: &[Operator], plain: usize) -> Exact<Vec<BTreeMap<MultiIndex, Rational>>> {
    let mut dual: Vec<BTreeMap<MultiIndex, Rational>> = Vec::new();
    for monomial in &basis[..plain] {
        dual.extend(monomial.terms().map(|(index, _)| BTreeMap::from([(index.clone(), Rational::one())])));
    }
    // Row r of `rows` is a combination of channels that is one at its pivot and zero at the other pivots.
    let mut rows: Vec<(Operator, Vec<Rational>, MultiIndex)> = Vec::new();
    let mixed = &basis[plain..];
    for (k, channel) in mixed.iter().enumerate() {
        let mut row = channel.clone();
        let mut weights = vec![Rational::zero(); mixed.len()];
        weights[k] = Rational::one();
        for (other, other_weights, pivot) in &rows {
            let factor = -row.coefficient(pivot);
            row.add_scaled(factor, other)?;
            add_weights(&mut weights, factor, other_weights)?;
        }
        let Some((pivot, &leading)) = row.terms().next_back() else { return Err(exact::Overflow) };
        let pivot = pivot.clone();
        let scale = exact::invert(leading)?;
        let row = row.scaled(scale)?;
        let weights: Vec<Rational> = weights.into_iter().map(|w| exact::mul(w, scale)).collect::<Exact<_>>()?;
        for (other, other_weights, _) in &mut rows {
            let factor = -other.coefficient(&pivot);
            other.add_scaled(factor, &row)?;
            add_weights(other_weights, factor, &weights)?;
        }
        rows.push((row, weights, pivot));
    }
    for k in 0..mixed.len() {
        let functional = rows.iter().filter(|(_, weights, _)| !weights[k].is_zero());
        dual.push(functional.map(|(_, weights, pivot)| (pivot.clone(), weights[k])).collect());
    }
    Ok(dual)
}

fn add_weights(weights: &mut [Rational], factor: Rational, other: &[Rational]) -> Exact<()> {
    for (weight, &more) in weights.iter_mut().zip(other) {
        *weight = exact::add(*weight, exact::mul(factor, more)?)?;
    }
    Ok(())
}
