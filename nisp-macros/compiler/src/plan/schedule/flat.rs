//! Expressions as lists of terms and lists of factors, the form in which common parts are found.

use std::collections::HashMap;

use num_traits::{One, Signed, Zero};

use crate::model::Function;
use crate::program::Slot;
use crate::rational::{Rational, ratio};
use crate::symbolic::exact;
use crate::symbolic::graph::{Graph, Id, Leaf, Node};

/// Powers up to this are repeated factors; larger ones are made by squaring.
const REPEATED: i128 = 8;

/// A list form.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Item {
    Input(Slot, usize),
    /// A number, by its bits.
    Constant(u64),
    /// `constant + sum of coefficient * item`.
    Sum(Rational, Vec<(usize, Rational)>),
    /// Factors, sorted, repeated for powers; two or more as built, one where sharing left no other.
    Product(Vec<usize>),
    Reciprocal(usize),
    Call(Function, usize),
    Min(usize, usize),
    Max(usize, usize),
}

/// All items; later steps rewrite lists in place and append items.
#[derive(Clone, Debug, Default)]
pub(super) struct Flat {
    pub(super) items: Vec<Item>,
    /// Whether an item depends on scalars only, and not on the point.
    pub(super) uniform: Vec<bool>,
    index: HashMap<Item, usize>,
}

impl Item {
    /// Items it is computed from.
    pub(super) fn operands(&self) -> Vec<usize> {
        match self {
            Self::Input(..) | Self::Constant(_) => Vec::new(),
            Self::Sum(_, terms) => terms.iter().map(|(item, _)| *item).collect(),
            Self::Product(factors) => factors.clone(),
            Self::Reciprocal(x) | Self::Call(_, x) => vec![*x],
            Self::Min(a, b) | Self::Max(a, b) => vec![*a, *b],
        }
    }
}

impl Flat {
    /// Takes over expressions from a graph; returns their items.
    pub(super) fn import(&mut self, graph: &Graph, roots: &[Id], slot: &dyn Fn(&Leaf) -> (Slot, usize)) -> Vec<usize> {
        let mut place: HashMap<Id, usize> = HashMap::new();
        for id in graph.reachable(roots.iter().copied()) {
            let item = match graph.node(id) {
                Node::Number(value) => self.constant(exact::to_f64(*value)),
                Node::Real(bits) => self.intern(Item::Constant(*bits)),
                Node::Leaf(leaf) => {
                    let (slot, index) = slot(leaf);
                    self.intern(Item::Input(slot, index))
                }
                Node::Sum(constant, terms) => {
                    let terms = terms.iter().map(|(term, c)| (place[term], *c)).collect();
                    self.sum(*constant, terms)
                }
                Node::Product(factors) => {
                    let factors: Vec<_> = factors.iter().map(|(base, e)| (place[base], *e)).collect();
                    self.powers(&factors)
                }
                Node::Call(function, x) => self.intern(Item::Call(*function, place[x])),
                Node::Min(a, b) => self.intern(Item::Min(place[a], place[b])),
                Node::Max(a, b) => self.intern(Item::Max(place[a], place[b])),
            };
            place.insert(id, item);
        }
        roots.iter().map(|id| place[id]).collect()
    }

    pub(super) fn intern(&mut self, item: Item) -> usize {
        if let Some(&known) = self.index.get(&item) {
            return known;
        }
        let uniform = match &item {
            Item::Input(slot, _) => *slot == Slot::Parameter,
            other => other.operands().iter().all(|&operand| self.uniform[operand]),
        };
        self.items.push(item.clone());
        self.uniform.push(uniform);
        self.index.insert(item, self.items.len() - 1);
        self.items.len() - 1
    }

    fn constant(&mut self, value: f64) -> usize {
        self.intern(Item::Constant(value.to_bits()))
    }

    /// The product of factors; one factor is itself.
    pub(super) fn product(&mut self, mut factors: Vec<usize>) -> usize {
        factors.sort_unstable();
        match factors[..] {
            [] => self.constant(1.0),
            [only] => only,
            _ => self.intern(Item::Product(factors)),
        }
    }

    fn powers(&mut self, powers: &[(usize, Rational)]) -> usize {
        let mut factors = Vec::new();
        for &(base, exponent) in powers {
            if !exponent.is_integer() {
                let logarithm = self.intern(Item::Call(Function::Ln, base));
                let scaled = self.intern(Item::Sum(Rational::zero(), vec![(logarithm, exponent)]));
                factors.push(self.intern(Item::Call(Function::Exp, scaled)));
                continue;
            }
            let base = if exponent.is_negative() { self.intern(Item::Reciprocal(base)) } else { base };
            self.repeat(&mut factors, base, exponent.abs().to_integer());
        }
        let (uniform, mut varying): (Vec<usize>, Vec<usize>) = factors.into_iter().partition(|&f| self.uniform[f]);
        if !uniform.is_empty() {
            varying.push(self.product(uniform));
        }
        self.product(varying)
    }

    fn repeat(&mut self, factors: &mut Vec<usize>, base: usize, times: i128) {
        if times <= REPEATED {
            factors.extend((0..times).map(|_| base));
            return;
        }
        let mut half = Vec::new();
        self.repeat(&mut half, base, times / 2);
        let half = self.product(half);
        factors.extend([half, half]);
        self.repeat(factors, base, times % 2);
    }

    /// A sum, with the part that depends on scalars only as one term, and coefficients folded into scalar factors.
    fn sum(&mut self, constant: Rational, terms: Vec<(usize, Rational)>) -> usize {
        let (uniform, varying): (Vec<_>, Vec<_>) = terms.into_iter().partition(|&(item, _)| self.uniform[item]);
        if varying.is_empty() {
            return self.intern(Item::Sum(constant, uniform));
        }
        let mut terms: Vec<(usize, Rational)> =
            varying.into_iter().map(|(item, coefficient)| self.fold_coefficient(item, coefficient)).collect();
        let alone = constant.is_zero() && uniform.len() == 1;
        if uniform.is_empty() || alone {
            terms.extend(uniform);
            terms.sort_unstable();
            return self.intern(Item::Sum(constant, terms));
        }
        let offset = self.intern(Item::Sum(constant, uniform));
        terms.push((offset, Rational::one()));
        terms.sort_unstable();
        self.intern(Item::Sum(Rational::zero(), terms))
    }

    fn fold_coefficient(&mut self, item: usize, coefficient: Rational) -> (usize, Rational) {
        let unit = coefficient.abs().is_one();
        let Item::Product(factors) = self.items[item].clone() else { return (item, coefficient) };
        let Some(at) = factors.iter().position(|&f| self.uniform[f]).filter(|_| !unit) else {
            return (item, coefficient);
        };
        let scaled = match self.items[factors[at]] {
            Item::Constant(bits) => self.constant(exact::to_f64(coefficient) * f64::from_bits(bits)),
            _ => self.intern(Item::Sum(Rational::zero(), vec![(factors[at], coefficient)])),
        };
        let mut factors = factors;
        factors[at] = scaled;
        (self.product(factors), ratio(1, 1))
    }
}
