//! What is probably a mistake: unused names, and fields or sources that nothing pins down.

use std::collections::{BTreeMap, BTreeSet};

use super::elaborate::Elaborator;
use super::orders::{Orders, Walker, merge};
use super::scope::Meaning;
use super::{Group, Model, Portion, Region, Role, Scene, Term, TermKind, build, cancel, lint_scene};
use crate::error::catalogue;

/// What one term reads.
struct Row {
    group: usize,
    fields: BTreeMap<usize, Orders>,
    /// Measured data pins a field whatever the equations' orders are.
    measured: bool,
    conditions: usize,
}

/// Adds warnings; a source in no equation is an error.
pub(super) fn check(elaborator: &mut Elaborator<'_>, model: &mut Model) {
    if elaborator.errors.found_any() {
        // What could not be read may well have used or pinned what seems to lie idle.
        return;
    }
    unused(elaborator);
    shadowed_derivatives(elaborator);
    let mut walker = Walker::default();
    let rows: Vec<Vec<Row>> = model
        .groups
        .iter()
        .enumerate()
        .map(|(number, group)| group.terms.iter().map(|term| row((number, ends(group)), term, &mut walker)).collect())
        .collect();
    sources_without_equation(elaborator, model, &rows);
    lint_scene::check(elaborator, model);
    let mut said = BTreeSet::new();
    let open: Vec<Vec<(String, usize)>> = model.scenes.iter().map(|scene| unpinned(scene, model, &rows)).collect();
    for (scene, open) in model.scenes.iter_mut().zip(open) {
        scene.warnings = open.iter().map(|(message, _)| message.clone()).collect();
        for (message, field) in open {
            if said.insert((field, message.clone())) {
                model.warnings.push((message, model.fields[field].name.span));
            }
        }
    }
}

fn unused(elaborator: &mut Elaborator<'_>) {
    let unused = elaborator.scope.module_symbols().filter(|(_, symbol)| !symbol.used && symbol.parent.is_none());
    let unused: Vec<_> = unused
        // A source that nothing reads is an error of its own, and a definition may be there to be asked of the answer.
        .filter(|(_, symbol)| !matches!(symbol.meaning, Meaning::Source | Meaning::Definition))
        .map(|(name, symbol)| (catalogue::unused(symbol.meaning.noun(), name), symbol.span))
        .collect();
    elaborator.warnings.extend(unused);
}

/// A name that reads like a derivative but is declared as something else.
fn shadowed_derivatives(elaborator: &mut Elaborator<'_>) {
    let symbols = elaborator.scope.module_symbols().filter(|(_, symbol)| symbol.parent.is_none());
    let shadowing = symbols.filter_map(|(name, symbol)| {
        let (base, by) = elaborator.derivative_by_suffix(name)?;
        let inner = elaborator.scope.find(&base)?.value.as_ref()?.as_scalar()?.clone();
        let derivative = by.into_iter().fold(inner, |inner, coordinate| build::derivative(&inner, coordinate));
        let same = symbol.value.as_ref()?.as_scalar()?.expr == derivative.expr;
        (!same).then(|| (catalogue::shadows_derivative(name, &base), symbol.span))
    });
    let shadowing: Vec<_> = shadowing.collect();
    elaborator.warnings.extend(shadowing);
}

/// How many ends a group lies at: the boundary of an interval is two.
fn ends(group: &Group) -> usize {
    let both = group.place.as_ref().is_some_and(|place| {
        let is_interval = matches!(place.domain.first(), Some(Region::Box(ranges)) if ranges.len() == 1);
        place.portion == Portion::Boundary && is_interval
    });
    1 + usize::from(both)
}

fn row((group, ends): (usize, usize), term: &Term, walker: &mut Walker) -> Row {
    let mut fields = BTreeMap::new();
    let expressions = lint_scene::expressions(term);
    for expr in expressions {
        // What cancels is not read.
        for (part, _) in cancel::parts(expr) {
            merge(&mut fields, &walker.fields(&part));
            walker.keep(part);
        }
    }
    let measured =
        matches!(term.kind, TermKind::Observation { .. } | TermKind::Chamfer { .. } | TermKind::Integral { .. });
    let conditions = match &term.kind {
        TermKind::Residual(rows) => ends * rows.len(),
        _ => ends,
    };
    Row { group, fields, measured, conditions }
}

fn sources_without_equation(elaborator: &mut Elaborator<'_>, model: &Model, rows: &[Vec<Row>]) {
    for (index, field) in model.fields.iter().enumerate().filter(|(_, field)| field.role == Role::Source) {
        let equations = model.groups.iter().zip(rows).flat_map(|(group, rows)| group.terms.iter().zip(rows));
        let read = equations
            .filter(|(term, _)| !matches!(term.kind, TermKind::Observation { .. } | TermKind::Chamfer { .. }))
            .any(|(_, row)| row.fields.contains_key(&index));
        if !read {
            elaborator.errors.push(field.name.span, catalogue::source_without_equation(&field.name.text));
        }
    }
}

/// Fields and sources whose every equation in a scene leaves constants of integration open.
fn unpinned(scene: &Scene, model: &Model, rows: &[Vec<Row>]) -> Vec<(String, usize)> {
    let used: Vec<&Row> = rows
        .iter()
        .zip(&scene.uses)
        .flat_map(|(rows, uses)| rows.iter().zip(uses).filter(|(_, used)| **used).map(|(row, _)| row))
        .collect();
    let name = if model.scenes.len() > 1 { Some(scene.name.text.as_str()) } else { None };
    let mut found = Vec::new();
    for (index, field) in model.fields.iter().enumerate() {
        let reading: Vec<&&Row> = used.iter().filter(|row| row.fields.contains_key(&index)).collect();
        let idle = scene.fixed_fields[index].is_some() || field.hard.is_some() || reading.is_empty();
        if idle {
            continue;
        }
        if reading.iter().any(|row| row.measured) {
            found.extend(bare(&reading, index, &field.name.text, name).map(|message| (message, index)));
            continue;
        }
        let order = reading.iter().map(|row| row.fields[&index].total).max().unwrap_or(0);
        let pinning = reading.iter().filter(|row| row.fields[&index].total < order);
        if order > 0 && pinning.clone().count() == 0 {
            found.push((catalogue::unpinned(&field.name.text, field.role == Role::Source, order, name), index));
            continue;
        }
        if field.role == Role::Field {
            found.extend(too_few_conditions(&reading, index, &field.name.text, name).map(|message| (message, index)));
        }
    }
    found
}

/// Data tell a field and its slopes. Of an equation of fourth order they tell little where no condition helps them.
fn bare(reading: &[&&Row], field: usize, text: &str, scene: Option<&str>) -> Option<String> {
    let equations = || reading.iter().filter(|row| !row.measured);
    let order = equations().map(|row| row.fields[&field].total).max()?;
    let has_condition = equations().any(|row| row.fields[&field].total < order);
    (order >= 4 && !has_condition).then(|| catalogue::few_conditions(text, order, order.div_ceil(2) as usize, 0, scene))
}

/// An equation of order 2k in space wants k conditions on each side of the domain; an ordinary one as many as its order.
fn too_few_conditions(reading: &[&&Row], field: usize, text: &str, scene: Option<&str>) -> Option<String> {
    let mut highest: Orders = Orders::default();
    for row in reading {
        let mut all = BTreeMap::from([(field, highest)]);
        merge(&mut all, &BTreeMap::from([(field, row.fields[&field].clone())]));
        highest = all.remove(&field).unwrap_or_default();
    }
    let order = highest.by.values().copied().max().unwrap_or(0);
    let needed = if highest.by.len() == 1 { order } else { order.div_ceil(2) } as usize;
    let equations: BTreeSet<usize> =
        reading.iter().filter(|row| row.fields[&field].total == highest.total).map(|row| row.group).collect();
    let conditions: usize =
        reading.iter().filter(|row| !equations.contains(&row.group)).map(|row| row.conditions).sum();
    (order > 1 && conditions < needed).then(|| catalogue::few_conditions(text, order, needed, conditions, scene))
}
