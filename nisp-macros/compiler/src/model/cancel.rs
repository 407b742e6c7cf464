//! What is left of a sum when equal parts of it cancel.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::rc::Rc;

use num_traits::{One, Zero};

use super::{Expr, Node};
use crate::rational::Rational;
use crate::syntax::exact;

/// The parts of a sum with their factors: equal parts together, and none that cancels.
pub(super) fn parts(expr: &Expr) -> Vec<(Expr, Rational)> {
    let mut sum = Sum::default();
    sum.add(expr, Rational::one());
    sum.parts.retain(|(_, factor)| !factor.is_zero());
    sum.parts
}

#[derive(Default)]
struct Sum {
    parts: Vec<(Expr, Rational)>,
    /// Numbers of the parts by their fingerprints.
    by_fingerprint: HashMap<u64, Vec<usize>>,
    /// Fingerprints of nodes, shared ones once.
    known: HashMap<*const Node, u64>,
}

impl Sum {
    fn add(&mut self, expr: &Expr, factor: Rational) {
        match &**expr {
            Node::Add(parts) => parts.iter().for_each(|part| self.add(part, factor)),
            Node::Mul(factors) => match literal(factors).and_then(|(value, rest)| Some((exact(factor * value)?, rest)))
            {
                Some((factor, [only])) => self.add(only, factor),
                Some((factor, rest)) => self.part(Rc::new(Node::Mul(rest.to_vec())), factor),
                None => self.part(Rc::clone(expr), factor),
            },
            Node::Number(value) => match exact(factor * value) {
                Some(factor) => self.part(Rc::new(Node::Number(Rational::one())), factor),
                None => self.part(Rc::clone(expr), factor),
            },
            _ => self.part(Rc::clone(expr), factor),
        }
    }

    fn part(&mut self, expr: Expr, factor: Rational) {
        let fingerprint = self.fingerprint(&expr);
        let alike = self.by_fingerprint.entry(fingerprint).or_default();
        let equal = alike.iter().copied().find(|&at| self.parts[at].0 == expr);
        match equal.and_then(|at| Some((at, exact(self.parts[at].1 + factor)?))) {
            Some((at, factor)) => self.parts[at].1 = factor,
            None => {
                alike.push(self.parts.len());
                self.parts.push((expr, factor));
            }
        }
    }

    /// A number that is the same for equal expressions.
    fn fingerprint(&mut self, expr: &Expr) -> u64 {
        if let Some(&known) = self.known.get(&Rc::as_ptr(expr)) {
            return known;
        }
        let mut hasher = DefaultHasher::new();
        std::mem::discriminant(&**expr).hash(&mut hasher);
        let inner: &[Expr] = match &**expr {
            Node::Number(value) => {
                value.hash(&mut hasher);
                &[]
            }
            Node::Real(value) | Node::Quantity(value, _) => {
                value.to_bits().hash(&mut hasher);
                &[]
            }
            Node::Coordinate(at) | Node::Field(at) | Node::Parameter(at) | Node::Column(at) => {
                at.hash(&mut hasher);
                &[]
            }
            Node::Add(parts) | Node::Mul(parts) => parts,
            Node::Div(a, b) | Node::Power(a, b) | Node::Min(a, b) | Node::Max(a, b) => &[Rc::clone(a), Rc::clone(b)],
            Node::Pow(inner, exponent) => {
                exponent.hash(&mut hasher);
                std::slice::from_ref(inner)
            }
            Node::Call(function, inner) => {
                function.hash(&mut hasher);
                std::slice::from_ref(inner)
            }
            Node::Derivative(inner, coordinate) => {
                coordinate.hash(&mut hasher);
                std::slice::from_ref(inner)
            }
            Node::Partner(inner) => std::slice::from_ref(inner),
        };
        for part in inner {
            self.fingerprint(part).hash(&mut hasher);
        }
        let fingerprint = hasher.finish();
        // Expressions that are made here do not live as long as their addresses are remembered.
        if Rc::strong_count(expr) > 1 {
            self.known.insert(Rc::as_ptr(expr), fingerprint);
        }
        fingerprint
    }
}

/// A product's literal factor, which stands first, and the others.
fn literal(factors: &[Expr]) -> Option<(Rational, &[Expr])> {
    match factors {
        [first, rest @ ..] if !rest.is_empty() => match **first {
            Node::Number(value) => Some((value, rest)),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::ratio;

    fn field(at: usize) -> Expr {
        Rc::new(Node::Field(at))
    }

    fn times(factor: i128, expr: Expr) -> Expr {
        Rc::new(Node::Mul(vec![Rc::new(Node::Number(ratio(factor, 1))), expr]))
    }

    #[test]
    fn equal_parts_cancel_within_sums_of_sums() {
        let product = || Rc::new(Node::Mul(vec![field(0), field(1)]));
        let difference = Rc::new(Node::Add(vec![field(2), times(-1, field(2))]));
        let sum: Expr = Rc::new(Node::Add(vec![product(), times(-1, Rc::new(Node::Add(vec![difference, product()])))]));
        assert!(parts(&sum).is_empty());
    }

    #[test]
    fn other_parts_stay_with_their_factors() {
        let sum: Expr = Rc::new(Node::Add(vec![times(3, field(0)), field(1), times(-1, field(0))]));
        assert_eq!(parts(&sum), [(field(0), ratio(2, 1)), (field(1), ratio(1, 1))]);
    }
}
