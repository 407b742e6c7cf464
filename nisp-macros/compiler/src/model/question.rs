//! What is asked of an answer: any expression in the names of the module.

use super::elaborate::Elaborator;
use super::value::{Extent, Scalar, Value};
use super::{Model, Node, Question};
use crate::syntax::{Expr, print_text};
use crate::unit::Unit;

/// One question for every component of every expression. What is wrong with them is reported.
pub(super) fn check(asked: &[Expr], elaborator: &mut Elaborator<'_>, model: &Model) -> Vec<Question> {
    let mut questions: Vec<Question> = Vec::new();
    for expr in asked {
        let Ok(value) = elaborator.value(expr) else { continue };
        for (at, entry) in value.entries.iter().enumerate() {
            let question = question(expr, (&value, at, entry), elaborator, model);
            if questions.iter().all(|other| other.name != question.name) {
                questions.push(question);
            }
        }
    }
    questions
}

/// A component of an expression. Fields and parameters alone keep their names and declared units; everything else is in SI units,
/// written as in the module where it declares one of them.
fn question(
    expr: &Expr,
    (value, at, entry): (&Value, usize, &Scalar),
    elaborator: &Elaborator<'_>,
    model: &Model,
) -> Question {
    let (name, unit) = match *entry.expr {
        Node::Field(field) => (model.fields[field].name.text.clone(), model.fields[field].unit.clone()),
        Node::Parameter(of) => (model.parameters[of].name.text.clone(), model.parameters[of].unit.clone()),
        _ => {
            let unit = Unit::si(value.dim.known().cloned().unwrap_or_default());
            let declared =
                model.fields.iter().map(|field| &field.unit).chain(model.parameters.iter().map(|of| &of.unit));
            let written =
                declared.into_iter().find(|own| own.dimension == unit.dimension && own.factor.factor() == 1.0);
            let unit = written.filter(|own| !own.dimension.is_none()).cloned().unwrap_or(unit);
            (print_text(expr) + &component(value.extent, at, elaborator), unit)
        }
    };
    Question { name, unit, expr: entry.expr.clone(), span: expr.place.start }
}

/// What is written behind the name of a vector or matrix for one of its entries: `_x`, `_x_y`, or numbers from 1 where there
/// are not as many as spatial coordinates.
fn component(extent: Extent, at: usize, elaborator: &Elaborator<'_>) -> String {
    let along = |index: usize, count: usize| match elaborator.spatial.get(index) {
        Some(&axis) if elaborator.spatial.len() == count => format!("_{}", elaborator.coordinates[axis].name.text),
        _ => format!("_{}", index + 1),
    };
    match extent {
        Extent::Scalar => String::new(),
        Extent::Vector(length) => along(at, length),
        Extent::Matrix(rows, columns) => along(at / columns, rows) + &along(at % columns, columns),
    }
}
