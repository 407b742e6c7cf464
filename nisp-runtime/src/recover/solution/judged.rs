//! The verdict on an answer, and what it is called for it.

use super::Solution;
use crate::facts::Told;
use crate::noise::{self, Noise};
use crate::recover::over_domain::where_is;
use crate::solve::driver::{Status, WarningKind};
use crate::verdict::{Check, determined, faint, judge, jumps};

impl Solution {
    /// Judges the answer by what is left of the problem, and calls it by its name.
    pub(super) fn judged(mut self) -> Self {
        /// Size of a source in its deviations above which exact data leave nothing open of it.
        const PLAIN: f64 = 100.0;
        let noise = noise::estimate(&self.bound);
        self.warnings.extend(self.uneven_noise(&noise));
        self.warnings.extend(self.bound.alone());
        let mut answer = self.carried.answer(&self.bound);
        let values = self.values_over_domain();
        let edges = self.edges(&values);
        let values = self.where_read(&values, &answer);
        self.is_met_exactly = self.meets_data_exactly(&noise)
            && answer.told.iter().all(|told| told.size.is_some_and(|size| size > PLAIN));
        // Deviations are of an end that the run did not come to.
        if self.status == Status::Budget
            && !self.is_met_exactly
            && noise.clone().with_clouds(&self.bound).is_there(self.scene())
        {
            let sources = (0..self.scene().heads.len()).filter(|&head| self.scene().heads[head].source);
            answer.told = sources.map(Told::unasked).collect();
        }
        self.verdict = judge(&self.bound, &answer, &values, &noise);
        if let Some(prior) = self.settings.carrier.patches_everywhere(self.scene()) {
            let (points, read) = (self.points_over_domain(), self.read_over_domain(&answer));
            let mut checks = Vec::new();
            for (at, head) in self.scene().heads.iter().enumerate().filter(|(_, head)| head.source) {
                let level = prior.least(&self.bound, at);
                checks.push(faint::patches(head.name, &values[at], level));
                if self.bound.is_off_over_regions() {
                    let places = where_is(&points, &read[at]);
                    checks.push(faint::faint(head.name, (&values[at], &places), level));
                }
            }
            self.verdict.checks.extend(checks);
        }
        let of_head = |head: usize, places: &[f64]| self.carried.values(&self.bound, places).swap_remove(head).values;
        self.verdict.checks.extend(jumps::checks(&self.bound, &noise, &of_head).into_iter().chain(edges));
        self.verdict.checks.extend(self.left_open());
        match (self.status, self.verdict.passed()) {
            (Status::Budget, true) if self.is_met_exactly && self.has_room() => self.status = Status::Converged,
            (Status::Converged, false) => self.status = Status::Inconsistent,
            // A minimum at the floor of rounding has no gradient to speak of, whatever the method made of it.
            (Status::NotConverged, true) if self.is_at_floor() => {
                self.status = Status::Converged;
                self.warnings.retain(|warning| warning.kind != WarningKind::Stagnation);
            }
            _ => {}
        }
        self
    }

    /// True where data over several coordinates are met to the digits that they are usually written with: they have no noise to
    /// speak of, whatever parabolas through neighbours seemed to show, and going on would fit their rounding. Differences along
    /// a record tell noise from its course better than a fit, which may follow both.
    fn meets_data_exactly(&mut self, noise: &Noise) -> bool {
        let mut is_measured = false;
        if self.scene().coordinates.len() == 1 {
            return false;
        }
        for (group, schema) in self.scene().groups.iter().enumerate() {
            for at in 0..schema.terms.len() {
                let Some(of) = noise.of(group, at) else { continue };
                let (misfits, _) = self.carried.misfits(group, at);
                let rms = (misfits.iter().map(|x| x * x).sum::<f64>() / misfits.len().max(1) as f64).sqrt();
                if !noise::is_exact(rms, of.spread) {
                    return false;
                }
                is_measured = true;
            }
        }
        is_measured
    }

    /// True where every check is met ten times better than it must be.
    fn has_room(&self) -> bool {
        self.verdict.checks.iter().all(|check| check.check == "range" || check.value <= 0.1 * check.limit)
    }

    /// What is left open where nothing is measured: any answer would be as good, and no error bars say so.
    fn left_open(&self) -> Option<Check> {
        if !self.scene().observed().is_empty() || self.status == Status::NotConverged {
            return None;
        }
        let warning = self.warnings.iter().find(|warning| warning.kind == WarningKind::Undetermined)?;
        Some(determined(self.scene().heads[0].name, warning.message.clone()))
    }

    /// True where rows are met to the root of the precision: their squares drown in rounding.
    fn is_at_floor(&self) -> bool {
        let rows: usize = self.groups().map(|(group, points)| group.rows * points).sum();
        self.loss <= f64::EPSILON * rows as f64
    }
}
