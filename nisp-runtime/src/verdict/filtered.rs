//! Rows that are not as they were measured: filtered, averaged or interpolated, as they and their noise say.

use std::ops::Range;

use super::misfits::Misfits;
use super::moving::{self, Average};
use super::{Check, interpolated, root_mean_square};
use crate::noise::in_order;
use crate::shared_noise::{Alike, SharedNoise, spacing};

/// Lengths of smooth noise from which on two rows hardly share any: a tenth.
const APART: f64 = 2.3;

/// Rows that an answer needs, at least.
const ENOUGH: f64 = 20.0;

/// Rows up to which smooth noise and noise that changes as a walk does are alike.
const LEAST: f64 = 2.0;

/// By how much likelier a moving average has to be than none, and than another, in all and for every row: a logarithm. The course of a signal
/// may look a little like one at every row.
const LIKELIER: f64 = 8.0;
const BY_ROW: f64 = 0.1;

/// How much larger than what an answer leaves the noise of a moving average may be: the answer follows a part of it. What is larger than that is the
/// signal.
const FOLLOWED: f64 = 6.0;

/// Differences between distances that are rounding, as a share.
const EVEN: f64 = 1e-3;

/// Checks of an observation. A filter keeps noise that changes as slowly as a source does. A moving average of the rows before is late, and
/// interpolated rows count what was measured more than once.
pub(super) fn checks(left: &Misfits, shared: Option<SharedNoise>) -> Vec<Check> {
    let mut checks: Vec<Check> = smooth(left, shared).into_iter().collect();
    // Outliers that come again and again are alike to an average.
    if left.is_record() && !left.is_exact() && !left.is_robust {
        checks.extend((0..left.term.columns.len()).filter_map(|number| treated(left, number)));
    }
    checks
}

/// Noise that is smooth from row to row.
fn smooth(left: &Misfits, shared: Option<SharedNoise>) -> Option<Check> {
    let shared = shared.filter(|own| own.alike == Alike::Smooth)?;
    let rows = shared.length / spacing(&left.places)?;
    let every = (APART * rows).ceil().max(2.0);
    let fewer = if every * ENOUGH <= left.places.len() as f64 {
        format!(", or only one of every {every}")
    } else {
        String::new()
    };
    let said = format!(
        "the noise of `{0}` is smooth over about {rows:.1} rows, as a filter leaves it, and a source takes what of it changes more slowly: give the \
         rows as they were measured{fewer}, or say how exact they are (`observe {0} within ...`)",
        left.term.name
    );
    Some(Check::new("filtered", left.name(), (rows, LEAST), said))
}

/// A column that was interpolated, or that went through a moving average.
fn treated(left: &Misfits, number: usize) -> Option<Check> {
    let (bound, term) = (left.bound, left.term);
    let column = term.columns[number];
    let values = bound.measured(left.group, term, &bound.columns[left.group][column]);
    let run = even(&in_order(&left.places, &left.places));
    let values = &in_order(&left.places, &values)[run];
    let name = bound.problem.scene().schema.groups[left.group].columns[column].name;
    if let Some(every) = interpolated::one_of(values) {
        let said = format!(
            "only one of {every} rows of `{name}` was measured: those between lie on straight lines, as interpolation makes them, and count \
             what was measured more than once; leave their cells empty"
        );
        return Some(Check::new("filtered", left.name(), (every as f64, 1.0), said));
    }
    let found = moving::of(values)?;
    let rows = found.average.rows();
    let said = match found.average {
        Average::Mean(_) => format!(
            "the rows of `{name}` are running means of {rows}: a source takes the noise that they share, and means of the rows before are late \
             by {} rows; give the rows as they were measured, or one of every {rows}, each at the middle of the time that it is the mean of",
            (rows as f64 - 1.0) / 2.0
        ),
        Average::Parabola(_) => format!(
            "the rows of `{name}` went through a moving fit over {rows} rows (Savitzky-Golay), and a source takes the noise that they share: \
             give the rows as they were measured"
        ),
    };
    let is_noise = found.deviation <= FOLLOWED * root_mean_square(left.plain.get(number)?.iter().copied());
    let limit = LIKELIER.max(BY_ROW * found.of as f64);
    is_noise.then(|| Check::new("filtered", left.name(), (found.gain.max(0.0), limit), said))
}

/// The longest run of places that are as far apart as the next.
fn even(places: &[f64]) -> Range<usize> {
    let (mut longest, mut first) = (0..places.len().min(1), 0);
    for next in 2..=places.len() {
        let apart = |at: usize| places[at] - places[at - 1];
        if next > 2 && (apart(next - 1) - apart(next - 2)).abs() > EVEN * apart(next - 2) {
            first = next - 2;
        }
        if next - first > longest.len() {
            longest = first..next;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::even;

    #[test]
    fn the_longest_even_run_is_found() {
        assert_eq!(even(&[]), 0..0);
        assert_eq!(even(&[1.0]), 0..1);
        assert_eq!(even(&[0.0, 1.0, 2.0, 3.0]), 0..4);
        assert_eq!(even(&[0.0, 1.0, 2.0, 5.0, 8.0, 11.0, 14.0, 15.0]), 2..7);
    }
}
