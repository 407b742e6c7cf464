//! The expression graph: hash-consed nodes in an arena, simplified as they are made.
//!
//! A node's children have smaller indices, so a loop over indices is a topological order and equal expressions
//! are one node. Sums are flat with exact coefficients; products are flat with exact exponents and no coefficient
//! (`2 x y` is a sum with one term), which makes both forms canonical.

use std::collections::{BTreeSet, HashMap};

use num_traits::Zero;

use super::elementary::{self, Parity};
use super::exact;
use super::polynomial::Polynomial;
use super::site::Site;
use crate::model::Function;
use crate::program::{self, Slot};
use crate::rational::Rational;

/// Index of a node.
pub type Id = usize;

/// More nodes than any sensible equation has.
pub const NODE_LIMIT: usize = 200_000;

/// More terms and factors, over all nodes, than any sensible equation has.
pub const SIZE_LIMIT: usize = 2_000_000;

/// Index of the constant zero in every graph.
pub const ZERO: Id = 0;

/// A node of the graph.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// An exact number.
    Number(Rational),
    /// A real number, by its bits.
    Real(u64),
    /// An input.
    Leaf(Leaf),
    /// `constant + sum of coefficient * term`; terms ascending, coefficients not zero.
    Sum(Rational, Vec<(Id, Rational)>),
    /// Product of `base ^ exponent`; bases ascending, exponents not zero.
    Product(Vec<(Id, Rational)>),
    /// An elementary function.
    Call(Function, Id),
    /// The smaller of two.
    Min(Id, Id),
    /// The larger of two.
    Max(Id, Id),
}

/// An input of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// A network output, or an operator applied to it.
    Jet {
        /// Index of the field in the model.
        field: usize,
        /// Where it is taken.
        site: Site,
        /// Which operator.
        operator: Polynomial,
    },
    /// Anything that a program reads from a slot.
    Input(Slot, usize),
}

/// Why an expression could not be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Past [`NODE_LIMIT`] or [`SIZE_LIMIT`].
    Growth,
    /// A coefficient outgrew 128-bit integers.
    Overflow,
    /// Division by the constant zero, or a value that is no real number.
    Undefined,
    /// A data column was differentiated.
    ColumnDerivative,
    /// A field is fixed to an expression that contains it.
    Circular,
}

impl Fault {
    /// What to tell the user.
    pub fn message(self) -> &'static str {
        match self {
            Self::Growth => {
                "the expression grows past 200000 nodes when its derivatives are carried out\n\
                 = help: name intermediate quantities as fields, or lower the order"
            }
            Self::Overflow => {
                "a coefficient outgrows exact arithmetic\n= help: make it a parameter, or round it to fewer digits"
            }
            Self::Undefined => {
                "a constant subexpression has no real value (a division by zero or a root of a negative)"
            }
            Self::ColumnDerivative => {
                "a data column is known at its points only and cannot be differentiated\n\
                 = help: observe a field with it and differentiate the field"
            }
            Self::Circular => "a field is fixed to an expression that contains the field itself",
        }
    }
}

/// The arena.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    index: HashMap<Node, Id>,
    size: usize,
    fault: Option<Fault>,
}

impl Default for Graph {
    fn default() -> Self {
        let zero = Node::Number(Rational::zero());
        Self { nodes: vec![zero.clone()], index: HashMap::from([(zero, ZERO)]), size: 1, fault: None }
    }
}

impl Graph {
    /// The first fault, if any: every expression built after it is zero.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Notes a fault and returns a stand-in for the expression that could not be built.
    pub fn fail(&mut self, fault: Fault) -> Id {
        self.fault.get_or_insert(fault);
        ZERO
    }

    /// The node behind an index.
    pub fn node(&self, id: Id) -> &Node {
        &self.nodes[id]
    }

    pub(super) fn intern(&mut self, node: Node) -> Id {
        if let Some(&id) = self.index.get(&node) {
            return id;
        }
        self.size += match &node {
            Node::Sum(_, parts) | Node::Product(parts) => 1 + parts.len(),
            _ => 1,
        };
        if self.nodes.len() >= NODE_LIMIT || self.size > SIZE_LIMIT {
            return self.fail(Fault::Growth);
        }
        let id = self.nodes.len();
        self.nodes.push(node.clone());
        self.index.insert(node, id);
        id
    }

    /// An exact number.
    pub fn number(&mut self, value: Rational) -> Id {
        self.intern(Node::Number(value))
    }

    /// An integer.
    pub fn integer(&mut self, value: i128) -> Id {
        self.number(Rational::from_integer(value))
    }

    /// A real number.
    pub fn real(&mut self, value: f64) -> Id {
        if !value.is_finite() {
            return self.fail(Fault::Undefined);
        }
        if value == 0.0 { ZERO } else { self.intern(Node::Real(value.to_bits())) }
    }

    /// An input.
    pub fn leaf(&mut self, leaf: Leaf) -> Id {
        self.intern(Node::Leaf(leaf))
    }

    /// What a program reads from a slot.
    pub fn input(&mut self, slot: Slot, index: usize) -> Id {
        self.leaf(Leaf::Input(slot, index))
    }

    /// The value of a constant node.
    pub fn constant(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Number(value) => Some(exact::to_f64(*value)),
            Node::Real(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    /// The value of an exact constant.
    pub fn exact_constant(&self, id: Id) -> Option<Rational> {
        if let Node::Number(value) = self.node(id) { Some(*value) } else { None }
    }

    /// An elementary function of `x`.
    pub fn call(&mut self, function: Function, x: Id) -> Id {
        if let Some(value) = self.exact_constant(x)
            && let Some(result) = elementary::exact_value(function, value)
        {
            return self.number(result);
        }
        if let Some(value) = self.constant(x) {
            return self.real(program::value(function, value));
        }
        let flipped = match self.node(x) {
            Node::Sum(constant, terms) => constant.is_zero() && terms[0].1 < Rational::zero(),
            _ => false,
        };
        match elementary::parity(function) {
            Parity::Even if flipped => {
                let positive = self.negate(x);
                self.call(function, positive)
            }
            Parity::Odd if flipped => {
                let positive = self.negate(x);
                let result = self.call(function, positive);
                self.negate(result)
            }
            _ => self.intern(Node::Call(function, x)),
        }
    }

    /// The smaller of two; where both are equal, the derivative is that of `b`.
    pub fn min(&mut self, a: Id, b: Id) -> Id {
        match (self.constant(a), self.constant(b)) {
            (Some(x), Some(y)) => {
                if x < y {
                    a
                } else {
                    b
                }
            }
            _ if a == b => a,
            _ => self.intern(Node::Min(a, b)),
        }
    }

    /// The larger of two; where both are equal, the derivative is that of `b`.
    pub fn max(&mut self, a: Id, b: Id) -> Id {
        match (self.constant(a), self.constant(b)) {
            (Some(x), Some(y)) => {
                if x > y {
                    a
                } else {
                    b
                }
            }
            _ if a == b => a,
            _ => self.intern(Node::Max(a, b)),
        }
    }

    /// Indices of a node's children, in ascending order for sums and products.
    pub fn children(&self, id: Id) -> Vec<Id> {
        match self.node(id) {
            Node::Number(_) | Node::Real(_) | Node::Leaf(_) => Vec::new(),
            Node::Sum(_, parts) | Node::Product(parts) => parts.iter().map(|(child, _)| *child).collect(),
            Node::Call(_, x) => vec![*x],
            Node::Min(a, b) | Node::Max(a, b) => vec![*a, *b],
        }
    }

    /// Everything that `roots` depend on, themselves included, children before parents.
    pub fn reachable(&self, roots: impl IntoIterator<Item = Id>) -> BTreeSet<Id> {
        let mut open: Vec<Id> = roots.into_iter().collect();
        let mut found: BTreeSet<Id> = BTreeSet::new();
        while let Some(id) = open.pop() {
            if found.insert(id) {
                open.extend(self.children(id));
            }
        }
        found
    }
}
