//! Values that stand alone, where a robust loss leaves out more than those.

use super::Solution;
use crate::noise::{self, in_order};
use crate::problem::Bound;
use crate::problem::LEFT_OUT;
use crate::schema::TermKind;
use crate::solve::driver::Status;
use crate::verdict::outliers;

impl Solution {
    /// The problem with a squared loss, without the values of a record that stand alone; nothing where a robust loss leaves out no more than
    /// outliers. Where a source acts for a short time, a smooth one that leaves out what it did may be a minimum, too.
    pub(in crate::recover) fn without_strays(&self) -> Option<Bound> {
        let has_left_out = self.verdict.failed().any(|check| check.check == "left");
        if !has_left_out || self.status != Status::Inconsistent || self.scene().coordinates.len() != 1 {
            return None;
        }
        let (noise, mut bound) = (noise::estimate(&self.bound), self.bound.clone());
        for (group, own) in self.scene().groups.iter().enumerate() {
            for (at, term) in own.terms.iter().enumerate() {
                let is_robust = term.kind == TermKind::Observation && bound.losses[group][at].is_robust();
                let Some(noise) = noise.of(group, at).filter(|_| is_robust && term.columns.len() == term.rows) else {
                    continue;
                };
                let points = bound.coordinates[group].len();
                let is_there = bound.lacking(group, term).unwrap_or_else(|| vec![true; points]);
                let there: Vec<f64> = (0..points).filter(|&p| is_there[p]).map(|p| p as f64).collect();
                let places = bound.measured(group, term, &bound.coordinates[group]);
                let [order, sorted] = [&there, &places].map(|own| in_order(&places, own));
                for (row, &column) in (term.first..).zip(term.columns) {
                    let values = in_order(&places, &bound.measured(group, term, &bound.columns[group][column]));
                    let (alone, _) = outliers::weight(&sorted, &values, &vec![noise.deviation; values.len()]);
                    let mut noisiness = vec![1.0; points];
                    alone.into_iter().for_each(|number| noisiness[order[number] as usize] = LEFT_OUT);
                    bound.noisiness[group][row] = noisiness;
                }
            }
        }
        bound.take_noisiness();
        Some(bound)
    }
}
