//! The programs of a group, once slots are numbered for the whole scene.

use std::collections::BTreeSet;

use super::{Draft, Output, Slots};
use crate::channels::ChannelSet;
use crate::plan::schedule::schedule;
use crate::plan::sets::Sets;
use crate::plan::{GroupPlan, Jet, RowKind};
use crate::program::{Program, Slot};
use crate::rational::ratio;
use crate::symbolic::differentiate::reverse;
use crate::symbolic::factor::factor;
use crate::symbolic::graph::{Fault, Graph, Id, Leaf, Node, ZERO};
use crate::symbolic::magnitude::magnitude;
use crate::symbolic::site::Site;

impl Draft {
    /// Makes the programs.
    pub(in crate::plan) fn finish(mut self, slots: &Slots, paired: bool, sets: &mut Sets) -> Result<GroupPlan, Fault> {
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
