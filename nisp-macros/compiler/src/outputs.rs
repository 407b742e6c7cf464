//! The group that reads out the network: every output's value, transformations included.
//!
//! It is planned like any other group, so that scoring and plotting run the same emitted code as training, forward only.

use std::rc::Rc;

use proc_macro2::Span;

use crate::model::{Expr, Group, Model, Name, Node, Term, TermKind};
use crate::plan::Plan;
use crate::unit::Unit;

/// Name of the group; not a Rust identifier, so that no user's group can have it.
const NAME: &str = "(outputs)";

/// Appends the group to a model. In every scene it reads the fields that have a head there, by a first plan, and in the scene
/// that is asked also what is asked of it beside.
pub(crate) fn append(model: &mut Model, plan: &Plan, asked: Option<&str>) {
    let fields = model.fields.iter().enumerate();
    let fields =
        fields.map(|(at, field)| term(&field.name.text, Span::call_site(), &field.unit, Rc::new(Node::Field(at))));
    let questions = model.questions.iter();
    let questions = questions.map(|asked| term(&asked.name, asked.span, &asked.unit, Rc::clone(&asked.expr)));
    let terms: Vec<Term> = fields.chain(questions).collect();
    for (scene, plan) in model.scenes.iter_mut().zip(&plan.scenes) {
        let has_head = |field: usize| plan.heads.contains(&field);
        let is_asked = asked == Some(&scene.name.text);
        let is_head = |expr: &Node| matches!(expr, Node::Field(field) if has_head(*field));
        let questions = model.questions.iter().map(|question| is_asked && !is_head(&question.expr));
        scene.uses.push((0..model.fields.len()).map(has_head).chain(questions).collect());
        scene.weights.push(vec![1.0; terms.len()]);
    }
    model.groups.push(Group {
        name: Name { text: NAME.into(), span: Span::call_site() },
        columns: Vec::new(),
        terms,
        place: None,
        paired: false,
        definitions: Vec::new(),
        docs: Vec::new(),
    });
}

/// A row that is read out.
fn term(name: &str, span: Span, unit: &Unit, expr: Expr) -> Term {
    Term {
        name: Name { text: name.into(), span },
        kind: TermKind::Residual(vec![expr]),
        loss: None,
        weight: 1.0,
        within: None,
        unit: unit.clone(),
        equation: name.into(),
        latex: name.into(),
        docs: Vec::new(),
    }
}
