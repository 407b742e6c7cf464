//! Sources of a record that jolt, or that make up for what leaps in it.

use super::Solution;
use crate::carrier::Estimate;
use crate::noise::{Noise, median};
use crate::schema::{Head, TermKind};
use crate::units::Number;
use crate::verdict::leaps::{Leap, leaps};
use crate::verdict::{Check, jolts, leaps as leaping};

impl Solution {
    /// Checks of sources that jolt in a record, and of those that make up for leaps of it.
    pub(super) fn jolts(&self, noise: &Noise) -> Vec<Check> {
        let [coordinate] = self.scene().coordinates else { return Vec::new() };
        if !self.scene().heads.iter().any(|head| head.source) {
            return Vec::new();
        }
        let groups = self.scene().groups.iter().zip(&self.bound.coordinates);
        let observed = groups.filter(|(group, _)| group.terms.iter().any(|term| term.kind == TermKind::Observation));
        let Some(mut rows) = observed.map(|(_, rows)| rows.clone()).max_by_key(Vec::len) else { return Vec::new() };
        rows.sort_by(f64::total_cmp);
        let Some(spacing) = median(rows.windows(2).map(|pair| pair[1] - pair[0]).collect()) else { return Vec::new() };
        let between = rows.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        let places: Vec<f64> = between.chain(rows.last().copied()).collect();
        let outward = self.bound.system.outward(&coordinate.unit);
        let declared: Vec<f64> = places.iter().map(|&x| outward.of(Number::engine(x)).as_declared()).collect();
        let sources = self.evaluate(&declared).into_iter().zip(self.scene().heads).filter(|(_, head)| head.source);
        let leaps = self.leaps(noise);
        let words = |place: f64| self.bound.place(&[place]);
        let check = |(estimate, head): (Estimate, &Head)| {
            let course: Vec<(f64, f64)> = places.iter().copied().zip(estimate.values).collect();
            let course = (&course[..], spacing);
            let leap = |(column, leap): &(_, Leap)| leaping::check((head.name, *column), *leap, course, words);
            jolts::check(head.name, course, words).or_else(|| leaps.iter().find_map(leap))
        };
        sources.filter_map(check).collect()
    }

    /// Where measured columns leap.
    fn leaps(&self, noise: &Noise) -> Vec<(&'static str, Leap)> {
        let mut found = Vec::new();
        for of in &noise.observations {
            let group = &self.scene().groups[of.group];
            for &column in group.terms[of.term].columns {
                let values = self.bound.columns[of.group][column].iter().copied();
                let mut rows: Vec<(f64, f64)> = self.bound.coordinates[of.group].iter().copied().zip(values).collect();
                rows.retain(|(_, value)| !value.is_nan());
                rows.sort_by(|a, b| a.0.total_cmp(&b.0));
                found.extend(leaps(&rows, of.deviation).into_iter().map(|leap| (group.columns[column].name, leap)));
            }
        }
        found
    }
}
