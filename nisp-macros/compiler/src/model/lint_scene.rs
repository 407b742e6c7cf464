//! What a scene cannot find: nothing is unknown, nothing is measured, or two unknowns only occur as their product.

use std::collections::BTreeSet;

use super::elaborate::Elaborator;
use super::scaling::Scaling;
use super::{Expr, Field, Model, Node, Role, Scene, Term, TermKind};
use crate::error::catalogue;

/// Checks every scene; what the terms of a scene read decides.
pub(super) fn check(elaborator: &mut Elaborator<'_>, model: &mut Model) {
    let mut warnings = Vec::new();
    for scene in &model.scenes {
        let name = &scene.name;
        let is_learning = scene.learned.contains(&true);
        if scene.fixed_fields.iter().all(Option::is_some) && !is_learning {
            elaborator.errors.push(name.span, catalogue::nothing_unknown(&name.text));
            continue;
        }
        let terms: Vec<&Term> = used(scene, model).collect();
        let read = reads(&terms);
        let mut searched: Vec<usize> = Vec::new();
        for (at, parameter) in model.parameters.iter().enumerate().filter(|(at, _)| scene.learned[*at]) {
            if !read.parameters.contains(&at) {
                let message = catalogue::learned_in_vain(&parameter.name.text, &name.text);
                warnings.push((message, parameter.name.span));
            } else if scene.spreads[at].is_none() {
                searched.push(at);
            }
        }
        let is_open = |(at, field): &(usize, &Field)| {
            field.role == Role::Source
                && scene.fixed_fields[*at].is_none()
                && field.hard.is_none()
                && read.fields.contains(at)
        };
        let sources: Vec<usize> = model.fields.iter().enumerate().filter(is_open).map(|(at, _)| at).collect();
        let is_measured = read.columns || terms.iter().any(|term| is_measurement(term));
        let is_known = sources.is_empty() && searched.is_empty();
        if !is_measured && !is_known {
            warnings.push((catalogue::nothing_measured(&name.text), name.span));
            continue;
        }
        for (&source, &parameter) in sources.iter().flat_map(|source| searched.iter().map(move |at| (source, at))) {
            let is_scaled = [-1, 1].into_iter().any(|power| {
                let scaling = Scaling { source, parameter, power };
                terms.iter().all(|term| scaling.keeps(&term.kind))
            });
            if is_scaled {
                let names = [&model.parameters[parameter].name, &model.fields[source].name];
                warnings.push((catalogue::not_separable(&names[0].text, &names[1].text), names[0].span));
            }
        }
    }
    model.warnings.append(&mut warnings);
}

/// True if a term compares the answer with something that was measured; conditions may do so by a column.
fn is_measurement(term: &Term) -> bool {
    matches!(term.kind, TermKind::Observation { .. } | TermKind::Chamfer { .. } | TermKind::Integral { .. })
}

/// The terms that a scene uses.
fn used<'a>(scene: &'a Scene, model: &'a Model) -> impl Iterator<Item = &'a Term> {
    let groups = model.groups.iter().zip(&scene.uses);
    groups.flat_map(|(group, uses)| group.terms.iter().zip(uses).filter(|(_, used)| **used).map(|(term, _)| term))
}

/// What expressions read.
#[derive(Default)]
struct Read {
    fields: BTreeSet<usize>,
    parameters: BTreeSet<usize>,
    columns: bool,
    seen: BTreeSet<*const Node>,
}

fn reads(terms: &[&Term]) -> Read {
    let mut read = Read::default();
    terms.iter().flat_map(|term| expressions(term)).for_each(|expr| read.walk(expr));
    read
}

impl Read {
    fn walk(&mut self, expr: &Expr) {
        if !self.seen.insert(Expr::as_ptr(expr)) {
            return;
        }
        match &**expr {
            Node::Field(at) => drop(self.fields.insert(*at)),
            Node::Parameter(at) => drop(self.parameters.insert(*at)),
            Node::Column(_) => self.columns = true,
            Node::Number(_) | Node::Real(_) | Node::Quantity(..) | Node::Coordinate(_) => {}
            Node::Add(parts) | Node::Mul(parts) => parts.iter().for_each(|part| self.walk(part)),
            Node::Div(a, b) | Node::Power(a, b) | Node::Min(a, b) | Node::Max(a, b) => {
                self.walk(a);
                self.walk(b);
            }
            Node::Pow(inner, _) | Node::Call(_, inner) | Node::Partner(inner) | Node::Derivative(inner, _) => {
                self.walk(inner);
            }
        }
    }
}

/// All scalar expressions of a term.
pub(super) fn expressions(term: &Term) -> Vec<&Expr> {
    match &term.kind {
        TermKind::Residual(rows) | TermKind::Observation { rows, .. } | TermKind::Inequality(rows) => {
            rows.iter().collect()
        }
        TermKind::Complementarity { a, b, .. } => vec![a, b],
        TermKind::Integral { integrand, target, .. } => integrand.iter().chain(target).collect(),
        TermKind::Chamfer { point, .. } => point.iter().collect(),
    }
}
