//! What the data do not determine, and what settles it: looked for at an answer, said in the user's words.
//!
//! The Laplace posterior of every head has a leading direction, and so have all learned scalars together. Where it is open
//! (see `open.rs`), multiples of it may be added to the answer, and only the prior says how much. A condition or a belief
//! that closes a direction which is open without it is named too; of local functions that is not looked for.

use super::open::Open;
use super::spread::Spread;
use super::weigh::FEW_ROWS;
use super::words::Words;
use crate::engine::Engine;
use crate::local::LocalSolution;
use crate::network::Architecture;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::curvature::Curvature;
use crate::solve::driver::{Warning, WarningKind};
use crate::solve::objective::LeastSquares;
use crate::solve::prior::WeightPrior;
use crate::splines::SplineSolution;

/// A place to look from: the solution, with rows over their standard deviations.
pub(super) struct View<'a> {
    pub(super) bound: &'a Bound,
    pub(super) engine: &'a mut Engine<f64>,
    pub(super) theta: &'a [f64],
    pub(super) prior: &'a WeightPrior,
    pub(super) architecture: Architecture,
}

impl View<'_> {
    /// How many curvatures [`View::warnings`] looks at, at most.
    pub(super) fn curvatures(&self) -> usize {
        1 + (0..self.engine.blocks().len()).filter(|&block| self.condition(block).is_some()).count()
    }

    /// Directions that are open, and conditions that close directions which are open without them.
    pub(super) fn warnings(&mut self) -> Vec<Warning> {
        let words = Words { bound: self.bound, learned: self.engine.learned_values(self.theta) };
        let warnings = self.spread().map(|spread| undetermined(&words, &spread)).unwrap_or_default();
        if !warnings.is_empty() {
            return warnings;
        }
        let mut warnings = Vec::new();
        for block in 0..self.engine.blocks().len() {
            let Some(condition) = self.condition(block) else { continue };
            let sigma = self.engine.blocks()[block].sigma;
            self.engine.set_sigma(block, f64::INFINITY);
            let without = self.spread();
            self.engine.set_sigma(block, sigma);
            let Some(without) = without else { continue };
            let settled = Open::all(&without).into_iter().map(|open| words.settled(&open, &without, &condition));
            warnings.extend(settled.map(|message| Warning { kind: WarningKind::Settled, message }));
        }
        warnings
    }

    /// What a block says, if it is a condition that could be left out.
    fn condition(&self, block: usize) -> Option<String> {
        let mut terms =
            self.engine.groups.iter().flat_map(|group| group.terms.iter().map(|term| (group.schema, term.schema)));
        let (group, schema) = terms.nth(block)?;
        let few = self.engine.blocks()[block].rows.len() <= FEW_ROWS;
        if group.is_beliefs() {
            return Some(format!("what is believed of `{}`", schema.name));
        }
        (few && schema.kind == TermKind::Residual).then(|| condition(group.name, schema.name, schema.equation))
    }

    /// None where the curvature cannot be had.
    fn spread(&mut self) -> Option<Spread> {
        let curvature = Curvature::at(self.engine, self.theta, self.prior).ok()?;
        Spread::of_network(self.bound, self.architecture, &curvature, self.theta)
    }
}

/// Directions that are open in a solution by local functions.
pub(super) fn of_local(bound: &Bound, found: &LocalSolution) -> Vec<Warning> {
    let learned =
        bound.learned.iter().zip(&found.kept.learned).map(|(learned, &parameter)| learned.map.at(parameter)).collect();
    undetermined(&Words { bound, learned }, &Spread::of_local(bound, found))
}

/// Conditions that hold at few points and could be left out, by group and term.
pub(super) fn conditions(bound: &Bound) -> Vec<(usize, usize)> {
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates).enumerate();
    let few = groups.filter(|(_, (group, points))| points.len() * group.rows <= FEW_ROWS && !points.is_empty());
    let terms = few.flat_map(|(at, (group, _))| group.terms.iter().enumerate().map(move |(term, own)| (at, term, own)));
    terms.filter(|(_, _, own)| own.kind == TermKind::Residual).map(|(at, term, _)| (at, term)).collect()
}

/// Directions that are open in a solution by splines, and conditions that close directions which are open without them.
pub(super) fn of_splines(bound: &Bound, found: &SplineSolution) -> Vec<Warning> {
    let learned = bound.learned.iter().zip(&found.kept.learned);
    let words = Words { bound, learned: learned.map(|(learned, &parameter)| learned.map.at(parameter)).collect() };
    let mut warnings = Vec::new();
    for root in &found.roots {
        let spread = Spread::of_splines(bound, found, root);
        let Some((group, term)) = root.without else {
            warnings.extend(undetermined(&words, &spread));
            if warnings.is_empty() { continue } else { break }
        };
        let group = &bound.problem.scene().schema.groups[group];
        let condition = condition(group.name, group.terms[term].name, group.terms[term].equation);
        let settled = Open::all(&spread).into_iter().map(|open| words.settled(&open, &spread, &condition));
        warnings.extend(settled.map(|message| Warning { kind: WarningKind::Settled, message }));
    }
    warnings
}

/// A condition in words.
fn condition(group: &str, term: &str, equation: &str) -> String {
    format!("the condition `{group}.{term}: {equation}`")
}

fn undetermined(words: &Words<'_>, spread: &Spread) -> Vec<Warning> {
    let all = Open::all(spread);
    let said = all.iter().map(|open| words.undetermined(open, spread, &all));
    said.map(|message| Warning { kind: WarningKind::Undetermined, message }).collect()
}
