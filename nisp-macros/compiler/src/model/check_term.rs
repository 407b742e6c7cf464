//! Terms: conditions, complementarities and clouds, as rows of scalar expressions.

use super::elaborate::Elaborator;
use super::orders::Walker;
use super::value::{Dim, Extent, Reads, Scalar, Value};
use super::{Column, Expr, Field, Node, Role, Term, TermKind, build, cancel};
use crate::error::{Checked, catalogue};
use crate::rational::Rational;
use crate::syntax::{self, Comparison, Condition, ExprKind, Relation, TermBody, print_latex, print_text, real};
use crate::unit::frame::Number;
use crate::unit::{Dimension, Unit};

/// What terms are checked against.
pub(super) struct TermInput<'a, 'e> {
    pub(super) elaborator: &'a mut Elaborator<'e>,
    pub(super) fields: &'a [Field],
    /// The group's columns, to which observations add theirs.
    pub(super) columns: &'a mut Vec<Column>,
}

/// What a term's body comes to.
pub(super) struct Body {
    pub(super) kind: TermKind,
    pub(super) unit: Unit,
    pub(super) equation: String,
    pub(super) latex: String,
}

impl TermInput<'_, '_> {
    pub(super) fn check(&mut self, term: &syntax::Term) -> Checked<Term> {
        let body = match &term.body {
            TermBody::Conditions(conditions) => self.conditions(conditions, term)?,
            TermBody::Observe { value, column, unit } => {
                self.observation(value, column.as_ref(), unit.as_deref(), term)?
            }
            TermBody::Chamfer { point, symmetric, plane } => self.chamfer(point, *symmetric, *plane)?,
        };
        Ok(Term {
            name: term.name.clone(),
            kind: body.kind,
            loss: term.loss,
            weight: term.weight.unwrap_or(1.0),
            within: term.within.as_ref().map(|within| self.within(within, &body.unit)).transpose()?,
            unit: body.unit,
            equation: body.equation,
            latex: body.latex,
            docs: term.docs.clone(),
        })
    }

    /// What rows may be off by, in SI units.
    fn within(&mut self, within: &syntax::Within, of: &Unit) -> Checked<f64> {
        let unit = within.unit.as_deref().cloned().unwrap_or_else(|| Unit::si(Dimension::default()));
        if self.elaborator.units_checked && unit.dimension != of.dimension {
            let message = catalogue::within_unit(&unit.dimension, &of.dimension);
            return Err(self.elaborator.errors.report(within.place, message));
        }
        Ok(unit.factor.of(Number::declared(within.value)).as_si())
    }

    pub(super) fn latex(&self, expr: &syntax::Expr) -> String {
        print_latex(expr, self.elaborator.coordinates.len() == 1)
    }

    fn conditions(&mut self, conditions: &[Condition], term: &syntax::Term) -> Checked<Body> {
        let relations: Vec<&Comparison> = match conditions {
            [Condition::Complementarity(pair)] => return self.complementarity(&pair[0], &pair[1]),
            _ => conditions
                .iter()
                .filter_map(|condition| match condition {
                    Condition::Relation(comparison) => Some(&**comparison),
                    Condition::Complementarity(..) => None,
                })
                .collect(),
        };
        let equality = relations.iter().filter(|relation| relation.relation == Relation::Equal).count();
        let integrals = relations.iter().filter(|relation| integral_side(relation).is_some()).count();
        let mixed = |count: usize| count != 0 && count != relations.len();
        if relations.len() != conditions.len() || mixed(equality) || mixed(integrals) {
            return Err(self.elaborator.errors.report(term.place, catalogue::mixed_conditions()));
        }
        if integrals > 0 {
            return self.integrals(&relations);
        }
        let (mut rows, mut dims) = (Vec::new(), Vec::new());
        let found: Vec<Checked<(Vec<Expr>, Dim)>> =
            relations.iter().map(|relation| self.rows(relation, term.within.is_some())).collect();
        for one in found {
            let (expressions, dim) = one?;
            rows.extend(expressions);
            dims.push(dim);
        }
        let parts: Vec<(&syntax::Expr, &Dim)> = relations.iter().map(|relation| &relation.left).zip(&dims).collect();
        let dim = self.elaborator.agree(&parts, "conditions of one term");
        let kind = if equality > 0 { TermKind::Residual(rows) } else { TermKind::Inequality(rows) };
        Ok(self.body(kind, &dim, &relations))
    }

    pub(super) fn body(&self, kind: TermKind, dim: &Dim, relations: &[&Comparison]) -> Body {
        let join = |parts: Vec<String>| parts.join(", ");
        Body {
            kind,
            unit: self.written(dim),
            equation: join(relations.iter().map(|relation| equation(relation)).collect()),
            latex: join(relations.iter().map(|relation| self.equation_latex(relation)).collect()),
        }
    }

    /// The unit in which rows of a dimension are told: that of a source or a field, as it was written, or SI.
    fn written(&self, dim: &Dim) -> Unit {
        let dimension = dim.known().cloned().unwrap_or_default();
        let of = |role: Role| {
            let mut fields = self.fields.iter().filter(|field| field.role == role && !dimension.is_none());
            fields.find(|field| field.unit.dimension == dimension).map(|field| field.unit.clone())
        };
        of(Role::Source).or_else(|| of(Role::Field)).unwrap_or_else(|| Unit::si(dimension))
    }

    fn equation_latex(&self, relation: &Comparison) -> String {
        let sign = match relation.relation {
            Relation::Equal => "=",
            Relation::AtLeast => r"\ge",
            Relation::AtMost => r"\le",
        };
        format!("{} {sign} {}", self.latex(&relation.left), self.latex(&relation.right))
    }

    /// Both sides' difference, one entry per row, so that inequalities want it non-negative. A belief may be about parameters
    /// alone.
    fn rows(&mut self, relation: &Comparison, is_belief: bool) -> Checked<(Vec<Expr>, Dim)> {
        let (extent, dim, left, right) = self.sides(relation)?;
        let count = match extent {
            Extent::Scalar => 1,
            Extent::Vector(length) => length,
            Extent::Matrix(rows, columns) => rows * columns,
        };
        let entry = |value: &Value, index: usize| -> Scalar {
            value.entries.get(index).filter(|_| !value.is_zero()).cloned().unwrap_or_else(build::zero)
        };
        let rows = (0..count).map(|index| {
            let (left, right) = (entry(&left, index), entry(&right, index));
            match relation.relation {
                Relation::AtMost => build::subtract(&right, &left),
                Relation::Equal | Relation::AtLeast => build::subtract(&left, &right),
            }
        });
        let rows: Vec<Scalar> = rows.collect();
        if !rows.iter().any(|row| row.reads.any(Reads::FIELD.and(Reads::PARAMETER))) {
            let place = relation.left.place.to(relation.right.place);
            return Err(self.elaborator.errors.report(place, catalogue::nothing_to_solve(&equation(relation))));
        }
        if relation.relation == Relation::Equal {
            self.refuse_empty(&rows, relation, is_belief)?;
        }
        Ok((rows.into_iter().map(|row| row.expr).collect(), dim))
    }

    /// Refuses an equation that always holds, that no unknown function is in, or that contradicts a bound.
    fn refuse_empty(&mut self, rows: &[Scalar], relation: &Comparison, is_belief: bool) -> Checked<()> {
        let left: Vec<_> = rows.iter().map(|row| cancel::parts(&row.expr)).collect();
        let mut walker = Walker::default();
        let mut reads_function = |(part, _): &(Expr, Rational)| {
            walker.keep(Expr::clone(part));
            !walker.fields(part).is_empty()
        };
        let text = || equation(relation);
        let message = if left.iter().all(Vec::is_empty) {
            catalogue::holds_always(&text())
        } else if !is_belief && !left.iter().flatten().any(&mut reads_function) {
            catalogue::no_unknown_function(&text())
        } else if let Some(field) = left.iter().find_map(|parts| self.beyond_bound(parts)) {
            catalogue::contradicts_bound(&text(), &self.fields[field].name.text)
        } else {
            return Ok(());
        };
        let place = relation.left.place.to(relation.right.place);
        Err(self.elaborator.errors.report(place, message))
    }

    /// The field that a row sets to a number beyond its bounds.
    fn beyond_bound(&self, parts: &[(Expr, Rational)]) -> Option<usize> {
        let (mut field, mut constant) = (None, 0.0);
        for (part, factor) in parts {
            let factor = real(*factor);
            match **part {
                Node::Field(at) if field.is_none() => field = Some((at, factor)),
                Node::Number(value) => constant += factor * real(value),
                Node::Real(value) | Node::Quantity(value, _) => constant += factor * value,
                _ => return None,
            }
        }
        let (at, factor) = field?;
        let (value, bounds) = (-constant / factor, &self.fields[at]);
        let is_beyond =
            bounds.lower.is_some_and(|lower| value < lower) || bounds.upper.is_some_and(|upper| value > upper);
        is_beyond.then_some(at)
    }

    fn sides(&mut self, relation: &Comparison) -> Checked<(Extent, Dim, Value, Value)> {
        let (left, right) = (self.elaborator.value(&relation.left), self.elaborator.value(&relation.right));
        let (left, right) = (left?, right?);
        let extent = self.elaborator.common_extent(&[(&relation.left, &left), (&relation.right, &right)])?;
        let parts = [(&relation.left, &left.dim), (&relation.right, &right.dim)];
        let dim = self.elaborator.agree(&parts, "sides of one condition");
        Ok((extent, dim, left, right))
    }

    fn complementarity(&mut self, a: &Comparison, b: &Comparison) -> Checked<Body> {
        let (first, second) = (self.positive_part(a), self.positive_part(b));
        let ((a_expr, a_dimension), (b_expr, b_dimension)) = (first?, second?);
        let kind = TermKind::Complementarity { a: a_expr, b: b_expr, a_dimension: a_dimension.clone(), b_dimension };
        Ok(Body {
            kind,
            // Rows compare sides over their natural sizes.
            unit: Unit::si(Dimension::default()),
            equation: format!("{} _|_ {}", equation(a), equation(b)),
            latex: format!(r"{} \perp {}", self.equation_latex(a), self.equation_latex(b)),
        })
    }

    fn positive_part(&mut self, relation: &Comparison) -> Checked<(Expr, Dimension)> {
        if relation.relation == Relation::Equal {
            return Err(self
                .elaborator
                .errors
                .report(relation.relation_place, catalogue::complementarity_of_equation()));
        }
        let (rows, dim) = self.rows(relation, false)?;
        match rows.as_slice() {
            [only] => Ok((only.clone(), dim.known().cloned().unwrap_or_default())),
            _ => {
                let place = relation.left.place.to(relation.right.place);
                Err(self.elaborator.errors.report(place, catalogue::complementarity_of_vectors()))
            }
        }
    }

    fn chamfer(&mut self, point: &syntax::Expr, symmetric: bool, plane: bool) -> Checked<Body> {
        let value = self.elaborator.value(point)?;
        if !matches!(value.extent, Extent::Vector(2..=4)) {
            let message = catalogue::chamfer_of(&value.extent.to_string());
            return Err(self.elaborator.errors.report(point.place, message));
        }
        if !value.reads().any(Reads::FIELD.and(Reads::PARAMETER)) {
            return Err(self.elaborator.errors.report(point.place, catalogue::rigid_surface(&print_text(point))));
        }
        let prefix =
            format!("{}{}chamfer", if symmetric { "symmetric " } else { "" }, if plane { "plane " } else { "" },);
        let arrow = if symmetric { r"\leftrightarrow" } else { r"\leftarrow" };
        let names = match &point.kind {
            ExprKind::List(entries) => entries.iter().map(print_text).collect(),
            _ => Vec::new(),
        };
        let entries = value.entries.into_iter().map(|entry| entry.expr).collect();
        Ok(Body {
            kind: TermKind::Chamfer { point: entries, names, symmetric, plane },
            unit: Unit::si(value.dim.known().cloned().unwrap_or_default()),
            equation: format!("{prefix} {}", print_text(point)),
            latex: format!(r"{} {arrow} \mathrm{{cloud}}", self.latex(point)),
        })
    }
}

/// A comparison as plain text.
pub(super) fn equation(comparison: &Comparison) -> String {
    let sign = match comparison.relation {
        Relation::Equal => "==",
        Relation::AtLeast => ">=",
        Relation::AtMost => "<=",
    };
    format!("{} {sign} {}", print_text(&comparison.left), print_text(&comparison.right))
}

/// If one side is `integral(e)`: e, and the other side.
pub(super) fn integral_side(comparison: &Comparison) -> Option<(&[syntax::Expr], &syntax::Expr)> {
    let arguments = |expr: &'_ syntax::Expr| match &expr.kind {
        ExprKind::Call(name, _) => name.text == "integral",
        _ => false,
    };
    let (call, target) = if arguments(&comparison.left) {
        (&comparison.left, &comparison.right)
    } else if arguments(&comparison.right) {
        (&comparison.right, &comparison.left)
    } else {
        return None;
    };
    match &call.kind {
        ExprKind::Call(_, arguments) => Some((arguments, target)),
        _ => None,
    }
}
