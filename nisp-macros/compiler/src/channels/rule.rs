//! A propagation rule: how channels pass through one operation, and its adjoint.

use crate::program::Slot;
use crate::symbolic::differentiate::{activation_adjoint, reverse};
use crate::symbolic::graph::{Graph, Id, ZERO};

/// A rule as expressions: one result per channel.
#[derive(Clone, Debug)]
pub struct Rule {
    /// The graph that holds the results.
    pub graph: Graph,
    /// The result in each channel.
    pub results: Vec<Id>,
    /// How many derivatives of the activation the rule reads, `phi[0]` included; zero if it has none.
    pub phis: usize,
    /// The inputs whose adjoints its adjoint delivers, in order.
    pub inputs: Vec<Option<(Slot, usize)>>,
}

impl Rule {
    /// Keeps only results that are read.
    pub fn read(mut self, read: &[bool]) -> Self {
        for (result, &read) in self.results.iter_mut().zip(read) {
            if !read {
                *result = ZERO;
            }
        }
        self
    }

    /// The adjoint by reverse accumulation: the graph, and the adjoints of `inputs`, where `None` stands for the
    /// activation's argument. Results that are zero have no seed.
    pub fn adjoint(&self) -> (Graph, Vec<Id>) {
        let mut graph = self.graph.clone();
        let read = self.results.iter().enumerate().filter(|&(_, &result)| result != ZERO);
        let read: Vec<(usize, Id)> = read.map(|(channel, &result)| (channel, result)).collect();
        let seeds: Vec<(Id, Id)> =
            read.iter().map(|&(channel, result)| (result, graph.input(Slot::Seed, channel))).collect();
        let mut wanted: Vec<Id> = (0..self.phis).map(|n| graph.input(Slot::Phi, n)).collect();
        for (slot, index) in self.inputs.iter().flatten() {
            wanted.push(graph.input(*slot, *index));
        }
        let adjoints = reverse(&mut graph, &seeds, &wanted);
        let value = activation_adjoint(&mut graph, &adjoints[..self.phis]);
        let mut others = adjoints[self.phis..].iter();
        let pick = |input: &Option<(Slot, usize)>| match input {
            None => value,
            Some(_) => others.next().copied().unwrap_or(ZERO),
        };
        let outputs = self.inputs.iter().map(pick).collect();
        (graph, outputs)
    }
}
