//! The group of what is believed of learned parameters before any data are seen.
//!
//! A belief is a measurement of the parameter: its given value, with the spread as noise. As a group like any other, of one
//! point, it reaches every solver, error bar and report by the way that measurements go.

use std::rc::Rc;

use proc_macro2::Span;

use crate::model::{Column, Group, Model, Name, Node, Parameter, Term, TermKind};
use crate::rational::ratio;

/// Name of the group; not a Rust identifier, so that no user's group can have it. The runtime binds it under this name.
const NAME: &str = "(beliefs)";

/// Appends the group to a model, if any scene believes something of a parameter that it learns.
pub(crate) fn append(model: &mut Model) {
    let beliefs: Vec<(usize, usize, f64)> = model
        .scenes
        .iter()
        .enumerate()
        .flat_map(|(scene, declared)| declared.spreads.iter().enumerate().map(move |(at, spread)| (scene, at, *spread)))
        .filter_map(|(scene, parameter, spread)| Some((scene, parameter, spread?)))
        .collect();
    if beliefs.is_empty() {
        return;
    }
    // Spreads may differ from scene to scene, so that each has terms of its own.
    let terms = beliefs.iter().map(|&(_, at, spread)| belief(at, &model.parameters[at], spread)).collect();
    for (number, scene) in model.scenes.iter_mut().enumerate() {
        scene.uses.push(beliefs.iter().map(|belief| belief.0 == number).collect());
        scene.weights.push(vec![1.0; beliefs.len()]);
    }
    let column = |parameter: &Parameter| Column {
        name: parameter.name.clone(),
        unit: parameter.unit.clone(),
        part: None,
        docs: Vec::new(),
    };
    model.groups.push(Group {
        name: Name { text: NAME.into(), span: Span::call_site() },
        columns: model.parameters.iter().map(column).collect(),
        terms,
        place: None,
        paired: false,
        definitions: Vec::new(),
        docs: Vec::new(),
    });
}

/// `parameter ~ its given value within spread`; the column of a parameter has its number.
fn belief(at: usize, parameter: &Parameter, spread: f64) -> Term {
    let name = &parameter.name.text;
    let given = Node::Mul(vec![Rc::new(Node::Number(ratio(-1, 1))), Rc::new(Node::Column(at))]);
    let row = Node::Add(vec![Rc::new(Node::Parameter(at)), Rc::new(given)]);
    Term {
        name: parameter.name.clone(),
        kind: TermKind::Observation { rows: vec![Rc::new(row)], columns: vec![at] },
        loss: None,
        weight: 1.0,
        within: Some(spread),
        unit: parameter.unit.clone(),
        equation: format!("{name} ~ given"),
        latex: format!(r"{name} \sim \mathrm{{given}}"),
        docs: Vec::new(),
    }
}
