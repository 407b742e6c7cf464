//! Noise of observations that goes with their level, as an answer shows it.

use super::Solution;
use crate::ends::ends;
use crate::facts::Answer;
use crate::noise::{self, Noise};
use crate::problem::{Bound, LEFT_OUT};
use crate::schema::TermKind;
use crate::solve::driver::{Status, Warning};
use crate::solve::vector::root_mean_square;
use crate::units::Number;

impl Solution {
    /// The problem with measurements that count by how noisy they are; nothing where the answer misses small values as far as large ones, or
    /// follows values that stand alone.
    pub(in crate::recover) fn with_noisiness(&mut self) -> Option<Bound> {
        if !matches!(self.status, Status::Converged | Status::Inconsistent) {
            return None;
        }
        if self.verdict.failed().any(|check| check.check == "outliers") {
            return None;
        }
        let (answer, noise) = (self.carried.answer(&self.bound), noise::estimate(&self.bound));
        let mut bound = None;
        for (group, own) in self.scene().groups.iter().enumerate() {
            for (at, term) in own.terms.iter().enumerate().filter(|(_, term)| term.kind == TermKind::Observation) {
                if term.within.is_some() || self.bound.losses[group][at].is_robust() {
                    continue;
                }
                for (row, own) in noisy(&self.bound, &answer, (group, at), &noise) {
                    bound.get_or_insert_with(|| self.bound.clone()).noisiness[group][row] = own;
                }
            }
        }
        bound
    }

    /// What the user should know of observations whose values count by how noisy they are, or are left out by themselves.
    pub(super) fn uneven_noise(&self, noise: &Noise) -> Vec<Warning> {
        let groups = self.scene().groups.iter().enumerate();
        let terms =
            groups.flat_map(|(group, own)| own.terms.iter().enumerate().map(move |(at, term)| (group, at, term)));
        let of = |(group, at, term): (usize, usize, &crate::schema::Term)| {
            let rows = &self.bound.noisiness[group][term.first..][..term.rows];
            let out = rows.iter().flatten().filter(|own| **own == LEFT_OUT).count();
            if !rows.iter().all(Vec::is_empty) && self.bound.problem.loss(term).is_robust() {
                return Some(Warning::left_out(term.name, out));
            }
            let (least, largest) = ends(rows.iter().flatten().copied());
            let deviation = noise.of(group, at)?.deviation;
            let words = |value: f64| {
                let value = self.bound.system.outward(&term.unit).of(Number::engine(deviation * value));
                format!("{value:.2e}{}", term.unit.behind())
            };
            (least < largest).then(|| Warning::uneven_noise(term.name, [&words(least), &words(largest)]))
        };
        terms.filter_map(of).collect()
    }
}

/// Rows of an observation whose noise goes with their level or is larger in a part of a record, and how noisy their points are beside each
/// other.
fn noisy(bound: &Bound, answer: &Answer, (group, at): (usize, usize), noise: &Noise) -> Vec<(usize, Vec<f64>)> {
    let schema = bound.problem.scene().schema;
    let own = &schema.groups[group];
    let term = &own.terms[at];
    let noise = noise.of(group, at);
    let is_known = bound.noisiness[group][term.first..][..term.rows].iter().any(|own| !own.is_empty());
    let is_exact = noise.is_some_and(|noise| noise.is_exact());
    if is_exact || is_known || answer.shared(group, at).is_some() || term.columns.len() != term.rows {
        return Vec::new();
    }
    let left = answer.facts[group].rows(bound.problem.scene().double()[group].programs, own, &answer.scalars);
    let is_record = schema.coordinates.len() == 1;
    let of = |(number, &column): (usize, &usize)| {
        let row = term.first + number;
        let measured = &bound.columns[group][column];
        let is_there = bound.lacking(group, term).unwrap_or_else(|| vec![true; measured.len()]);
        let mut there: Vec<usize> = (0..measured.len()).filter(|&p| is_there[p]).collect();
        if is_record {
            there.sort_by(|&a, &b| bound.coordinates[group][a].total_cmp(&bound.coordinates[group][b]));
        }
        let misfits: Vec<f64> = there.iter().map(|&p| left[row][p]).collect();
        let values: Vec<f64> = there.iter().map(|&p| measured[p] + left[row][p]).collect();
        if noise.is_some_and(|noise| noise.is_followed(root_mean_square(misfits.iter().copied()))) {
            return None;
        }
        let measured: Vec<f64> = there.iter().map(|&p| measured[p]).collect();
        let by_parts = || if is_record { noise::along(&measured, &misfits) } else { None };
        let found = noise::of_answer(&values, &misfits, is_record).or_else(by_parts)?;
        let mut noisiness = vec![1.0; is_there.len()];
        there.iter().zip(found).for_each(|(&p, found)| noisiness[p] = found);
        Some((row, noisiness))
    };
    term.columns.iter().enumerate().filter_map(of).collect()
}
