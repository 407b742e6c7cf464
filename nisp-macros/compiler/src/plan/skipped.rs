//! What a scene leaves out, told to people.

use num_traits::Zero;

use super::sets::Sets;
use super::{Scalar, ScenePlan};
use crate::model::{Expr, Field, Group, Model, Node, Scene};

/// One line for everything that is not generated, and why.
pub(super) fn skipped(model: &Model, scene: &Scene, plan: &ScenePlan, sets: &Sets) -> Vec<String> {
    let mut lines = heads(model, scene, plan);
    lines.extend(terms(model, scene));
    lines.extend(parameters(model, scene, plan));
    lines.extend(channels(model, plan, sets));
    lines
}

fn heads(model: &Model, scene: &Scene, plan: &ScenePlan) -> Vec<String> {
    let line = |(index, field): (usize, &Field)| {
        let name = &field.name.text;
        match scene.fixed_fields.get(index).and_then(Option::as_ref) {
            Some(fixed) if is_zero(fixed) => Some(format!("`{name}` is fixed to 0: no head")),
            Some(_) => Some(format!("`{name}` is fixed to an expression: no head")),
            None if !plan.heads.contains(&index) => Some(format!("no used term reads `{name}`: no head")),
            None => None,
        }
    };
    model.fields.iter().enumerate().filter_map(line).collect()
}

fn is_zero(expression: &Expr) -> bool {
    match &**expression {
        Node::Number(value) => value.is_zero(),
        Node::Real(value) | Node::Quantity(value, _) => *value == 0.0,
        _ => false,
    }
}

fn terms(model: &Model, scene: &Scene) -> Vec<String> {
    let line = |(group, uses): (&Group, &Vec<bool>)| {
        let unused = group.terms.iter().zip(uses).filter(|(_, used)| !**used);
        let names: Vec<&str> = unused.map(|(term, _)| term.name.text.as_str()).collect();
        let group_name = &group.name.text;
        match names.len() {
            0 => None,
            _ if group.is_internal() => None,
            count if count == group.terms.len() => Some(format!("group {group_name}: not used")),
            _ => Some(format!("group {group_name}: without {}", names.join(", "))),
        }
    };
    model.groups.iter().zip(&scene.uses).filter_map(line).collect()
}

fn parameters(model: &Model, scene: &Scene, plan: &ScenePlan) -> Vec<String> {
    let names = |indices: Vec<usize>| {
        indices
            .into_iter()
            .map(|index| format!("`{}`", model.parameters[index].name.text))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let read = |&index: &usize| plan.scalars.contains(&Scalar::Parameter(index));
    let fixed = |&index: &usize| scene.fixed_parameters.get(index).copied().flatten().is_some();
    let all = 0..model.parameters.len();
    let unread: Vec<usize> = all.clone().filter(|index| !read(index) && !fixed(index)).collect();
    let given: Vec<usize> = all.filter(|&index| read(&index) && !scene.learned[index]).collect();
    let mut lines = Vec::new();
    if !unread.is_empty() {
        lines.push(format!("no used term reads {}", names(unread)));
    }
    if !given.is_empty() {
        lines.push(format!("not learned, so no adjoint: {}", names(given)));
    }
    lines
}

fn channels(model: &Model, plan: &ScenePlan, sets: &Sets) -> Vec<String> {
    let mut lines = Vec::new();
    let largest = plan.groups.iter().map(|group| sets.plan(group.hidden).set.len()).max().unwrap_or(1);
    for group in plan.groups.iter().filter(|group| !model.groups[group.group].is_internal()) {
        let name = &model.groups[group.group].name.text;
        let carried = sets.plan(group.hidden).set.len();
        if carried == 1 && largest > 1 {
            lines.push(format!("group {name}: value only (1 of {largest} channels)"));
        } else if carried < largest {
            lines.push(format!("group {name}: {carried} of {largest} channels"));
        }
        let read = sets.plan(group.last).read.iter().filter(|&&read| read).count();
        if read < carried {
            lines.push(format!("group {name}: {read} of {carried} channels are read"));
        }
    }
    lines
}
