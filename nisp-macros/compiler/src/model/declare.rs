//! Declarations: coordinates, fields, sources, parameters and constants get their numbers and units.

use super::build;
use super::components::{add_components, add_symbol, components, part, shaped};
use super::constant::{Constant, in_unit};
use super::elaborate::Elaborator;
use super::scope::{Meaning, Symbol};
use super::value::{Dim, Reads, Scalar, Value};
use super::{Coordinate, Definition, Field, Model, Name, Node, Parameter, Role};
use crate::error::{Checked, catalogue};
use crate::syntax::{Declaration, Expr, ExprKind, Kind, Module, Shape, print_latex, print_text};
use crate::unit::frame::Scale;
use crate::unit::{Dimension, Unit};

/// Declares everything a module declares outside its groups.
pub(super) fn declare(module: &Module, elaborator: &mut Elaborator<'_>, model: &mut Model) {
    module.declarations.iter().filter_map(|declaration| declaration.unit.as_ref()).for_each(|unit| {
        let base = unit.dimension.to_string();
        let is_compound = base.contains([' ', '/', '^']);
        if is_compound && unit.factor == Scale::new(1.0) && unit.text.len() <= base.len() && unit.text != base {
            elaborator.errors.write_unit(format!("[{base}]"), format!("[{}]", unit.text));
        }
    });
    // In this order, because vectors have one component for each spatial coordinate, and sources come after fields.
    for kind in [Kind::Coordinate, Kind::Constant, Kind::Parameter, Kind::Field, Kind::Source] {
        for declaration in module.declarations.iter().filter(|declaration| declaration.kind == kind) {
            // A name that is taken was reported; the rest is declared all the same.
            match kind {
                Kind::Coordinate => drop(coordinate(declaration, elaborator, model)),
                Kind::Constant => drop(constant(declaration, elaborator, model)),
                Kind::Parameter => parameter(declaration, elaborator, model),
                _ => field(declaration, elaborator, model),
            }
        }
        if kind == Kind::Coordinate {
            let times = module.declarations.iter().filter(|declaration| declaration.shape == Shape::Time);
            let times: Vec<&str> = times.map(|declaration| declaration.name.text.as_str()).collect();
            elaborator.spatial = spatial(&model.coordinates, &times);
            elaborator.coordinates = model.coordinates.clone();
        }
    }
    if elaborator.errors.found_any() {
        // A declaration that could not be read is no missing one.
        return;
    }
    if model.coordinates.is_empty() {
        elaborator.errors.push(module.name.span, catalogue::nothing_declared("coordinates", "coordinates: x [m];"));
    }
    if model.fields.is_empty() {
        elaborator.errors.push(module.name.span, catalogue::nothing_declared("fields", "fields: u [m];"));
    }
}

/// The coordinates of space: lengths if there are any, else those with the first one's dimension; never one marked
/// `time`.
fn spatial(coordinates: &[Coordinate], times: &[&str]) -> Vec<usize> {
    let candidates: Vec<usize> =
        (0..coordinates.len()).filter(|&index| !times.contains(&coordinates[index].name.text.as_str())).collect();
    let dimension = |index: usize| &coordinates[index].unit.dimension;
    let lengths = candidates.iter().any(|&index| *dimension(index) == Dimension::length());
    let Some(&first) = candidates.first() else { return Vec::new() };
    let wanted = if lengths { Dimension::length() } else { dimension(first).clone() };
    candidates.into_iter().filter(|&index| *dimension(index) == wanted).collect()
}

/// The unit of a declaration; what could not be read counts as a pure number and compares with everything.
pub(super) fn unit_and_dim(declaration: &Declaration, elaborator: &Elaborator<'_>) -> (Unit, Dim) {
    match &declaration.unit {
        Some(unit) => (unit.clone(), elaborator.dim(&unit.dimension)),
        None => (Unit::one(), Dim::Unknown),
    }
}

fn coordinate(declaration: &Declaration, elaborator: &mut Elaborator<'_>, model: &mut Model) -> Checked<()> {
    let (unit, dim) = unit_and_dim(declaration, elaborator);
    let index = model.coordinates.len();
    let scalar = Scalar::leaf(Node::Coordinate(index), Reads::COORDINATE);
    add_symbol(elaborator, &declaration.name, Meaning::Coordinate, index, Value::scalar(scalar, dim))?;
    model.coordinates.push(Coordinate { name: declaration.name.clone(), unit, docs: declaration.docs.clone() });
    Ok(())
}

fn constant(declaration: &Declaration, elaborator: &mut Elaborator<'_>, model: &mut Model) -> Checked<()> {
    let (unit, dim) = unit_and_dim(declaration, elaborator);
    let Some(expr) = &declaration.value else {
        let message = catalogue::constant_without_value(&declaration.name.text);
        let reported = elaborator.errors.report(declaration.name.span, message);
        elaborator.scope.broken.insert(declaration.name.text.clone());
        return Err(reported);
    };
    model.constants.push(Definition {
        name: declaration.name.clone(),
        text: print_text(expr),
        latex: print_definition(&declaration.name.text, expr, elaborator),
        unit: unit.clone(),
        shape: String::new(),
        docs: declaration.docs.clone(),
    });
    let found = in_unit(expr, &unit, elaborator);
    let value = found.ok().and_then(|constants| constants.into_iter().next()).map(|Constant { value, exact }| {
        let scalar = match exact.filter(|_| unit.dimension.is_none() && unit.factor == Scale::new(1.0)) {
            Some(exact) => Scalar::number(exact),
            None if unit.dimension.is_none() || !elaborator.units_checked => build::real(value.as_si()),
            None => Scalar::leaf(Node::Quantity(value.as_si(), unit.dimension.clone()), Reads::default()),
        };
        Value::scalar(scalar, dim)
    });
    let symbol =
        Symbol { meaning: Meaning::Constant, value, span: declaration.name.span, index: 0, parent: None, used: false };
    elaborator.scope.declare(&declaration.name, symbol, elaborator.errors)
}

fn parameter(declaration: &Declaration, elaborator: &mut Elaborator<'_>, model: &mut Model) {
    let (unit, dim) = unit_and_dim(declaration, elaborator);
    let names = components(declaration, elaborator);
    let first = model.parameters.len();
    let entries = (0..names.len()).map(|k| Scalar::leaf(Node::Parameter(first + k), Reads::PARAMETER)).collect();
    // Numbered even if a name is taken, which was reported: what else was declared keeps its number.
    let _ =
        add_components(elaborator, declaration, Meaning::Parameter, first, &names, shaped(declaration, entries, dim));
    let default = each(declaration.value.as_ref(), names.len(), &unit, elaborator);
    let mut lower = each(declaration.lower.as_ref(), names.len(), &unit, elaborator);
    let mut upper = each(declaration.upper.as_ref(), names.len(), &unit, elaborator);
    // A bound that is left out is the next number.
    if declaration.above {
        lower.iter_mut().flatten().for_each(|low| *low = low.next_up());
    }
    if declaration.below {
        upper.iter_mut().flatten().for_each(|high| *high = high.next_down());
    }
    let spread = spreads(declaration.spread.as_ref(), &declaration.name, names.len(), &unit, elaborator);
    let count = names.len();
    for (k, name) in names.into_iter().enumerate() {
        let (lower, upper, default, spread) = (lower[k], upper[k], default[k], spread[k]);
        check_order(declaration, lower, upper, elaborator);
        let outside = |value: f64| lower.is_some_and(|low| value < low) || upper.is_some_and(|high| value > high);
        if let (Some(expr), true) = (&declaration.value, default.is_some_and(outside)) {
            elaborator.errors.push(expr.place, catalogue::outside_bounds(&name.text));
        }
        let docs = declaration.docs.clone();
        model.parameters.push(Parameter {
            name,
            unit: unit.clone(),
            default,
            lower,
            upper,
            part: part(declaration, k, count),
            spread,
            docs,
        });
    }
}

fn field(declaration: &Declaration, elaborator: &mut Elaborator<'_>, model: &mut Model) {
    let (unit, dim) = unit_and_dim(declaration, elaborator);
    let (role, meaning) = match declaration.kind {
        Kind::Source => (Role::Source, Meaning::Source),
        _ => (Role::Field, Meaning::Field),
    };
    let held = held(declaration, elaborator);
    let names = components(declaration, elaborator);
    let first = model.fields.len();
    let entries = (0..names.len()).map(|k| Scalar::leaf(Node::Field(first + k), Reads::FIELD)).collect();
    // Numbered even if a name is taken, which was reported: what else was declared keeps its number.
    let _ = add_components(elaborator, declaration, meaning, first, &names, shaped(declaration, entries, dim));
    let lower = each(declaration.lower.as_ref(), names.len(), &unit, elaborator);
    let upper = each(declaration.upper.as_ref(), names.len(), &unit, elaborator);
    let count = names.len();
    for (k, name) in names.into_iter().enumerate() {
        let (lower, upper) = (lower[k], upper[k]);
        check_order(declaration, lower, upper, elaborator);
        let docs = declaration.docs.clone();
        let part = part(declaration, k, count);
        model.fields.push(Field { name, role, unit: unit.clone(), held, lower, upper, hard: None, part, docs });
    }
}

/// A bit for each coordinate that a field does not depend on.
fn held(declaration: &Declaration, elaborator: &mut Elaborator<'_>) -> u32 {
    let Some(names) = &declaration.depends else { return 0 };
    if names.is_empty() {
        let message = catalogue::depends_on_no_coordinate(&declaration.name.text);
        elaborator.errors.push(declaration.name.span, message);
    }
    let mut held = (1 << elaborator.coordinates.len()) - 1;
    for name in names {
        match elaborator.coordinates.iter().position(|coordinate| coordinate.name.text == name.text) {
            Some(at) => {
                held &= !(1 << at);
                elaborator.scope.mark_used(&name.text);
            }
            None => {
                let all: Vec<&str> = elaborator.coordinates.iter().map(|c| c.name.text.as_str()).collect();
                let found = elaborator.scope.find(&name.text).map(|symbol| symbol.meaning);
                let message = match found {
                    Some(Meaning::Field | Meaning::Source) => {
                        catalogue::depends_on_a_field(&declaration.name.text, &name.text)
                    }
                    _ => catalogue::not_a_coordinate(&name.text, &all),
                };
                elaborator.errors.push(name.span, message);
            }
        }
    }
    held
}

fn check_order(declaration: &Declaration, lower: Option<f64>, upper: Option<f64>, elaborator: &mut Elaborator<'_>) {
    if let (Some(expr), Some(low), Some(high)) = (&declaration.upper, lower, upper)
        && low >= high
    {
        elaborator.errors.push(expr.place, catalogue::empty_interval());
    }
}

/// How far each component is believed to be from its value: positive numbers.
pub(super) fn spreads(
    expr: Option<&Expr>,
    name: &Name,
    count: usize,
    unit: &Unit,
    elaborator: &mut Elaborator<'_>,
) -> Vec<Option<f64>> {
    let spreads = each(expr, count, unit, elaborator);
    if let (Some(expr), true) = (expr, spreads.iter().flatten().any(|spread| *spread <= 0.0)) {
        elaborator.errors.push(expr.place, catalogue::spread_not_positive(&name.text));
    }
    spreads
}

/// One value for each component: of a vector as written, of a scalar for all alike.
fn each(expr: Option<&Expr>, count: usize, unit: &Unit, elaborator: &mut Elaborator<'_>) -> Vec<Option<f64>> {
    let Some(expr) = expr else { return vec![None; count] };
    match in_unit(expr, unit, elaborator) {
        Err(_) => vec![None; count],
        Ok(values) if values.len() == count => {
            values.into_iter().map(|constant| Some(constant.value.as_si())).collect()
        }
        Ok(values) if values.len() == 1 => vec![Some(values[0].value.as_si()); count],
        Ok(values) => {
            elaborator.errors.push(expr.place, catalogue::wrong_number_of_values(count, values.len()));
            vec![None; count]
        }
    }
}

/// `name = value` as LaTeX.
pub(super) fn print_definition(name: &str, value: &Expr, elaborator: &Elaborator<'_>) -> String {
    let ordinary = elaborator.coordinates.len() == 1;
    let name = Expr { kind: ExprKind::Name(name.into()), place: value.place };
    format!("{} = {}", print_latex(&name, ordinary), print_latex(value, ordinary))
}
