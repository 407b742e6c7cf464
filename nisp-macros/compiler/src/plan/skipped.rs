//! What a scene leaves out, told to people.

use super::ScenePlan;
use super::sets::Sets;
use crate::model::{Model, Scene};

/// One line for everything that is not generated, and why.
pub(super) fn skipped(model: &Model, scene: &Scene, plan: &ScenePlan, sets: &Sets) -> Vec<String> {
    let mut lines = Vec::new();
    for (index, field) in model.fields.iter().enumerate() {
        let name = &field.name.text;
        if scene.fixed_fields.get(index).is_some_and(Option::is_some) {
            lines.push(format!("`{name}` is fixed: no head"));
        } else if !plan.heads.contains(&index) {
            lines.push(format!("`{name}` occurs in no used term: no head"));
        }
    }
    for (index, group) in model.groups.iter().enumerate() {
        let unused = |term: &usize| !scene.uses[index][*term];
        let names: Vec<&str> =
            (0..group.terms.len()).filter(unused).map(|term| group.terms[term].name.text.as_str()).collect();
        if names.len() == group.terms.len() {
            lines.push(format!("group {}: not used", group.name.text));
        } else if !names.is_empty() {
            lines.push(format!("group {}: without {}", group.name.text, names.join(", ")));
        }
    }
    let largest = plan.groups.iter().map(|group| sets.plan(group.hidden).set.len()).max().unwrap_or(1);
    for group in &plan.groups {
        let name = &model.groups[group.group].name.text;
        let carried = sets.plan(group.hidden).set.len();
        if carried == 1 && largest > 1 {
            lines.push(format!("group {name}: value only (1 of {largest} channels)"));
        } else if carried < largest {
            lines.push(format!("group {name}: {carried} of {largest} channels"));
        }
        let read = sets.plan(group.last).read.iter().filter(|&&read| read).count();
        if read < carried {
            lines.push(format!("group {name}: last layer reads {read} of {carried} channels"));
        }
    }
    lines
}
