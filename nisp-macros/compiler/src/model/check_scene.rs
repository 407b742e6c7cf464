//! Scenes: which terms are used, what is fixed, what is learned.

use super::check_group::GroupNames;
use super::constant::in_unit;
use super::elaborate::Elaborator;
use super::scope::Meaning;
use super::value::Reads;
use super::{Model, Name, Scene, declare};
use crate::error::{Checked, Reported, catalogue};
use crate::syntax::{self, Path, SceneItem, print_text};

/// A scene that uses every term, for modules that declare none.
pub(super) fn everything(model: &Model, name: Name) -> Scene {
    Scene {
        name,
        uses: model.groups.iter().map(|group| vec![true; group.terms.len()]).collect(),
        fixed_fields: vec![None; model.fields.len()],
        fixed_parameters: vec![None; model.parameters.len()],
        learned: vec![false; model.parameters.len()],
        spreads: vec![None; model.parameters.len()],
        warnings: Vec::new(),
        weights: model.groups.iter().map(|group| group.terms.iter().map(|term| term.weight).collect()).collect(),
        docs: model.docs.clone(),
    }
}

/// Checks a scene.
pub(super) fn check(
    scene: &syntax::Scene,
    elaborator: &mut Elaborator<'_>,
    model: &Model,
    groups: &[GroupNames],
) -> Scene {
    let mut checked = everything(model, scene.name.clone());
    if !scene.docs.is_empty() {
        checked.docs.clone_from(&scene.docs);
    }
    if scene.items.iter().any(|item| matches!(item, SceneItem::Only(_))) {
        checked.uses.iter_mut().flatten().for_each(|used| *used = false);
    }
    for item in &scene.items {
        // What is wrong was reported; the other statements are checked all the same.
        let _ = match item {
            SceneItem::Fix(name, value) => fix(name, value, elaborator, model, &mut checked),
            SceneItem::Learn(name, spread) => learn(name, spread.as_ref(), elaborator, model, &mut checked),
            SceneItem::Only(path) => select(path, elaborator, groups, |group, term| checked.uses[group][term] = true),
            SceneItem::Weight(path, weight) => {
                select(path, elaborator, groups, |group, term| checked.weights[group][term] = *weight)
            }
            // Applied below: `only` says what there is, `without` takes away from it.
            SceneItem::Without(_) => Ok(()),
        };
    }
    for item in &scene.items {
        if let SceneItem::Without(path) = item {
            let _ = select(path, elaborator, groups, |group, term| checked.uses[group][term] = false);
        }
    }
    if !checked.uses.iter().flatten().any(|used| *used) && model.groups.iter().any(|group| !group.terms.is_empty()) {
        elaborator.errors.push(scene.name.span, catalogue::scene_without_terms(&scene.name.text));
    }
    checked
}

fn select(
    path: &Path,
    elaborator: &mut Elaborator<'_>,
    groups: &[GroupNames],
    mut apply: impl FnMut(usize, usize),
) -> Checked<()> {
    if elaborator.scope.broken.contains(&path.group.text) {
        return Err(Reported);
    }
    let Some(number) = groups.iter().position(|group| group.name == path.group.text) else {
        let nearest = catalogue::nearest(&path.group.text, groups.iter().map(|group| group.name.as_str()));
        return Err(elaborator.errors.report(path.group.span, catalogue::unknown_group(&path.group.text, nearest)));
    };
    let terms = &groups[number].terms;
    let Some(wanted) = &path.term else {
        terms.iter().filter_map(|(_, term)| *term).for_each(|term| apply(number, term));
        return Ok(());
    };
    match terms.iter().find(|(name, _)| *name == wanted.text) {
        Some((_, Some(term))) => {
            apply(number, *term);
            Ok(())
        }
        Some((_, None)) => Err(Reported),
        None => {
            let nearest = catalogue::nearest(&wanted.text, terms.iter().map(|(name, _)| name.as_str()));
            let message = catalogue::unknown_term(&wanted.text, &path.group.text, nearest);
            Err(elaborator.errors.report(wanted.span, message))
        }
    }
}

fn learn(
    name: &Name,
    spread: Option<&syntax::Expr>,
    elaborator: &mut Elaborator<'_>,
    model: &Model,
    scene: &mut Scene,
) -> Checked<()> {
    let (meaning, indices) = declared(name, elaborator, Meaning::Parameter)?;
    if meaning != Meaning::Parameter {
        return Err(elaborator.errors.report(name.span, catalogue::cannot_learn(&name.text, meaning.noun())));
    }
    let unit = &model.parameters[indices.start].unit;
    let spreads = declare::spreads(spread, name, indices.len(), unit, elaborator);
    for (index, spread) in indices.zip(spreads) {
        if scene.fixed_parameters[index].is_some() {
            return Err(elaborator.errors.report(name.span, catalogue::learned_and_fixed(&name.text)));
        }
        if scene.learned[index] {
            return Err(elaborator.errors.report(name.span, catalogue::learned_twice(&name.text)));
        }
        scene.learned[index] = true;
        scene.spreads[index] = spread.or(model.parameters[index].spread);
    }
    Ok(())
}

fn fix(
    name: &Name,
    value: &syntax::Expr,
    elaborator: &mut Elaborator<'_>,
    model: &Model,
    scene: &mut Scene,
) -> Checked<()> {
    let (meaning, indices) = declared(name, elaborator, Meaning::Source)?;
    let twice =
        |elaborator: &mut Elaborator<'_>| Err(elaborator.errors.report(name.span, catalogue::fixed_twice(&name.text)));
    match meaning {
        Meaning::Parameter => {
            let unit = &model.parameters[indices.start].unit;
            let values = in_unit(value, unit, elaborator)?;
            if values.len() != indices.len() {
                let message = catalogue::wrong_number_of_values(indices.len(), values.len());
                return Err(elaborator.errors.report(value.place, message));
            }
            for (index, constant) in indices.zip(values) {
                if scene.learned[index] {
                    return Err(elaborator.errors.report(name.span, catalogue::learned_and_fixed(&name.text)));
                }
                if scene.fixed_parameters[index].replace(constant.value.as_si()).is_some() {
                    return twice(elaborator);
                }
            }
        }
        Meaning::Field | Meaning::Source => {
            let fixed = fixed_field(name, value, elaborator, indices.len())?;
            for (index, expr) in indices.zip(fixed) {
                if scene.fixed_fields[index].replace(expr).is_some() {
                    return twice(elaborator);
                }
            }
        }
        _ => return Err(elaborator.errors.report(name.span, catalogue::cannot_fix(&name.text, meaning.noun()))),
    }
    Ok(())
}

fn fixed_field(
    name: &Name,
    value: &syntax::Expr,
    elaborator: &mut Elaborator<'_>,
    count: usize,
) -> Checked<Vec<super::Expr>> {
    let checked = elaborator.value(value)?;
    if checked.reads().any(Reads::FIELD) {
        return Err(elaborator.errors.report(value.place, catalogue::fixed_by_fields(&print_text(value))));
    }
    let field_expr = syntax::Expr { kind: syntax::ExprKind::Name(name.text.clone()), place: name.span.into() };
    let field = elaborator.value(&field_expr)?;
    elaborator.agree(&[(&field_expr, &field.dim), (value, &checked.dim)], "sides of one condition");
    if checked.is_zero() {
        return Ok(vec![checked.entries[0].expr.clone(); count]);
    }
    elaborator.common_extent(&[(&field_expr, &field), (value, &checked)])?;
    Ok(checked.entries.into_iter().map(|entry| entry.expr).collect())
}

/// What a name was declared as, and its components' numbers.
fn declared(
    name: &Name,
    elaborator: &mut Elaborator<'_>,
    wanted: Meaning,
) -> Checked<(Meaning, std::ops::Range<usize>)> {
    if elaborator.scope.broken.contains(&name.text) {
        return Err(Reported);
    }
    match elaborator.scope.find(&name.text) {
        Some(symbol) => {
            let count = symbol.value.as_ref().map_or(1, |value| value.entries.len());
            let found = (symbol.meaning, symbol.index..symbol.index + count);
            elaborator.scope.mark_used(&name.text);
            Ok(found)
        }
        None => {
            let kind = |meaning: Meaning| meaning == wanted || meaning == Meaning::Parameter;
            let symbols = elaborator.scope.module_symbols().filter(|(_, symbol)| kind(symbol.meaning));
            let nearest = catalogue::nearest(&name.text, symbols.map(|(name, _)| name.as_str()));
            let message = catalogue::unknown_name(&name.text, nearest);
            Err(elaborator.errors.report(name.span, message))
        }
    }
}
