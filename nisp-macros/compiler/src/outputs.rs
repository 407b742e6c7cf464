//! The group that reads out the network: every output's value, transformations included.
//!
//! It is planned like any other group, so that scoring and plotting run the same emitted code as training, forward only.

use std::rc::Rc;

use proc_macro2::Span;

use crate::model::{Group, Model, Name, Node, Term, TermKind};
use crate::plan::Plan;

/// Name of the group; not a Rust identifier, so that no user's group can have it.
const NAME: &str = "(outputs)";

/// Appends the group to a model. In every scene it reads the fields that have a head there, by a first plan.
pub(crate) fn append(model: &mut Model, plan: &Plan) {
    let name = |text: &str| Name { text: text.into(), span: Span::call_site() };
    let terms = model.fields.iter().enumerate().map(|(at, field)| Term {
        name: name(&field.name.text),
        kind: TermKind::Residual(vec![Rc::new(Node::Field(at))]),
        loss: None,
        weight: 1.0,
        within: None,
        unit: field.unit.clone(),
        equation: field.name.text.clone(),
        latex: field.name.text.clone(),
        docs: Vec::new(),
    });
    let terms: Vec<Term> = terms.collect();
    for (scene, plan) in model.scenes.iter_mut().zip(&plan.scenes) {
        scene.uses.push((0..terms.len()).map(|field| plan.heads.contains(&field)).collect());
        scene.weights.push(vec![1.0; terms.len()]);
    }
    model.groups.push(Group {
        name: name(NAME),
        columns: Vec::new(),
        terms,
        place: None,
        paired: false,
        definitions: Vec::new(),
        docs: Vec::new(),
    });
}
