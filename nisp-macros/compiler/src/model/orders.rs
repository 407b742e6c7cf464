//! Which derivatives of which fields an expression reads.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::{Expr, Node};

/// The highest derivatives of one field.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Orders {
    /// Counted over all coordinates.
    pub(super) total: u32,
    /// By each coordinate that occurs.
    pub(super) by: BTreeMap<usize, u32>,
}

type Fields = Rc<BTreeMap<usize, Orders>>;

/// Walks expressions, shared parts once.
#[derive(Default)]
pub(super) struct Walker {
    seen: BTreeMap<*const Node, Fields>,
    /// Expressions that were made to be walked: their addresses must not be used again while the walker remembers them.
    kept: Vec<Expr>,
    /// Coordinates read, as themselves or by a derivative.
    pub(super) coordinates: std::collections::BTreeSet<usize>,
}

impl Walker {
    /// Keeps an expression that nothing else keeps.
    pub(super) fn keep(&mut self, expr: Expr) {
        self.kept.push(expr);
    }

    /// The fields in an expression with their derivatives' orders.
    pub(super) fn fields(&mut self, expr: &Expr) -> Fields {
        if let Some(found) = self.seen.get(&Rc::as_ptr(expr)) {
            return Rc::clone(found);
        }
        let mut found = BTreeMap::new();
        match &**expr {
            Node::Number(_) | Node::Real(_) | Node::Quantity(..) | Node::Parameter(_) | Node::Column(_) => {}
            Node::Coordinate(index) => {
                self.coordinates.insert(*index);
            }
            Node::Field(index) => {
                found.insert(*index, Orders::default());
            }
            Node::Add(parts) | Node::Mul(parts) => parts.iter().for_each(|part| merge(&mut found, &self.fields(part))),
            Node::Div(a, b) | Node::Power(a, b) | Node::Min(a, b) | Node::Max(a, b) => {
                merge(&mut found, &self.fields(a));
                merge(&mut found, &self.fields(b));
            }
            Node::Pow(inner, _) | Node::Call(_, inner) | Node::Partner(inner) => found = (*self.fields(inner)).clone(),
            Node::Derivative(inner, coordinate) => {
                self.coordinates.insert(*coordinate);
                found = (*self.fields(inner)).clone();
                for orders in found.values_mut() {
                    orders.total += 1;
                    *orders.by.entry(*coordinate).or_default() += 1;
                }
            }
        }
        let found = Rc::new(found);
        self.seen.insert(Rc::as_ptr(expr), Rc::clone(&found));
        found
    }
}

/// Raises every order to at least the other's.
pub(super) fn merge(all: &mut BTreeMap<usize, Orders>, other: &BTreeMap<usize, Orders>) {
    for (field, orders) in other {
        let known = all.entry(*field).or_default();
        known.total = known.total.max(orders.total);
        for (coordinate, order) in &orders.by {
            let highest = known.by.entry(*coordinate).or_default();
            *highest = (*highest).max(*order);
        }
    }
}
