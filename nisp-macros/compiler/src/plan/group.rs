//! One group of one scene: its rows, channels and programs.

use std::collections::BTreeSet;

use super::rows::{Rows, rows};
use super::schedule::schedule;
use super::sets::Sets;
use super::{GroupPlan, Jet, MAX_ORDER, PlanError, RowKind, TermPlan, collapse};
use crate::channels::{ChannelSet, Operator};
use crate::model::{Model, Name, Scene, TermKind};
use crate::program::{Program, Slot};
use crate::rational::ratio;
use crate::symbolic::differentiate::reverse;
use crate::symbolic::factor::factor;
use crate::symbolic::graph::{Fault, Graph, Id, Leaf, Node, ZERO};
use crate::symbolic::lower::{Lowering, Scalars};
use crate::symbolic::magnitude::magnitude;
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

impl Draft {
    /// Makes the programs.
    pub(super) fn finish(mut self, slots: &Slots, paired: bool, sets: &mut Sets) -> Result<GroupPlan, Fault> {
        let all = vec![true; self.set.len()];
        let mut read = vec![false; self.set.len()];
        self.jets.iter().for_each(|&(_, _, channel)| read[channel] = true);
        let hidden = sets.index(&self.set, all)?;
        let last = sets.index(&self.set, read)?;
        let (jets, held) = self.jet_list(slots, paired);
        let columns = self.columns();
        let nodes: Vec<Id> = jets_nodes(&mut self.graph, &self.jets, &self.set);
        let residual = self.program(&self.rows, slots, &columns);
        let adjoint = self.adjoint(&nodes, slots, &columns);
        let sizes = magnitude(&mut self.graph, &self.rows);
        let magnitude = self.program(&sizes, slots, &columns);
        self.integral_targets(slots);
        match self.graph.fault() {
            Some(fault) => Err(fault),
            None => Ok(GroupPlan {
                group: self.group,
                hidden,
                last,
                jets,
                held,
                terms: self.terms,
                residual,
                adjoint,
                magnitude,
                columns,
            }),
        }
    }

    /// The jets in slot order, and the sites at which coordinates are held.
    fn jet_list(&self, slots: &Slots, paired: bool) -> (Vec<Jet>, Vec<Site>) {
        let held: BTreeSet<Site> = self.jets.iter().map(|(_, site, _)| *site).filter(|site| site.held != 0).collect();
        let held: Vec<Site> = held.into_iter().collect();
        let number = |site: Site| match held.iter().position(|own| *own == site) {
            Some(at) => 1 + usize::from(paired) + at,
            None => usize::from(site.partner),
        };
        let jet = |&(field, site, channel): &Output| Jet {
            head: slots.heads.iter().position(|&head| head == field).unwrap_or(0),
            operator: self.set.basis[channel].clone(),
            combination: vec![(channel, ratio(1, 1))],
            site: number(site),
        };
        (self.jets.iter().map(jet).collect(), held)
    }

    fn columns(&self) -> Vec<usize> {
        let column = |id| match self.graph.node(id) {
            Node::Leaf(Leaf::Input(Slot::Column, column)) => Some(*column),
            _ => None,
        };
        let columns: BTreeSet<usize> =
            self.graph.reachable(self.rows.iter().copied()).into_iter().filter_map(column).collect();
        columns.into_iter().collect()
    }

    fn program(&self, outputs: &[Id], slots: &Slots, columns: &[usize]) -> Program {
        let place = |list: &[usize], wanted: usize| list.iter().position(|&x| x == wanted).unwrap_or(0);
        schedule(&self.graph, outputs, &|leaf| match leaf {
            Leaf::Jet { field, site, operator } => {
                let is = |&(f, s, c): &Output| f == *field && s == *site && self.set.basis[c] == *operator;
                (Slot::Jet, self.jets.iter().position(is).unwrap_or(0))
            }
            Leaf::Input(Slot::Parameter, index) => (Slot::Parameter, slots.scalars[*index]),
            Leaf::Input(Slot::Column, index) => (Slot::Column, place(columns, *index)),
            Leaf::Input(slot, index) => (*slot, *index),
        })
    }

    /// Adjoints of the jets and of the learned parameters, given those of the rows.
    fn adjoint(&mut self, jets: &[Id], slots: &Slots, columns: &[usize]) -> Program {
        let seeds: Vec<(Id, Id)> =
            self.rows.iter().enumerate().map(|(row, &id)| (id, self.graph.input(Slot::Seed, row))).collect();
        let mut wanted = jets.to_vec();
        let learned = self.learned(slots);
        wanted.extend(learned.iter().flatten());
        let mut found = reverse(&mut self.graph, &seeds, &wanted).into_iter();
        let mut outputs: Vec<Id> = found.by_ref().take(jets.len()).collect();
        outputs.extend(learned.iter().map(|id| id.and_then(|_| found.next()).unwrap_or(ZERO)));
        let outputs = factor(&mut self.graph, &outputs);
        self.program(&outputs, slots, columns)
    }

    fn learned(&mut self, slots: &Slots) -> Vec<Option<Id>> {
        let graph = &mut self.graph;
        slots.learned.iter().map(|scalar| scalar.map(|index| graph.input(Slot::Parameter, index))).collect()
    }

    /// Targets of integrals, and their derivatives by the learned parameters.
    fn integral_targets(&mut self, slots: &Slots) {
        let learned = self.learned(slots);
        let wanted: Vec<Id> = learned.iter().flatten().copied().collect();
        for term in 0..self.terms.len() {
            if !matches!(self.terms[term].kind, RowKind::Integral(_)) {
                continue;
            }
            let targets = self.targets[term].clone();
            let mut slopes = Vec::new();
            for &target in &targets {
                let one = self.graph.integer(1);
                let mut found = reverse(&mut self.graph, &[(target, one)], &wanted).into_iter();
                slopes.extend(learned.iter().map(|id| id.and_then(|_| found.next()).unwrap_or(ZERO)));
            }
            self.terms[term].kind = RowKind::Integral(self.program(&targets, slots, &[]));
            self.terms[term].target_slopes = self.program(&slopes, slots, &[]);
        }
    }
}

fn jets_nodes(graph: &mut Graph, jets: &[Output], set: &ChannelSet) -> Vec<Id> {
    let mut leaf =
        |&(field, site, channel): &Output| graph.leaf(Leaf::Jet { field, site, operator: set.basis[channel].clone() });
    jets.iter().map(&mut leaf).collect()
}
