//! Learned scalars of which little more is known than that sources are small.

use super::{Check, determined};
use crate::facts::{LARGER, Leaning};
use crate::problem::Bound;

/// How far a scalar may move, as a share of itself or of its natural size, where sources may be larger. Where sources are zero or
/// constant over parts of a record scalars move by less than a hundredth, where they follow what is measured by a fifth and more.
pub(crate) const FARTHEST: f64 = 0.1;
/// How far it may move in its own deviations, where the smoothest kind of sources was asked, too, and in all: what is as many times
/// larger as the sources are is known by their size alone. Of 44 springs, motors and rooms beside waves, steps and smooth forces none was
/// called known wrongly with this; with 2 three were, four to eleven deviations off, and eight right ones more were called known.
const SURE: f64 = 1.2;
const SCALES: f64 = 0.8;
/// The largest deviation of a scalar that is known, as a share of itself or of its natural size. A larger one is that of a logarithm, and
/// as a deviation of the scalar too short to one side.
const OPEN: f64 = 0.5;
/// The same of a scalar that the whole evidence did not find, and that is more sure than it should be.
const UNWEIGHED: f64 = 0.15;

/// How far a scalar may move.
pub(crate) fn limit(found: &Leaning) -> f64 {
    let sure = if found.is_weighed { SURE * found.deviation.unwrap_or(0.0) } else { 0.0 };
    FARTHEST.max(sure.min(SCALES))
}

/// Share of what is known of a scalar that a belief may say.
const BELIEVED: f64 = 0.5;

/// Checks for every scalar that is learned beside sources: how far it moves, and whether it is known at all. One of which neither can be
/// said fails.
pub(super) fn checks(bound: &Bound, leaning: &[Leaning]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    let check = |(learned, found): (&crate::engine::Learned, &Leaning)| {
        let name = schema.scalars[learned.slot].name;
        let moves = found.moved.map(|moved| {
            let said = format!(
                "learned `{name}` moves by {:.0} % where sources may be {LARGER} times as large: little more is known of it than that \
                 it leaves them small; give it, or measure a source, or a part of the record in which sources are known",
                100.0 * moved
            );
            Check::new("leaning", ("", name), (moved, limit(found)), said)
        });
        // Where the whole evidence tells of a scalar, its deviation counts the prior for as little as it is worth.
        let by_prior = found.by_prior.filter(|_| !found.is_weighed).map(|share| {
            let said = format!(
                "{:.0} % of what is known of learned `{name}` is the belief that sources are as rough all along, which no data say; give it, \
                 or measure a source, or a part of the domain in which sources are known",
                100.0 * share
            );
            Check::new("believed", ("", name), (share, BELIEVED), said)
        });
        let is_known = found.deviation.map(|deviation| {
            let said = format!(
                "the data do not determine `{name}` beside the sources: its deviation is {:.0} % of it; give it, or a belief about \
                 it (`learn {name} within ...`), or measure a source",
                100.0 * deviation
            );
            Check::new("determined", ("", name), (deviation, if found.is_weighed { OPEN } else { UNWEIGHED }), said)
        });
        // A run that its budget ended was asked neither: its scalar may be anything.
        let is_asked = found.moved.is_some() || found.deviation.is_some();
        let unasked = (!is_asked).then(|| {
            determined(
                name,
                format!(
                    "the run ended before it was told whether the data determine `{name}` beside the sources: give a larger budget, or \
                     more iterations"
                ),
            )
        });
        moves.into_iter().chain(by_prior).chain(is_known).chain(unasked)
    };
    bound.learned.iter().zip(leaning).flat_map(check).collect()
}
