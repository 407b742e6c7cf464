//! Model expressions to graph nodes: substitutions made, derivatives carried out.

use std::collections::HashMap;
use std::rc::Rc;

use super::differentiate::{self, Memo};
use super::exact;
use super::graph::{Fault, Graph, Id, Leaf, ZERO};
use super::polynomial::Polynomial;
use super::site::Site;
use crate::model::{Expr, Function, Model, Node, Scene};
use crate::program::Slot;
use crate::rational::ratio;
use crate::unit::Dimension;

/// Deeper nesting than any sensible equation has; bounds the recursion.
const DEPTH_LIMIT: usize = 500;

/// A scalar input of group programs.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// A parameter, by index in the model.
    Parameter(usize),
    /// A literal with a unit: SI value and dimension.
    Literal(f64, Dimension),
    /// The natural size of a bounded field, by index in the model: the unit of its softplus.
    FieldScale(usize),
    /// The natural size of one side of a complementarity, to make both sides comparable: dimension, then the group and term
    /// (indices in the plan) it belongs to, and its side (0, 1).
    SideScale(Dimension, usize, usize, usize),
}

/// The scalars of a scene, in order of first use.
#[derive(Clone, Debug, Default)]
pub struct Scalars {
    /// Distinct scalars; slot numbers of [`Slot::Parameter`] are indices into it.
    pub list: Vec<Scalar>,
}

impl Scalars {
    /// The slot of a scalar.
    pub fn slot(&mut self, scalar: Scalar) -> usize {
        if let Some(known) = self.list.iter().position(|other| *other == scalar) {
            return known;
        }
        self.list.push(scalar);
        self.list.len() - 1
    }
}

/// Lowers the expressions of one group in one scene.
pub struct Lowering<'a> {
    /// Where the expressions go.
    pub graph: Graph,
    model: &'a Model,
    scene: &'a Scene,
    scalars: &'a mut Scalars,
    known: HashMap<(*const Node, usize), Id>,
    derivatives: Memo,
    /// Fields whose substitutes are being lowered, to catch a field that is fixed to itself.
    open: Vec<usize>,
    depth: usize,
}

impl<'a> Lowering<'a> {
    /// An empty graph for one group.
    pub fn new(model: &'a Model, scene: &'a Scene, scalars: &'a mut Scalars) -> Self {
        Self {
            graph: Graph::default(),
            model,
            scene,
            scalars,
            known: HashMap::new(),
            derivatives: Memo::new(),
            open: Vec::new(),
            depth: 0,
        }
    }

    /// An expression at a site: 0 is the point itself, 1 its partner.
    pub fn lower(&mut self, expression: &Expr, site: usize) -> Id {
        let key = (Rc::as_ptr(expression), site);
        if let Some(&id) = self.known.get(&key) {
            return id;
        }
        if self.depth > DEPTH_LIMIT || self.graph.fault().is_some() {
            return self.graph.fail(Fault::Growth);
        }
        self.depth += 1;
        let id = self.node(expression, site);
        self.depth -= 1;
        self.known.insert(key, id);
        id
    }

    fn node(&mut self, expression: &Expr, site: usize) -> Id {
        match &**expression {
            Node::Number(value) => self.graph.number(*value),
            Node::Real(value) => self.number(*value),
            Node::Quantity(value, dimension) => self.quantity(*value, dimension),
            Node::Coordinate(index) => self.graph.input(Slot::Coordinate, index + site * self.model.coordinates.len()),
            Node::Field(field) => self.field(*field, site),
            Node::Parameter(parameter) => self.parameter(*parameter),
            Node::Column(column) => self.graph.input(Slot::Column, *column),
            Node::Add(parts) => {
                let parts: Vec<Id> = parts.iter().map(|part| self.lower(part, site)).collect();
                self.graph.add(&parts)
            }
            Node::Mul(parts) => {
                let parts: Vec<Id> = parts.iter().map(|part| self.lower(part, site)).collect();
                self.graph.multiply(&parts)
            }
            Node::Div(a, b) => {
                let (a, b) = (self.lower(a, site), self.lower(b, site));
                self.graph.divide(a, b)
            }
            Node::Pow(base, exponent) => {
                let base = self.lower(base, site);
                self.graph.power(base, *exponent)
            }
            Node::Power(base, exponent) => self.power(base, exponent, site),
            Node::Call(function, x) => {
                let x = self.lower(x, site);
                self.graph.call(*function, x)
            }
            Node::Min(a, b) => {
                let (a, b) = (self.lower(a, site), self.lower(b, site));
                self.graph.min(a, b)
            }
            Node::Max(a, b) => {
                let (a, b) = (self.lower(a, site), self.lower(b, site));
                self.graph.max(a, b)
            }
            Node::Derivative(of, coordinate) => {
                let of = self.lower(of, site);
                let coordinates = self.model.coordinates.len();
                differentiate::derivative(&mut self.graph, &mut self.derivatives, of, *coordinate, coordinates)
            }
            // A pair's partner's partner is the point itself.
            Node::Partner(of) => self.lower(of, 1 - site),
        }
    }

    fn number(&mut self, value: f64) -> Id {
        match exact::from_f64(value) {
            Some(value) => self.graph.number(value),
            None => self.graph.real(value),
        }
    }

    /// Values with a dimension are inputs, because programs run in units of the runtime's own choice.
    fn quantity(&mut self, value: f64, dimension: &Dimension) -> Id {
        if value == 0.0 {
            ZERO
        } else if *dimension == Dimension::default() {
            self.number(value)
        } else {
            self.scalar(Scalar::Literal(value, dimension.clone()))
        }
    }

    /// A scalar input.
    pub fn scalar(&mut self, scalar: Scalar) -> Id {
        let slot = self.scalars.slot(scalar);
        self.graph.input(Slot::Parameter, slot)
    }

    fn parameter(&mut self, parameter: usize) -> Id {
        match self.scene.fixed_parameters.get(parameter).copied().flatten() {
            Some(value) => self.quantity(value, &self.model.parameters[parameter].unit.dimension),
            None => self.scalar(Scalar::Parameter(parameter)),
        }
    }

    fn power(&mut self, base: &Expr, exponent: &Expr, site: usize) -> Id {
        let (base, exponent) = (self.lower(base, site), self.lower(exponent, site));
        if let Some(exponent) = self.graph.exact_constant(exponent) {
            return self.graph.power(base, exponent);
        }
        let logarithm = self.graph.call(Function::Ln, base);
        let scaled = self.graph.multiply(&[exponent, logarithm]);
        self.graph.call(Function::Exp, scaled)
    }

    fn field(&mut self, field: usize, site: usize) -> Id {
        if self.open.contains(&field) {
            return self.graph.fail(Fault::Circular);
        }
        let model = self.model;
        self.open.push(field);
        let id = match self.scene.fixed_fields.get(field).and_then(Option::as_ref) {
            Some(fixed) => self.lower(fixed, site),
            None => {
                let raw = self.bounded(field, site);
                match &model.fields[field].hard {
                    Some(hard) => {
                        let value = self.lower(&hard.value, site);
                        let distance = self.lower(&hard.distance, site);
                        let inside = self.graph.multiply(&[distance, raw]);
                        self.graph.add(&[value, inside])
                    }
                    None => raw,
                }
            }
        };
        self.open.pop();
        id
    }

    /// The network's output, passed through whatever keeps it within its bounds.
    fn bounded(&mut self, field: usize, site: usize) -> Id {
        let declared = &self.model.fields[field];
        let dimension = declared.unit.dimension.clone();
        let operator = Polynomial::one(self.model.coordinates.len());
        let site = Site { partner: site == 1, held: declared.held };
        let raw = self.graph.leaf(Leaf::Jet { field, site, operator });
        match (declared.lower, declared.upper) {
            (None, None) => raw,
            (Some(lower), Some(upper)) => {
                let gate = self.graph.call(Function::Sigmoid, raw);
                let width = self.quantity(upper - lower, &dimension);
                let lower = self.quantity(lower, &dimension);
                let above = self.graph.multiply(&[width, gate]);
                self.graph.add(&[lower, above])
            }
            (Some(bound), None) | (None, Some(bound)) => {
                let sign = if declared.lower.is_some() { ratio(1, 1) } else { ratio(-1, 1) };
                let scale = self.scalar(Scalar::FieldScale(field));
                let softplus = self.graph.call(Function::Softplus, raw);
                let bound = self.quantity(bound, &dimension);
                let away = self.graph.multiply(&[scale, softplus]);
                self.graph.linear(&[(ratio(1, 1), bound), (sign, away)])
            }
        }
    }
}
