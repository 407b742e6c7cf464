//! The order in which a module is checked.

use std::rc::Rc;

use super::check_group::{self, GroupNames};
use super::elaborate::Elaborator;
use super::scope::Meaning;
use super::value::Reads;
use super::{Definition, Group, Hard, Model, Name, check_domain, check_scene, declare, lint, question};
use crate::error::{Checked, Errors, catalogue};
use crate::syntax::{self, Item, Module, print_text};

/// Checks a module and what is asked of its answer. None if anything was wrong, in this stage or before; everything wrong is
/// reported.
pub fn check(module: &Module, questions: &[syntax::Expr], errors: &mut Errors) -> Option<Model> {
    let mut model = Model {
        name: module.name.clone(),
        visibility: module.visibility.clone(),
        docs: module.docs.clone(),
        coordinates: Vec::new(),
        fields: Vec::new(),
        parameters: Vec::new(),
        constants: Vec::new(),
        definitions: Vec::new(),
        groups: Vec::new(),
        questions: Vec::new(),
        scenes: Vec::new(),
        units_checked: !module.units_off,
        warnings: Vec::new(),
    };
    let mut elaborator = Elaborator::new(errors, model.units_checked);
    elaborator.scope.broken = module.broken.clone();
    declare::declare(module, &mut elaborator, &mut model);
    model.definitions = definitions(module, &mut elaborator);
    for item in &module.items {
        if let Item::Hard(hard) = item {
            // What is wrong was reported.
            let _ = hard_condition(hard, &mut elaborator, &mut model);
        }
    }
    let names = groups(module, &mut elaborator, &mut model);
    scenes(module, &mut elaborator, &mut model, &names);
    lint::check(&mut elaborator, &mut model);
    model.questions = question::check(questions, &mut elaborator, &model);
    let sound = !elaborator.errors.found_any();
    model.warnings.append(&mut elaborator.warnings);
    sound.then_some(model)
}

/// Definitions see those above them.
fn definitions(module: &Module, elaborator: &mut Elaborator<'_>) -> Vec<Definition> {
    let all = module.items.iter().filter_map(|item| match item {
        Item::Let(definition) => Some(definition),
        _ => None,
    });
    elaborator.scope.later = all.clone().map(|definition| definition.name.text.clone()).collect();
    all.filter_map(|definition| check_group::define(definition, elaborator)).collect()
}

fn groups(module: &Module, elaborator: &mut Elaborator<'_>, model: &mut Model) -> Vec<GroupNames> {
    let mut domains = check_domain::check(module, &model.coordinates, elaborator);
    let mut names: Vec<GroupNames> = Vec::new();
    for item in &module.items {
        let Item::Group(group) = item else { continue };
        if names.iter().any(|other| other.name == group.name.text) {
            elaborator.errors.push(group.name.span, catalogue::group_declared_twice(&group.name.text));
        }
        let (mut checked, found) = check_group::check(group, elaborator, &model.fields);
        checked.place = domains.locate(group.location.as_ref(), elaborator);
        let alike = |other: &&Group| other.name.text != checked.name.text && other.data_name() == checked.data_name();
        if let Some(other) = model.groups.iter().find(alike) {
            let message = catalogue::groups_alike(&checked.name.text, &other.name.text, &checked.data_name());
            elaborator.errors.push(checked.name.span, message);
        }
        model.groups.push(checked);
        names.push(found);
    }
    domains.warn(elaborator);
    if names.is_empty() && !elaborator.errors.found_any() {
        elaborator.errors.push(module.name.span, catalogue::no_groups());
    }
    names
}

fn scenes(module: &Module, elaborator: &mut Elaborator<'_>, model: &mut Model, names: &[GroupNames]) {
    let mut scenes = Vec::new();
    for item in &module.items {
        let Item::Scene(scene) = item else { continue };
        if scenes.iter().any(|other: &super::Scene| other.name.text == scene.name.text) {
            elaborator.errors.push(scene.name.span, catalogue::scene_declared_twice(&scene.name.text));
        }
        scenes.push(check_scene::check(scene, elaborator, model, names));
    }
    if scenes.is_empty() {
        scenes.push(check_scene::everything(model, Name { text: "all".into(), span: module.name.span }));
    }
    model.scenes = scenes;
}

/// `hard w = 0 by 1 - (x/a)^2;`
fn hard_condition(hard: &syntax::Hard, elaborator: &mut Elaborator<'_>, model: &mut Model) -> Checked<()> {
    if elaborator.scope.broken.contains(&hard.field.text) {
        return Err(crate::error::Reported);
    }
    let symbol = elaborator.scope.find(&hard.field.text).cloned();
    let Some(symbol) = symbol.filter(|symbol| matches!(symbol.meaning, Meaning::Field | Meaning::Source)) else {
        let nearest = catalogue::nearest(&hard.field.text, model.fields.iter().map(|field| field.name.text.as_str()));
        return Err(elaborator.errors.report(hard.field.span, catalogue::not_a_field(&hard.field.text, nearest)));
    };
    let field_expr =
        syntax::Expr { kind: syntax::ExprKind::Name(hard.field.text.clone()), place: hard.field.span.into() };
    let distance = elaborator.pure(&hard.distance, "a distance");
    let value = elaborator.value(&hard.value);
    let (distance, value) = (distance?, value?);
    let Some(field) = symbol.value else { return Err(crate::error::Reported) };
    for (expr, reads) in [(&hard.value, value.reads()), (&hard.distance, distance.reads)] {
        if reads.any(Reads::FIELD) {
            return Err(elaborator.errors.report(expr.place, catalogue::hard_by_fields(&print_text(expr))));
        }
    }
    if !distance.reads.any(Reads::COORDINATE) {
        let message = catalogue::distance_does_not_vary(&print_text(&hard.distance));
        return Err(elaborator.errors.report(hard.distance.place, message));
    }
    elaborator.agree(&[(&field_expr, &field.dim), (&hard.value, &value.dim)], "sides of one condition");
    elaborator.common_extent(&[(&field_expr, &field), (&hard.value, &value)])?;
    for component in 0..field.entries.len() {
        let Some(field) = model.fields.get_mut(symbol.index + component) else { continue };
        let entry = value.entries.get(component).or(value.entries.first());
        let Some(entry) = entry else { continue };
        if field.lower.is_some() || field.upper.is_some() {
            return Err(elaborator.errors.report(hard.field.span, catalogue::hard_and_bounded(&hard.field.text)));
        }
        let text = [&hard.value, &hard.distance].map(print_text);
        let condition = Hard { text, distance: Rc::clone(&distance.expr), value: Rc::clone(&entry.expr) };
        if field.hard.replace(condition).is_some() {
            return Err(elaborator.errors.report(hard.field.span, catalogue::hard_twice(&hard.field.text)));
        }
    }
    Ok(())
}
