//! Measurements whose unit may be another one than the declared one: far off what the equations compare them with, and near it
//! in that unit. A free source would take over what is off, so that such a column is refused where its header says no unit.

use std::collections::BTreeSet;

use nisp::Rest;
use nisp::units::Number;
use nisp_units::conversion;

use crate::error::PrepareError;

/// Scales that begin elsewhere, as headers name them and in words.
const SHIFTED: [(&str, &str); 2] = [("degC", "Celsius"), ("degF", "Fahrenheit")];
/// How much nearer measurements are to where they rest in the right unit, at most as a share.
const NEARER: f64 = 0.35;
/// What is on such a scale is this share of the other at most: an oven of 600 K stands in air of 293 K, not of 293 degrees.
const LOWER: f64 = 0.35;
/// How near the least measurement of a record is to where it rests in the right unit, as a share, where the rest goes past that in the wrong one.
const BEGINS: f64 = 0.03;
/// Factors between units, and those between units that have a time in them.
const FACTORS: [f64; 6] = [1e3, 1e-3, 1e2, 1e-2, 1e6, 1e-6];
const FACTORS_OF_TIME: [f64; 4] = [60.0, 1.0 / 60.0, 3600.0, 1.0 / 3600.0];
/// The second among the base units.
const SECOND: usize = 2;
/// Factors are looked for among measurements that are so many times larger or smaller than where they rest at least, and vary by
/// less than this factor; in the right unit they are this share of it off at most.
const FAR: f64 = 20.0;
const NARROW: f64 = 2.0;
const NEAR: f64 = 0.1;

/// A range of values.
type Range = [f64; 2];

/// Questions about the units of measurements, one for each column.
///
/// # Errors
/// The question of a column whose header says no unit.
pub(crate) fn doubts(rests: &[Rest], unlabelled: &[&'static str]) -> Result<Vec<String>, PrepareError> {
    let mut asked = BTreeSet::new();
    let mut refused = Vec::new();
    let mut said = Vec::new();
    for rest in rests {
        let Some(question) = question(rest).filter(|_| asked.insert(rest.column.name)) else { continue };
        let (name, unit) = (rest.column.name, rest.column.unit.text);
        if unlabelled.contains(&name) {
            refused.push(PrepareError::Unlabelled { question, name, unit });
        } else {
            said.push(question);
        }
    }
    if refused.is_empty() { Ok(said) } else { Err(PrepareError::all(refused)) }
}

fn question(rest: &Rest) -> Option<String> {
    let (name, unit) = (rest.column.name, rest.column.unit.text);
    let other = shifted(rest).or_else(|| scaled(rest))?;
    let range = |[low, high]: Range| {
        let [low, high] = [low, high].map(short);
        let ends = if low == high { format!("{low}") } else { format!("{low} to {high}") };
        format!("{ends} {unit}").trim_end().to_string()
    };
    let [low, high] = rest.measured;
    let low = if gap(rest.measured, rest.at) > 0.0 { low } else { rest.least };
    let measured = format!("`{name}` is measured at {}", range([low, high]));
    Some(match rest.by {
        Some((group, term)) => {
            format!("{measured}, and `{group}.{term}` would hold it at {} where nothing acts: {other}", range(rest.at))
        }
        None => format!("{measured}, and its bounds are {}: {other}", range(rest.at)),
    })
}

/// The question whether one of both is on a scale with another zero.
fn shifted(rest: &Rest) -> Option<String> {
    let apart = gap(rest.measured, rest.at);
    let nearer = |(header, words): &(&'static str, &'static str)| {
        let conversion = conversion(header, rest.column.unit.text)?;
        let moved = |range: Range| range.map(|x| conversion.of(Number::file(x)).as_declared());
        let is_low = |one: Range, other: Range| one[0] <= LOWER * other[1];
        let is_near = |one: Range, other: Range| is_low(one, other) && gap(moved(one), other) <= NEARER * apart;
        // A record in degrees Celsius that begins at rest and warms up passes the number of kelvins at which it should rest.
        let [least, resting] = [[rest.least; 2], [rest.at[0]; 2]];
        let begins = || is_low(least, resting) && gap(moved(least), resting) <= BEGINS * rest.at[0];
        let is_measured = if apart > 0.0 { is_near(rest.measured, rest.at) } else { begins() };
        (is_measured || apart > 0.0 && is_near(rest.at, rest.measured)).then_some((*header, *words, is_measured))
    };
    let found: Vec<_> = SHIFTED.iter().filter_map(nearer).collect();
    let &(header, _, is_measured) = found.first()?;
    let words: Vec<&str> = found.iter().map(|(_, words, _)| *words).collect();
    let (name, words) = (rest.column.name, words.join(" or "));
    Some(if is_measured {
        format!("is `{name}` in degrees {words}? say so in its header, as in `{name} [{header}]`")
    } else {
        format!("is what it is compared with in degrees {words}? give that in {}", rest.column.unit.text)
    })
}

/// The question whether one of both is in a unit of another size.
fn scaled(rest: &Rest) -> Option<String> {
    let [low, high] = magnitudes(rest.measured)?;
    let [from, to] = magnitudes(rest.at)?;
    let is_far = low > FAR * to || from > FAR * high;
    let is_alike = rest.measured[0].signum() == rest.at[0].signum();
    if !is_far || !is_alike || high > NARROW * low || to > NARROW * from {
        return None;
    }
    let suits = |factor: &f64| gap([factor * low, factor * high], [from, to]) <= NEAR * to;
    let has_time = rest.column.unit.exponents[SECOND] != 0.0;
    let factor = FACTORS.into_iter().chain(FACTORS_OF_TIME.into_iter().filter(|_| has_time)).find(suits)?;
    let (times, unit) = (short(factor.max(factor.recip())), rest.column.unit.text);
    Some(format!("is one of them in another unit, {times} times too large or small? give both in {unit}"))
}

/// The magnitudes of a range without zero.
fn magnitudes([low, high]: Range) -> Option<Range> {
    (low * high > 0.0).then(|| [low.abs().min(high.abs()), low.abs().max(high.abs())])
}

/// How far two ranges are apart.
fn gap(one: Range, other: Range) -> f64 {
    (one[0] - other[1]).max(other[0] - one[1]).max(0.0)
}

/// Three digits.
fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
