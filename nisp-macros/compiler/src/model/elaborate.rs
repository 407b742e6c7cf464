//! From expressions as written to scalar expressions: names resolved, shapes and units checked.

use super::scope::Scope;
use super::value::{DEEPEST, Dim, LARGEST, Reads, Scalar, Value};
use super::{Coordinate, Node, build};
use crate::error::{Checked, Errors, Place, catalogue};
use crate::syntax::{Expr, ExprKind, Number, print_text};
use crate::unit::frame::{self, Scale};
use crate::unit::{Dimension, Unit};

/// What expressions are read against, and where mistakes go.
pub(super) struct Elaborator<'e> {
    pub(super) errors: &'e mut Errors,
    pub(super) scope: Scope,
    pub(super) coordinates: Vec<Coordinate>,
    /// The coordinates over which `grad` and its like run.
    pub(super) spatial: Vec<usize>,
    pub(super) units_checked: bool,
    /// True inside `on NAME pairs`.
    pub(super) paired: bool,
    pub(super) warnings: Vec<(String, proc_macro2::Span)>,
}

impl<'e> Elaborator<'e> {
    pub(super) fn new(errors: &'e mut Errors, units_checked: bool) -> Self {
        Self {
            errors,
            scope: Scope::default(),
            coordinates: Vec::new(),
            spatial: Vec::new(),
            units_checked,
            paired: false,
            warnings: Vec::new(),
        }
    }

    /// A dimension, or nothing to compare with if units are off.
    pub(super) fn dim(&self, dimension: &Dimension) -> Dim {
        if self.units_checked { Dim::Known(dimension.clone()) } else { Dim::Unknown }
    }

    /// Checks an expression and writes it in scalars.
    pub(super) fn value(&mut self, expr: &Expr) -> Checked<Value> {
        let value = match &expr.kind {
            ExprKind::Number(number, unit) => Ok(self.number(number, unit.as_deref())),
            ExprKind::Name(name) => self.name(name, expr.place),
            ExprKind::Negate(inner) => {
                let inner = self.value(inner)?;
                Ok(inner.map(inner.dim.clone(), build::negate))
            }
            ExprKind::Sum(terms) => self.sum(terms),
            ExprKind::Product(factors) => self.product(factors, expr.place),
            ExprKind::Power(base, exponent) => self.power(base, exponent, expr.place),
            ExprKind::Call(name, arguments) => self.call(name, arguments, expr.place),
            ExprKind::List(entries) => self.list(entries, expr.place),
            ExprKind::Index(base, indices) => self.index(base, indices, expr.place),
        }?;
        if value.entries.iter().any(|entry| entry.size > LARGEST) {
            return Err(self.errors.report(expr.place, catalogue::expression_too_large(LARGEST)));
        }
        if value.entries.iter().any(|entry| entry.depth > DEEPEST) {
            return Err(self.errors.report(expr.place, catalogue::expression_too_deep(DEEPEST)));
        }
        Ok(value)
    }

    /// As `value`, where only a scalar will do.
    pub(super) fn scalar(&mut self, expr: &Expr, what: &str) -> Checked<(Scalar, Dim)> {
        let value = self.value(expr)?;
        match value.as_scalar() {
            Some(scalar) => Ok((scalar.clone(), value.dim.clone())),
            None => {
                let message = catalogue::expected_scalar(what, &print_text(expr), &value.extent.to_string());
                Err(self.errors.report(expr.place, message))
            }
        }
    }

    /// As `scalar`, where it must be a pure number as well.
    pub(super) fn pure(&mut self, expr: &Expr, what: &str) -> Checked<Scalar> {
        let (scalar, dim) = self.scalar(expr, what)?;
        self.require_pure(expr, &dim, what)?;
        Ok(scalar)
    }

    pub(super) fn require_pure(&mut self, expr: &Expr, dim: &Dim, what: &str) -> Checked<()> {
        let Some(dimension) = dim.known().filter(|dimension| !dimension.is_none()) else { return Ok(()) };
        let (text, dimension) = (print_text(expr), dimension.clone());
        let hint = self.units_within(expr);
        Err(self.errors.report(expr.place, catalogue::not_dimensionless(what, &text, &dimension, &hint)))
    }

    fn number(&mut self, number: &Number, unit: Option<&Unit>) -> Value {
        let exact = number.exact.filter(|_| unit.is_none_or(|unit| unit.factor == Scale::new(1.0)));
        let value = unit.map_or(number.value, |unit| unit.factor.of(frame::Number::declared(number.value)).as_si());
        let dimension = unit.map(|unit| unit.dimension.clone()).filter(|_| self.units_checked).unwrap_or_default();
        let node = match exact {
            Some(exact) if dimension.is_none() => Node::Number(exact),
            _ if dimension.is_none() => Node::Real(value),
            _ => Node::Quantity(value, dimension.clone()),
        };
        let scalar = Scalar::leaf(node, Reads::default());
        let dim = if scalar.is_zero() { Dim::Any } else { self.dim(&dimension) };
        Value::scalar(scalar, dim)
    }

    /// `[a, b, c]`, or a matrix if the entries are vectors.
    fn list(&mut self, entries: &[Expr], place: Place) -> Checked<Value> {
        if entries.is_empty() || entries.len() > 9 {
            return Err(self.errors.report(place, catalogue::bad_list_length(entries.len())));
        }
        let values = self.all(entries)?;
        let parts: Vec<(&Expr, &Dim)> = entries.iter().zip(values.iter().map(|value| &value.dim)).collect();
        let dim = self.agree(&parts, "entries of one vector");
        let extent = values[0].extent;
        if let Some((entry, value)) = entries.iter().zip(&values).find(|(_, value)| value.extent != extent) {
            let message = catalogue::uneven_entries(&extent.to_string(), &print_text(entry), &value.extent.to_string());
            return Err(self.errors.report(entry.place, message));
        }
        let scalars: Vec<Scalar> = values.iter().flat_map(|value| value.entries.clone()).collect();
        match extent {
            super::value::Extent::Scalar => Ok(Value::vector(scalars, dim)),
            super::value::Extent::Vector(length) => {
                let extent = super::value::Extent::Matrix(entries.len(), length);
                Ok(Value { extent, dim, entries: scalars })
            }
            super::value::Extent::Matrix(..) => Err(self.errors.report(place, catalogue::too_many_brackets())),
        }
    }

    /// All of several expressions, each of their mistakes reported.
    pub(super) fn all(&mut self, expressions: &[Expr]) -> Checked<Vec<Value>> {
        let values: Vec<Checked<Value>> = expressions.iter().map(|expr| self.value(expr)).collect();
        values.into_iter().collect()
    }

    /// The names in an expression with their units, to find a wrong one by.
    pub(super) fn units_within(&self, expr: &Expr) -> Vec<(String, Dimension)> {
        let mut found: Vec<(String, Dimension)> = Vec::new();
        let mut open = vec![expr];
        while let Some(expr) = open.pop() {
            match &expr.kind {
                ExprKind::Name(name) => {
                    let dim = self.scope.find(name).and_then(|symbol| symbol.value.as_ref()).map(|value| &value.dim);
                    let known = dim.and_then(Dim::known);
                    if let Some(dimension) = known.filter(|_| found.iter().all(|(other, _)| other != name)) {
                        found.push((name.clone(), dimension.clone()));
                    }
                }
                ExprKind::Number(..) => {}
                ExprKind::Negate(inner) => open.push(inner),
                ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                    open.extend(parts.iter().rev().map(|(_, part)| part))
                }
                ExprKind::Power(base, exponent) => open.extend([&**exponent, &**base]),
                ExprKind::Call(_, parts) | ExprKind::List(parts) => open.extend(parts.iter().rev()),
                ExprKind::Index(base, _) => open.push(base),
            }
        }
        found
    }
}
