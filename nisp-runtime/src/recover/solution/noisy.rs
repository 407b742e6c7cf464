//! Noise of observations that goes with their level, as an answer shows it.

use super::Solution;
use crate::facts::Answer;
use crate::noise::{self, Noise};
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::driver::{Status, Warning};
use crate::solve::vector::root_mean_square;
use crate::units::Number;

impl Solution {
    /// The problem with measurements that count by how noisy they are, and what the user should know of it; nothing where the answer misses
    /// small values as far as large ones.
    pub(in crate::recover) fn with_noisiness(&mut self) -> Option<(Bound, Vec<Warning>)> {
        if !matches!(self.status, Status::Converged | Status::Inconsistent) {
            return None;
        }
        let (answer, noise) = (self.carried.answer(&self.bound), noise::estimate(&self.bound));
        let (mut bound, mut warnings) = (self.bound.clone(), Vec::new());
        let schema = self.scene();
        for (group, own) in schema.groups.iter().enumerate() {
            for (at, term) in own.terms.iter().enumerate().filter(|(_, term)| term.kind == TermKind::Observation) {
                if term.within.is_some() || self.bound.losses[group][at].is_robust() {
                    continue;
                }
                for (row, own) in noisy(&self.bound, &answer, (group, at), &noise) {
                    let deviation = noise.of(group, at).map_or(0.0, |noise| noise.deviation);
                    warnings.push(self.said(term, deviation, &own));
                    bound.noisiness[group][row] = own;
                }
            }
        }
        (!warnings.is_empty()).then_some((bound, warnings))
    }

    /// What the user should know of an observation of such a noise.
    fn said(&self, term: &schema::Term, deviation: f64, noisiness: &[f64]) -> Warning {
        let outward = self.bound.system.outward(&term.unit);
        let words = |value: f64| {
            let value = outward.of(Number::engine(deviation * value));
            format!("{value:.2e}{}", term.unit.behind())
        };
        let least = noisiness.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = noisiness.iter().copied().fold(0.0, f64::max);
        Warning::uneven_noise(term.name, [&words(least), &words(largest)])
    }
}

/// Rows of an observation whose noise goes with their level, and how noisy their points are beside each other.
fn noisy(bound: &Bound, answer: &Answer, (group, at): (usize, usize), noise: &Noise) -> Vec<(usize, Vec<f64>)> {
    let own = &bound.problem.scene().schema.groups[group];
    let term = &own.terms[at];
    let noise = noise.of(group, at);
    let is_exact = noise.is_some_and(|noise| noise.is_exact());
    let is_known = bound.noisiness[group][term.first..][..term.rows].iter().any(|own| !own.is_empty());
    if is_exact || is_known || answer.shared(group, at).is_some() || term.columns.len() != term.rows {
        return Vec::new();
    }
    let left = answer.facts[group].rows(bound.problem.scene().double()[group].programs, own, &answer.scalars);
    let of = |(number, &column): (usize, &usize)| {
        let row = term.first + number;
        let measured = &bound.columns[group][column];
        let is_there = bound.lacking(group, term).unwrap_or_else(|| vec![true; measured.len()]);
        let mut there: Vec<usize> = (0..measured.len()).filter(|&p| is_there[p]).collect();
        let is_record = bound.problem.scene().schema.coordinates.len() == 1;
        if is_record {
            there.sort_by(|&a, &b| bound.coordinates[group][a].total_cmp(&bound.coordinates[group][b]));
        }
        let misfits: Vec<f64> = there.iter().map(|&p| left[row][p]).collect();
        let values: Vec<f64> = there.iter().map(|&p| measured[p] + left[row][p]).collect();
        if noise.is_some_and(|noise| noise.is_followed(root_mean_square(misfits.iter().copied()))) {
            return None;
        }
        let found = noise::of_answer(&values, &misfits, is_record)?;
        let mut noisiness = vec![1.0; measured.len()];
        there.iter().zip(found).for_each(|(&p, found)| noisiness[p] = found);
        Some((row, noisiness))
    };
    term.columns.iter().enumerate().filter_map(of).collect()
}
