//! One scene: its heads, scalars and groups.

use std::collections::BTreeSet;

use super::group::{self, Slots};
use super::sets::Sets;
use super::skipped::skipped;
use super::{PlanError, Scalar, ScenePlan};
use crate::model::{Model, Scene};
use crate::symbolic::graph::Fault;
use crate::symbolic::lower::Scalars;

/// Plans a scene.
pub(super) fn build(model: &Model, scene: &Scene, sets: &mut Sets) -> Result<ScenePlan, Vec<PlanError>> {
    let mut scalars = Scalars::default();
    let mut drafts = Vec::new();
    let mut errors = Vec::new();
    let used = |group: &usize| scene.uses[*group].iter().any(|&used| used);
    for group in (0..model.groups.len()).filter(used) {
        match group::draft(model, scene, group, drafts.len(), &mut scalars) {
            Ok(draft) => drafts.push(draft),
            Err(error) => errors.push(error),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let heads: BTreeSet<usize> = drafts.iter().flat_map(|draft| draft.jets.iter().map(|jet| jet.0)).collect();
    let heads: Vec<usize> = heads.into_iter().collect();
    let (list, places) = slot_order(scalars.list);
    let learned = |parameter| list.iter().position(|scalar| *scalar == Scalar::Parameter(parameter));
    let first_use = |slot: usize| places.iter().position(|&place| place == slot);
    let parameters = (0..scene.learned.len()).filter(|&parameter| scene.learned[parameter]);
    let learned = parameters.map(|parameter| learned(parameter).and_then(first_use)).collect();
    let slots = Slots { heads: heads.clone(), scalars: places, learned };
    let mut groups = Vec::new();
    for draft in drafts {
        let group = &model.groups[draft.group];
        match draft.finish(&slots, group.paired, sets) {
            Ok(plan) => groups.push(plan),
            Err(fault) => errors.push(failure(fault, scene, &group.name)),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let mut plan = ScenePlan { heads, scalars: list, groups, skipped: Vec::new() };
    plan.skipped = skipped(model, scene, &plan, sets);
    Ok(plan)
}

fn failure(fault: Fault, scene: &Scene, name: &crate::model::Name) -> PlanError {
    let message = format!("`{}` in scene `{}`: {}", name.text, scene.name.text, fault.message());
    PlanError { span: Some(name.span), message }
}

/// Scalars in slot order (parameters, literals, scales), and for each in order of first use its slot.
fn slot_order(scalars: Vec<Scalar>) -> (Vec<Scalar>, Vec<usize>) {
    let rank = |scalar: &Scalar| match scalar {
        Scalar::Parameter(index) => (0, *index),
        Scalar::Literal(..) => (1, 0),
        Scalar::FieldScale(index) => (2, *index),
        Scalar::SideScale(..) => (3, 0),
    };
    let mut order: Vec<usize> = (0..scalars.len()).collect();
    order.sort_by_key(|&index| (rank(&scalars[index]), index));
    let mut places = vec![0; scalars.len()];
    for (place, &index) in order.iter().enumerate() {
        places[index] = place;
    }
    (order.into_iter().map(|index| scalars[index].clone()).collect(), places)
}
