//! One group of one scene: its rows, channels and programs.

mod programs;

use std::collections::BTreeSet;

use super::rows::{Rows, rows};
use super::{MAX_ORDER, PlanError, RowKind, TermPlan, collapse};
use crate::channels::{ChannelSet, Operator};
use crate::model::{Model, Name, Scene, TermKind};
use crate::program::{Program, Slot};
use crate::symbolic::factor::factor;
use crate::symbolic::graph::{Fault, Graph, Id, Leaf, Node};
use crate::symbolic::lower::{Lowering, Scalars};
use crate::symbolic::rewrite::rewrite;
use crate::symbolic::site::Site;

/// An output of the network that is read: field, site, channel.
type Output = (usize, Site, usize);

/// A group's expressions, before slots are numbered for the whole scene.
pub(super) struct Draft {
    /// Index of the group in the model.
    pub(super) group: usize,
    graph: Graph,
    terms: Vec<TermPlan>,
    /// Rows of all terms, one after the other.
    rows: Vec<Id>,
    /// For each term, the targets of its integral.
    targets: Vec<Vec<Id>>,
    /// The channels its hidden layers carry.
    pub(super) set: ChannelSet,
    /// Outputs that are read.
    pub(super) jets: Vec<Output>,
}

/// Numbers of slots that are the same for all groups of a scene.
pub(super) struct Slots {
    /// Fields with a head, by index in the model.
    pub(super) heads: Vec<usize>,
    /// For each scalar in order of first use, its final slot.
    pub(super) scalars: Vec<usize>,
    /// Learned parameters as scalars in order of first use; `None` if nothing reads the parameter.
    pub(super) learned: Vec<Option<usize>>,
}

/// Lowers the used terms of a group; `place` is its index in the scene's plan.
pub(super) fn draft(
    model: &Model,
    scene: &Scene,
    group: usize,
    place: usize,
    scalars: &mut Scalars,
) -> Result<Draft, PlanError> {
    let mut lowering = Lowering::new(model, scene, scalars);
    let mut terms: Vec<TermPlan> = Vec::new();
    let mut all = Vec::new();
    let mut targets = Vec::new();
    for (index, term) in model.groups[group].terms.iter().enumerate() {
        if !scene.uses[group][index] {
            continue;
        }
        let Rows { rows, targets: goal } = rows(&mut lowering, term, (place, terms.len()));
        check(&lowering.graph, &rows, model, scene, &term.name)?;
        let (first, count) = (all.len(), rows.len());
        let reads = lowering.graph.reachable(rows.iter().copied());
        let known =
            reads.into_iter().any(|id| matches!(lowering.graph.node(id), Node::Leaf(Leaf::Input(Slot::Column, _))));
        terms.push(TermPlan {
            term: index,
            kind: kind(&term.kind),
            loss: term.loss,
            first,
            rows: count,
            jets: Vec::new(),
            known,
            target_slopes: Program::default(),
        });
        all.extend(rows);
        targets.push(goal);
    }
    let mut graph = lowering.graph;
    let name = &model.groups[group].name;
    // What is read out of an answer must not tie the scales of coordinates that its equations have left apart.
    let classes = match model.groups[group].is_internal() {
        true => (0..model.coordinates.len()).collect(),
        false => collapse::dimension_classes(model),
    };
    let collapsed = collapse::collapse(&mut graph, &all, &classes);
    let read = operators(&graph, &collapsed);
    let coordinates = model.coordinates.len();
    // Literals too long for exact elimination: carry the operators' parts one by one.
    let set = ChannelSet::minimal(&read, coordinates)
        .or_else(|_| ChannelSet::minimal(&parts(&read), coordinates))
        .map_err(|_| error(Fault::Overflow, scene, name))?;
    let expanded = rewrite(&mut graph, &collapsed, |graph, id| expand(graph, id, &set));
    let rows = factor(&mut graph, &expanded);
    if let Some(fault) = graph.fault() {
        return Err(error(fault, scene, name));
    }
    let all: Vec<Output> = jets(&graph, &rows, &set).into_iter().collect();
    for term in &mut terms {
        let own = jets(&graph, &rows[term.first..term.first + term.rows], &set);
        term.jets = (0..all.len()).filter(|&at| own.contains(&all[at])).collect();
    }
    Ok(Draft { group, graph, terms, rows, targets, set, jets: all })
}

fn kind(kind: &TermKind) -> RowKind {
    match kind {
        TermKind::Residual(_) | TermKind::Inequality(_) | TermKind::Complementarity { .. } => RowKind::Residual,
        TermKind::Observation { .. } => RowKind::Observation,
        TermKind::Integral { .. } => RowKind::Integral(Program::default()),
        TermKind::Chamfer { symmetric, plane, .. } => RowKind::Chamfer { symmetric: *symmetric, plane: *plane },
    }
}

fn error(fault: Fault, scene: &Scene, name: &Name) -> PlanError {
    let message = format!("`{}` in scene `{}`: {}", name.text, scene.name.text, fault.message());
    PlanError { span: Some(name.span), message }
}

/// Reports faults and orders that nobody can want at the term they come from.
fn check(graph: &Graph, rows: &[Id], model: &Model, scene: &Scene, name: &Name) -> Result<(), PlanError> {
    if let Some(fault) = graph.fault() {
        return Err(error(fault, scene, name));
    }
    for id in graph.reachable(rows.iter().copied()) {
        if let Node::Leaf(Leaf::Jet { field, operator, .. }) = graph.node(id)
            && operator.degree() > MAX_ORDER
        {
            let message = format!(
                "`{}` needs a derivative of order {} of `{}`; the highest supported order is {MAX_ORDER}\n\
                 = help: introduce a field for an inner derivative and couple it by a residual",
                name.text,
                operator.degree(),
                model.fields[*field].name.text,
            );
            return Err(PlanError { span: Some(name.span), message });
        }
    }
    Ok(())
}

fn operators(graph: &Graph, rows: &[Id]) -> BTreeSet<Operator> {
    let reachable = graph.reachable(rows.iter().copied());
    let operator = |id| match graph.node(id) {
        Node::Leaf(Leaf::Jet { operator, .. }) => Some(operator.clone()),
        _ => None,
    };
    reachable.into_iter().filter_map(operator).collect()
}

/// The plain partial derivatives that operators combine.
fn parts(operators: &BTreeSet<Operator>) -> BTreeSet<Operator> {
    operators.iter().flat_map(|operator| operator.terms().map(|(index, _)| Operator::monomial(index.clone()))).collect()
}

/// An operator as a combination of channels, so that rows share what they read.
fn expand(graph: &mut Graph, id: Id, set: &ChannelSet) -> Id {
    let Node::Leaf(Leaf::Jet { field, site, operator }) = graph.node(id).clone() else { return id };
    let Ok(Some(combination)) = set.express(&operator) else { return graph.fail(Fault::Overflow) };
    let mut terms = Vec::new();
    for (channel, coefficient) in combination {
        let operator = set.basis[channel].clone();
        terms.push((coefficient, graph.leaf(Leaf::Jet { field, site, operator })));
    }
    graph.linear(&terms)
}

/// The jets that rows read.
fn jets(graph: &Graph, rows: &[Id], set: &ChannelSet) -> BTreeSet<Output> {
    let mut found = BTreeSet::new();
    for id in graph.reachable(rows.iter().copied()) {
        if let Node::Leaf(Leaf::Jet { field, site, operator }) = graph.node(id)
            && let Some(channel) = set.basis.iter().position(|basis| basis == operator)
        {
            found.insert((*field, *site, channel));
        }
    }
    found
}
