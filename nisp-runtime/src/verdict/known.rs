//! What an answer rests on: given numbers, and the frame of every cloud.
//!
//! A source is free to take over what a wrong number leaves: a gas pressure ten per cent too high is a contact force of a few
//! newtons more, and the surface fits. But sources are believed to be few and the rest of the body to be free, so that the answer
//! would be likelier with the right number. Other sources take over most of it, and leave a little in the data. Rao's score test says so
//! without a second solve (`local/scored.rs`).

use super::Check;
use crate::facts::{CloudFacts, Known, Score};
use crate::problem::Bound;
use crate::solve::vector::spread;
use crate::units::{Number, Scale};

/// What the loss may gain where a prior for few sources takes part, five standard deviations; and where data and equations alone do, four and
/// a half. Of two hundred right answers to equations of fifteen kinds none gained more than seven.
const GAIN: f64 = 12.5;
pub(crate) const GAIN_OF_DATA: f64 = 10.0;
/// Changes that are not told from what a prior for few sources gains by a smaller one: shares of a number, of a cloud's radius or
/// size, and angles.
const SLIGHT: f64 = 0.05;

/// What is known, in the engine's units: scalars by their slots, and clouds.
#[derive(Clone, Copy)]
pub(crate) struct Values<'a> {
    pub(crate) scalars: &'a [f64],
    pub(crate) clouds: &'a [CloudFacts],
}

/// A check of what would gain most; none where nothing is known of that, or where a cloud may be off over whole regions, which
/// any number would make up for.
pub(crate) fn check(bound: &Bound, scores: &[Score], known: Values<'_>) -> Option<Check> {
    if bound.is_off_over_regions() {
        return None;
    }
    let limit = if scores.iter().any(|score| score.by_prior) { GAIN } else { GAIN_OF_DATA };
    let matters = |score: &Score| if score.change.abs() > SLIGHT { score.gain } else { score.gain.min(limit) };
    let mut sorted: Vec<&Score> = scores.iter().collect();
    sorted.sort_by(|a, b| matters(b).total_cmp(&matters(a)));
    let most = matters(sorted.first()?);
    // What gains half as much may be meant as well. A number that makes no sense is named where nothing else is.
    let mut likely: Vec<&Score> = sorted.into_iter().filter(|score| matters(score) > 0.5 * most).collect();
    likely.sort_by_key(|score| !may_be(bound, known, score));
    let (&first, others) = likely.split_first()?;
    let others = others.iter().filter(|other| may_be(bound, known, other));
    let others: Vec<String> = others.take(3).map(|other| said(bound, known, other)).collect();
    let has_source = bound.problem.scene().schema.heads.iter().any(|head| head.source);
    let or = if others.is_empty() { String::new() } else { format!(", or {}", others.join(", or ")) };
    let message = format!(
        "with {}{or} the answer would be likelier by {:.0} in the logarithm of its probability; where that is much, check what is \
         given{}",
        said(bound, known, first),
        first.gain,
        if has_source { ": the source takes over what is wrong with it" } else { "" }
    );
    let place = match first.known {
        Known::Scalar(slot) => ("", bound.problem.scene().schema.scalars[slot].name),
        Known::Offset { group, column } | Known::Standing { group, column } => {
            let group = &bound.problem.scene().schema.groups[group];
            (group.name, group.columns[column].name)
        }
        Known::Place { cloud, .. } | Known::Direction { cloud, .. } | Known::Size { cloud } => {
            let cloud = &known.clouds[cloud];
            (bound.problem.scene().schema.groups[cloud.group].name, cloud.term)
        }
    };
    Some(Check::new("given", place, (most, limit), message))
}

/// False of a number that would be outside of its declared range.
fn may_be(bound: &Bound, known: Values<'_>, score: &Score) -> bool {
    let Known::Scalar(slot) = score.known else { return true };
    let scalar = &bound.problem.scene().schema.scalars[slot];
    let changed = Number::engine(known.scalars[slot] * (1.0 + score.change));
    let changed = bound.system.size(&scalar.unit).of(changed);
    scalar.lower.is_none_or(|lower| changed >= lower) && scalar.upper.is_none_or(|upper| changed <= upper)
}

/// Something known as it should rather be.
fn said(bound: &Bound, known: Values<'_>, score: &Score) -> String {
    let schema = bound.problem.scene().schema;
    let term = |cloud: usize| {
        let cloud = &known.clouds[cloud];
        let terms = schema.groups[cloud.group].terms.iter();
        (cloud.term, terms.filter(|term| term.name == cloud.term).map(|term| term.unit).next())
    };
    let axis = |axis: usize| ["x", "y", "z"][axis];
    match score.known {
        Known::Scalar(slot) => {
            let scalar = &schema.scalars[slot];
            let now = bound.system.outward(&scalar.unit).of(Number::engine(known.scalars[slot])).as_declared();
            let unit = scalar.unit.behind();
            format!("`{}` about {:.3e}{unit} instead of {now:.3e}{unit}", scalar.name, now * (1.0 + score.change))
        }
        Known::Offset { group, column } | Known::Standing { group, column } => {
            let column_of = &schema.groups[group].columns[column];
            let by = score.change * bound.spread_of(group, column);
            let by = bound.system.outward(&column_of.unit).of(Number::engine(by)).as_declared();
            let stands = matches!(score.known, Known::Standing { .. });
            let place = if stands { "where it stands still" } else { "all along" };
            format!("{by:.2e}{} added to `{}` {place}", column_of.unit.behind(), column_of.name)
        }
        Known::Place { cloud, axis: at } => {
            let (name, unit) = term(cloud);
            let (outward, text) = unit.map_or((Scale::new(1.0), ""), |unit| (bound.system.outward(&unit), unit.text));
            let (_, radius) = spread(known.clouds[cloud].points.iter().map(|&point| point.into()));
            let moved = outward.of(Number::engine(score.change * radius));
            format!("`{name}` moved by {moved:.1e} {text} along {}", axis(at))
        }
        Known::Direction { cloud, axis: at } => {
            format!("`{}` turned by {:.1} degrees about {}", term(cloud).0, score.change.to_degrees(), axis(at))
        }
        Known::Size { cloud } => {
            let how = if score.change > 0.0 { "larger" } else { "smaller" };
            format!("`{}` {how} by {:.1} %", term(cloud).0, 100.0 * score.change.abs())
        }
    }
}
