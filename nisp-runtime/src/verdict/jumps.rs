//! Sources of a record that jolt, or that make up for what leaps in it.

use super::leaps::{Leap, leaps};
use super::{Check, jolts, leaps as leaping};
use crate::noise::{Noise, median};
use crate::problem::Bound;
use crate::schema::{Head, TermKind};

/// Checks of the sources of a record: `values` are those of a head at places in the engine's units.
pub(crate) fn checks(bound: &Bound, noise: &Noise, values: &dyn Fn(usize, &[f64]) -> Vec<f64>) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    let sources = || schema.heads.iter().enumerate().filter(|(_, head)| head.source);
    if schema.coordinates.len() != 1 || sources().next().is_none() {
        return Vec::new();
    }
    let groups = schema.groups.iter().zip(&bound.coordinates);
    let observed = groups.filter(|(group, _)| group.terms.iter().any(|term| term.kind == TermKind::Observation));
    let Some(mut rows) = observed.map(|(_, rows)| rows.clone()).max_by_key(Vec::len) else { return Vec::new() };
    rows.sort_by(f64::total_cmp);
    let Some(spacing) = median(rows.windows(2).map(|pair| pair[1] - pair[0]).collect()) else { return Vec::new() };
    let between = rows.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
    let places: Vec<f64> = between.chain(rows.last().copied()).collect();
    let leaps = of_record(bound, noise);
    let words = |place: f64| bound.place(&[place]);
    let check = |(at, head): (usize, &Head)| {
        let course: Vec<(f64, f64)> = places.iter().copied().zip(values(at, &places)).collect();
        let course = (&course[..], spacing);
        let leap = |(column, leap): &(_, Leap)| leaping::check((head.name, *column), *leap, course, words);
        let jolt = jolts::check(head.name, course, words).filter(|jolt| !jolt.passed);
        jolt.or_else(|| leaps.iter().find_map(leap))
    };
    sources().filter_map(check).collect()
}

/// Where measured columns leap.
fn of_record(bound: &Bound, noise: &Noise) -> Vec<(&'static str, Leap)> {
    let schema = bound.problem.scene().schema;
    let mut found = Vec::new();
    for of in &noise.observations {
        let group = &schema.groups[of.group];
        for &column in group.terms[of.term].columns {
            let values = bound.columns[of.group][column].iter().copied();
            let mut rows: Vec<(f64, f64)> = bound.coordinates[of.group].iter().copied().zip(values).collect();
            rows.retain(|(_, value)| !value.is_nan());
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.extend(leaps(&rows, of.deviation).into_iter().map(|leap| (group.columns[column].name, leap)));
        }
    }
    found
}
