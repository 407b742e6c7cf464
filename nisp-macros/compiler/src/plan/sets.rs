//! Channel sets with the programs of their rules, each made once.

use super::SetPlan;
use super::schedule::schedule_rule;
use crate::channels::{self, ChannelSet, Rule};
use crate::program::Program;
use crate::symbolic::graph::Fault;

/// All distinct sets so far.
#[derive(Default)]
pub(super) struct Sets {
    plans: Vec<SetPlan>,
}

impl Sets {
    /// The index of a set of which only some channels are read.
    pub(super) fn index(&mut self, set: &ChannelSet, read: Vec<bool>) -> Result<usize, Fault> {
        if let Some(known) = self.plans.iter().position(|plan| plan.set == *set && plan.read == read) {
            return Ok(known);
        }
        self.plans.push(plan(set, read)?);
        Ok(self.plans.len() - 1)
    }

    /// A set by its index.
    pub(super) fn plan(&self, index: usize) -> &SetPlan {
        &self.plans[index]
    }

    /// All sets, in order of first use.
    pub(super) fn finish(self) -> Vec<SetPlan> {
        self.plans
    }
}

fn plan(set: &ChannelSet, read: Vec<bool>) -> Result<SetPlan, Fault> {
    let (compose, compose_adjoint) = rule_programs(channels::compose(set)?, &read)?;
    let (affine, affine_adjoint) = rule_programs(channels::affine(set)?, &read)?;
    let (product, product_adjoint) = rule_programs(channels::product(set)?, &read)?;
    let set = set.clone();
    Ok(SetPlan { set, read, compose, compose_adjoint, affine, affine_adjoint, product, product_adjoint })
}

/// A rule and its adjoint as programs, for the channels that are read.
///
/// # Errors
/// If an expression grew past bounds.
pub fn rule_programs(rule: Rule, read: &[bool]) -> Result<(Program, Program), Fault> {
    let rule = rule.read(read);
    let forward = schedule_rule(&rule.graph, &rule.results);
    let (graph, adjoints) = rule.adjoint();
    if let Some(fault) = rule.graph.fault().or(graph.fault()) {
        return Err(fault);
    }
    Ok((forward, schedule_rule(&graph, &adjoints)))
}
