//! Observations: `observe q;` and `observe tip: q + l * sin(psi) ~ tip_q [m];`

use super::check_term::{Body, TermInput};
use super::scope::{Meaning, Symbol};
use super::value::{Extent, Reads, Scalar, Value};
use super::{Column, Name, Node, Part, TermKind, build};
use crate::error::{Checked, catalogue};
use crate::syntax::{self, Expr, print_text};
use crate::unit::Unit;

impl TermInput<'_, '_> {
    pub(super) fn observation(
        &mut self,
        expr: &Expr,
        column: Option<&Name>,
        unit: Option<&Unit>,
        term: &syntax::Term,
    ) -> Checked<Body> {
        let value = self.elaborator.value(expr)?;
        if !value.reads().any(Reads::FIELD.and(Reads::PARAMETER)) {
            let message = catalogue::nothing_to_observe(&print_text(expr));
            return Err(self.elaborator.errors.report(expr.place, message));
        }
        let (measured, unit) = match column {
            None => self.own_columns(&term.name, &value)?,
            Some(name) => self.named_column(name, unit, expr, &value)?,
        };
        let rows = value.entries.iter().zip(&measured).map(|(entry, column)| build::subtract(entry, column).expr);
        let columns = measured.iter().filter_map(|column| match *column.expr {
            Node::Column(at) => Some(at),
            _ => None,
        });
        let column_text = column.map_or(term.name.text.as_str(), |name| name.text.as_str());
        let observed = if column.is_none() { "measured" } else { column_text };
        Ok(Body {
            kind: TermKind::Observation { rows: rows.collect(), columns: columns.collect() },
            unit,
            equation: format!("{} ~ {observed}", print_text(expr)),
            latex: format!(r"{} \sim \mathrm{{{}}}", self.latex(expr), observed.replace('_', r"\_")),
        })
    }

    /// Columns named like what is observed, with the field's own unit.
    fn own_columns(&mut self, name: &Name, value: &Value) -> Checked<(Vec<Scalar>, Unit)> {
        let symbol = self.elaborator.scope.find(&name.text);
        if symbol.is_some_and(|symbol| symbol.meaning == Meaning::Parameter) {
            return Err(self.elaborator.errors.report(name.span, catalogue::observed_parameter(&name.text)));
        }
        let field = symbol.filter(|symbol| matches!(symbol.meaning, Meaning::Field | Meaning::Source));
        let unit = match field.and_then(|symbol| self.fields.get(symbol.index)) {
            Some(field) => field.unit.clone(),
            None => Unit::si(value.dim.known().cloned().unwrap_or_default()),
        };
        let measured = self.add_columns(name, &unit, value)?;
        Ok((measured, unit))
    }

    /// A column declared in the group, or one that this observation declares.
    fn named_column(
        &mut self,
        name: &Name,
        unit: Option<&Unit>,
        expr: &Expr,
        value: &Value,
    ) -> Checked<(Vec<Scalar>, Unit)> {
        let errors = &mut *self.elaborator.errors;
        if self.elaborator.scope.broken.contains(&name.text) {
            return Err(crate::error::Reported);
        }
        let declared = self.elaborator.scope.find(&name.text).filter(|symbol| symbol.meaning == Meaning::Column);
        let Some(column) = declared.and_then(|symbol| symbol.value.clone()) else {
            let si = Unit::si(value.dim.known().cloned().unwrap_or_default());
            let unit = unit.cloned().unwrap_or(si);
            if self.elaborator.units_checked && !value.dim.fits(&unit.dimension) {
                let found = value.dim.known().cloned().unwrap_or_default();
                let message = catalogue::observed_unit((&print_text(expr), &found), (&name.text, &unit.dimension));
                return Err(errors.report(name.span, message));
            }
            let measured = self.add_columns(name, &unit, value)?;
            self.declare_column(name, &measured, value)?;
            return Ok((measured, unit));
        };
        if unit.is_some() {
            return Err(errors.report(name.span, catalogue::column_has_unit(&name.text)));
        }
        self.elaborator.scope.mark_used(&name.text);
        let column_expr = Expr { kind: syntax::ExprKind::Name(name.text.clone()), place: name.span.into() };
        self.elaborator.common_extent(&[(expr, value), (&column_expr, &column)])?;
        let dim = self.elaborator.agree(&[(expr, &value.dim), (&column_expr, &column.dim)], "sides of an observation");
        let index = self.elaborator.scope.find(&name.text).map(|symbol| symbol.index);
        let unit = index.and_then(|index| self.columns.get(index)).map(|column| column.unit.clone());
        let unit = unit.unwrap_or_else(|| Unit::si(dim.known().cloned().unwrap_or_default()));
        Ok((column.entries, unit))
    }

    /// Makes a column that an observation declared usable by name, unless a field already has that name.
    fn declare_column(&mut self, name: &Name, measured: &[Scalar], value: &Value) -> Checked<()> {
        if self.elaborator.scope.find(&name.text).is_some() {
            return Ok(());
        }
        let index = self.columns.len() - measured.len();
        let column = Value { extent: value.extent, dim: value.dim.clone(), entries: measured.to_vec() };
        let symbol =
            Symbol { meaning: Meaning::Column, value: Some(column), span: name.span, index, parent: None, used: true };
        self.elaborator.scope.declare(name, symbol, self.elaborator.errors)
    }

    fn add_columns(&mut self, name: &Name, unit: &Unit, value: &Value) -> Checked<Vec<Scalar>> {
        let count = value.entries.len();
        let spatial = &self.elaborator.spatial;
        let mut measured = Vec::with_capacity(count);
        for component in 0..count {
            let text = match value.extent {
                Extent::Scalar => name.text.clone(),
                Extent::Vector(length) if length == spatial.len() => {
                    format!("{}_{}", name.text, self.elaborator.coordinates[spatial[component]].name.text)
                }
                _ => format!("{}_{}", name.text, component + 1),
            };
            if self.columns.iter().any(|column| column.name.text == text) {
                return Err(self.elaborator.errors.report(name.span, catalogue::column_twice(&text)));
            }
            measured.push(Scalar::leaf(Node::Column(self.columns.len()), Reads::COLUMN));
            let part = Part { of: name.clone(), index: component, count };
            self.columns.push(Column {
                name: Name { text, span: name.span },
                unit: unit.clone(),
                part: (value.extent != Extent::Scalar).then_some(part),
                docs: Vec::new(),
            });
        }
        Ok(measured)
    }
}
