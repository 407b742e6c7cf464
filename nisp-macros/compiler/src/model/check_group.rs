//! Groups of points: their columns, definitions and terms.

use super::check_term::TermInput;
use super::components::{add_components, components, part, shaped};
use super::declare::{print_definition, unit_and_dim};
use super::elaborate::Elaborator;
use super::scope::{Meaning, Symbol};
use super::value::{Extent, Reads, Scalar};
use super::{Column, Definition, Field, Group, Node, Term};
use crate::error::catalogue;
use crate::syntax::{self, Declaration, GroupItem, Let, print_text};
use crate::unit::Unit;

/// A group's and its terms' names, those of broken ones too, for scenes to refer to.
pub(super) struct GroupNames {
    pub(super) name: String,
    /// Each term's name and its number among the sound ones.
    pub(super) terms: Vec<(String, Option<usize>)>,
}

/// Checks a group.
pub(super) fn check(group: &syntax::Group, elaborator: &mut Elaborator<'_>, fields: &[Field]) -> (Group, GroupNames) {
    elaborator.scope.enter_group();
    elaborator.paired = group.paired;
    let mut checked = Group {
        name: group.name.clone(),
        definitions: Vec::new(),
        columns: Vec::new(),
        terms: Vec::new(),
        place: None,
        paired: group.paired,
        docs: group.docs.clone(),
    };
    let mut names = GroupNames { name: group.name.text.clone(), terms: Vec::new() };
    // Columns first, so that their numbers do not depend on where in the group they are declared.
    for item in &group.items {
        if let GroupItem::Column(declaration) = item {
            column(declaration, elaborator, &mut checked.columns);
        }
    }
    for item in &group.items {
        match item {
            GroupItem::Column(_) => {}
            GroupItem::Let(definition) => checked.definitions.extend(define(definition, elaborator)),
            GroupItem::Broken(name) => names.terms.push((name.text.clone(), None)),
            GroupItem::Term(term) => {
                let number = term_of(term, elaborator, fields, &mut checked, &names);
                names.terms.push((term.name.text.clone(), number));
            }
        }
    }
    let unused = elaborator.scope.leave_group();
    for (name, symbol) in unused.iter().filter(|(_, symbol)| !symbol.used && symbol.parent.is_none()) {
        elaborator.warnings.push((catalogue::unused(symbol.meaning.noun(), name), symbol.span));
    }
    elaborator.paired = false;
    if group.items.is_empty() {
        elaborator.warnings.push((catalogue::empty_group(&group.name.text), group.name.span));
    }
    (checked, names)
}

fn term_of(
    term: &syntax::Term,
    elaborator: &mut Elaborator<'_>,
    fields: &[Field],
    group: &mut Group,
    names: &GroupNames,
) -> Option<usize> {
    if names.terms.iter().any(|(name, _)| *name == term.name.text) {
        elaborator.errors.push(term.name.span, catalogue::term_declared_twice(&term.name.text, &names.name));
    }
    let mut input = TermInput { elaborator, fields, columns: &mut group.columns };
    let checked: Term = input.check(term).ok()?;
    group.terms.push(checked);
    Some(group.terms.len() - 1)
}

fn column(declaration: &Declaration, elaborator: &mut Elaborator<'_>, columns: &mut Vec<Column>) {
    let (unit, dim) = unit_and_dim(declaration, elaborator);
    let names = components(declaration, elaborator);
    let first = columns.len();
    let entries = (0..names.len()).map(|k| Scalar::leaf(Node::Column(first + k), Reads::COLUMN)).collect();
    // Numbered even if a name is taken, which was reported.
    let _ = add_components(elaborator, declaration, Meaning::Column, first, &names, shaped(declaration, entries, dim));
    let count = names.len();
    columns.extend(names.into_iter().enumerate().map(|(index, name)| Column {
        name,
        unit: unit.clone(),
        part: part(declaration, index, count),
        docs: declaration.docs.clone(),
    }));
}

/// `let`, in a module or in a group. None if it could not be read.
pub(super) fn define(definition: &Let, elaborator: &mut Elaborator<'_>) -> Option<Definition> {
    let name = &definition.name;
    let value = definition.value.as_ref().and_then(|value| elaborator.value(value).ok());
    let written = definition.value.as_ref().zip(value.as_ref()).map(|(written, value)| Definition {
        name: name.clone(),
        text: print_text(written),
        latex: print_definition(&name.text, written, elaborator),
        unit: Unit::si(value.dim.known().cloned().unwrap_or_default()),
        shape: if value.extent == Extent::Scalar { String::new() } else { value.extent.to_string() },
        docs: Vec::new(),
    });
    let symbol = Symbol { meaning: Meaning::Definition, value, span: name.span, index: 0, parent: None, used: false };
    // A name that is taken was reported.
    let _ = elaborator.scope.declare(name, symbol, elaborator.errors);
    written
}
