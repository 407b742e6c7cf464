//! Documentation of a module and its scenes, so that it reads like a paper: quantities with units, shapes, bounds and what
//! the user says of them, definitions, equations.

use super::{public, unit_text};
use crate::model::{Definition, Field, Model, Name, Parameter, Part, Role};
use crate::plan::ScenePlan;
use crate::unit::Unit;
use crate::unit::frame::Number;

/// Lines for a module: what it declares and defines.
pub(super) fn quantities(model: &Model) -> Vec<String> {
    let fields = |role: Role| entries(model.fields.iter().filter(move |field| field.role == role).map(field));
    let sections = [
        ("Coordinates", entries(model.coordinates.iter().map(|c| Entry::new(&c.name, &c.unit, &c.docs)))),
        ("Fields", fields(Role::Field)),
        ("Sources", fields(Role::Source)),
        ("Parameters", entries(model.parameters.iter().map(parameter))),
        ("Constants", model.constants.iter().map(definition).collect()),
        ("Definitions", model.definitions.iter().map(definition).collect()),
    ];
    sections.into_iter().flat_map(|(title, lines)| section(title, lines)).collect()
}

/// Lines for a scene: its equations, and what their groups define.
pub(super) fn equations(model: &Model, scene: &ScenePlan) -> Vec<String> {
    let mut lines = Vec::new();
    for plan in public(model, scene) {
        let group = &model.groups[plan.group];
        let name = &group.name.text;
        for term in plan.terms.iter().map(|term| &group.terms[term.term]) {
            let (unit, docs) = (unit_text(&term.unit), comment(&term.docs));
            lines.push(format!(" - on `{name}`, `{}`: `{}` \\[{unit}\\]{docs}", term.name.text, term.equation));
        }
        lines.extend(group.definitions.iter().map(|found| format!("{}, on `{name}`", definition(found))));
    }
    section("Equations", lines)
}

fn section(title: &str, mut lines: Vec<String>) -> Vec<String> {
    if !lines.is_empty() {
        lines.splice(0..0, [String::new(), format!(" # {title}"), String::new()]);
    }
    lines
}

/// A declared scalar, or a component of a vector.
struct Entry<'a> {
    name: &'a Name,
    unit: &'a Unit,
    part: Option<&'a Part>,
    /// Bounds and the like.
    remarks: Vec<String>,
    docs: &'a [String],
}

impl<'a> Entry<'a> {
    fn new(name: &'a Name, unit: &'a Unit, docs: &'a [String]) -> Self {
        Self { name, unit, part: None, remarks: Vec::new(), docs }
    }
}

fn field(field: &Field) -> Entry<'_> {
    let mut remarks: Vec<String> = bounds(field.lower, field.upper, &field.unit).into_iter().collect();
    if let Some([value, distance]) = field.hard.as_ref().map(|hard| &hard.text) {
        remarks.push(format!("`{value}` where `{distance}` is zero, by construction"));
    }
    Entry { part: field.part.as_ref(), remarks, ..Entry::new(&field.name, &field.unit, &field.docs) }
}

fn parameter(parameter: &Parameter) -> Entry<'_> {
    let unit = &parameter.unit;
    let mut remarks: Vec<String> = bounds(parameter.lower, parameter.upper, unit).into_iter().collect();
    remarks.extend(parameter.default.map(|value| format!("{} unless given", in_unit(value, unit))));
    Entry { part: parameter.part.as_ref(), remarks, ..Entry::new(&parameter.name, unit, &parameter.docs) }
}

fn bounds(lower: Option<f64>, upper: Option<f64>, unit: &Unit) -> Option<String> {
    match (lower, upper) {
        (None, None) => None,
        (Some(low), None) => Some(format!("at least {}", in_unit(low, unit))),
        (None, Some(high)) => Some(format!("at most {}", in_unit(high, unit))),
        (Some(low), Some(high)) => Some(format!("{} to {}", in_unit(low, unit), in_unit(high, unit))),
    }
}

/// A value in SI units as a number in the declared one, without the last digits that conversion spoils.
pub(super) fn in_unit(value: f64, unit: &Unit) -> f64 {
    let converted = unit.factor.back(Number::si(value)).as_declared();
    format!("{converted:.12e}").parse().unwrap_or(converted)
}

/// One line for each scalar, and one for all components of a vector.
fn entries<'a>(all: impl Iterator<Item = Entry<'a>>) -> Vec<String> {
    let all: Vec<Entry<'_>> = all.collect();
    let first = |(_, entry): &(usize, &Entry<'_>)| entry.part.is_none_or(|part| part.index == 0);
    let line = |(at, entry): (usize, &Entry<'_>)| {
        let (unit, docs) = (unit_text(entry.unit), comment(entry.docs));
        let (name, shape) = match entry.part {
            None => (&entry.name.text, remarks(entry)),
            Some(part) => {
                let components = &all[at..][..part.count];
                let component = |entry: &Entry<'_>| format!("`{}`{}", entry.name.text, remarks(entry));
                let parts: Vec<String> = components.iter().map(component).collect();
                (&part.of.text, format!(", a vector of {}: {}", part.count, parts.join("; ")))
            }
        };
        format!(" - `{name}` \\[{unit}\\]{docs}{shape}")
    };
    all.iter().enumerate().filter(first).map(line).collect()
}

fn remarks(entry: &Entry<'_>) -> String {
    entry.remarks.iter().map(|remark| format!(", {remark}")).collect()
}

fn definition(definition: &Definition) -> String {
    let Definition { name, text, unit, shape, docs, .. } = definition;
    let shape = if shape.is_empty() { String::new() } else { format!(", {shape}") };
    format!(" - `{}` = `{text}` \\[{}\\]{}{shape}", name.text, unit_text(unit), comment(docs))
}

/// A doc comment on one line, behind a space.
pub(super) fn comment(docs: &[String]) -> String {
    docs.iter().map(|line| format!(" {}", line.trim())).collect()
}
