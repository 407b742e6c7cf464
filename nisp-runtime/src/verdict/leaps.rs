//! Records that leap from one row to the next where a source makes up for it within a few rows. Something that is added at once does that, and
//! so does a sensor that was moved or changed its range or unit, whose rows behind are then of something else. The record does not tell one from
//! the other.

use super::Check;
use crate::noise::median;

/// A leap over its noise, and over the changes before and after it, at least.
const FAR: f64 = 10.0;
const ALONE: f64 = 4.0;
/// A leap over what others change by, all but one of fifty and all but so many as may be leaps, at most.
const LARGEST: f64 = 3.0;
const OTHERS: f64 = 0.98;
/// How far the two rows of a leap are apart, at most, in the rows' usual distance: one between them may lack.
const LACKING: f64 = 2.5;
/// What happens more often is of the system, and so is what happens more often than the second to one side only: a dose that is given again
/// and again. A part of a record that was moved or exchanged has leaps to both sides.
const OFTEN: usize = 4;
const OFTEN_TO_ONE_SIDE: usize = 2;
/// A source at a leap beside what it is elsewhere around there, at most of these places, at least.
const PEAK: f64 = 3.0;
/// Rows up to which a smooth source rises and falls again at a leap, and up to which places are around there.
const AT: f64 = 4.0;
const AROUND: f64 = 16.0;

/// A leap of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leap {
    /// The places of its two rows.
    pub(crate) rows: [f64; 2],
    /// How large it is beside the changes of others.
    size: f64,
}

/// Where a record leaps: places that rise, what was measured there, and its noise.
pub(crate) fn leaps(rows: &[(f64, f64)], noise: f64) -> Vec<Leap> {
    let change = |at: usize| (rows[at + 1].1 - rows[at].1).abs();
    let mut changes: Vec<f64> = (1..rows.len()).map(|at| change(at - 1)).collect();
    changes.sort_by(f64::total_cmp);
    let Some(last) = changes.len().checked_sub(1 + OFTEN) else { return Vec::new() };
    let others = changes[last.min((OTHERS * changes.len() as f64) as usize)];
    let Some(spacing) = median(rows.windows(2).map(|pair| pair[1].0 - pair[0].0).collect()) else { return Vec::new() };
    let is_leap = |at: &usize| {
        let beside = change(at - 1).max(change(at + 1));
        change(*at) > FAR * noise && change(*at) > ALONE * beside && rows[at + 1].0 - rows[*at].0 <= LACKING * spacing
    };
    let all = (1..rows.len().saturating_sub(2)).filter(is_leap);
    let leap = |at: usize| Leap { rows: [rows[at].0, rows[at + 1].0], size: change(at) / others };
    let found: Vec<usize> = all.filter(|&at| change(at) > LARGEST * others).collect();
    let rising = found.iter().filter(|&&at| rows[at + 1].1 > rows[at].1).count();
    let most = if rising == 0 || rising == found.len() { OFTEN_TO_ONE_SIDE } else { OFTEN };
    if found.len() <= most { found.into_iter().map(leap).collect() } else { Vec::new() }
}

/// One check for a source that makes up for a leap of a measured column: its places and values, at every row and between, how far rows are
/// apart, and how a place is written.
pub(crate) fn check(
    (name, column): (&'static str, &'static str),
    leap: Leap,
    (course, spacing): (&[(f64, f64)], f64),
    words: impl Fn(f64) -> String,
) -> Option<Check> {
    if !is_peak(course, leap.rows, spacing) {
        return None;
    }
    let [from, to] = leap.rows.map(words);
    let said = format!(
        "`{column}` leaps from {from} to {to}, {:.0} times as far as it changes between other rows, and `{name}` makes up for it there alone. If a \
         sensor was moved, or changed its range or unit, all values behind it are off: solve the parts by themselves. If something was added at \
         once, rows that are closer there show it",
        leap.size
    );
    Some(Check::new("jolt", ("", name), (leap.size, LARGEST), said))
}

/// True where a course has a peak at a leap between two rows, or jolts there.
fn is_peak(course: &[(f64, f64)], [from, to]: [f64; 2], spacing: f64) -> bool {
    let apart = |x: f64| (from - x).max(x - to) / spacing;
    let around = course.iter().filter(|(x, _)| (AT..=AROUND).contains(&apart(*x)));
    let around: Vec<f64> = around.map(|(_, value)| *value).collect();
    let Some(usual) = median(around.clone()) else { return false };
    let most = around.iter().map(|value| (value - usual).abs()).fold(0.0, f64::max);
    let at_leap =
        course.iter().filter(|(x, _)| apart(*x) < AT).map(|(_, value)| (value - usual).abs()).fold(0.0, f64::max);
    at_leap > PEAK * most
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..200).map(|at| (f64::from(at), of(f64::from(at)))).collect()
    }

    #[test]
    fn a_record_that_is_rescaled_leaps_and_one_that_moves_does_not() {
        let wave = |t: f64| 3.0 + (0.05 * t).sin();
        let rescaled = leaps(&record(|t| wave(t) * if t > 120.5 { 1.3 } else { 1.0 }), 0.01);
        assert!(
            rescaled.len() == 1 && rescaled[0].rows == [120.0, 121.0] && rescaled[0].size > LARGEST,
            "{rescaled:?}"
        );
        assert!(leaps(&record(|t| wave(t) + 0.3 * f64::from(t > 120.5)), 0.1).is_empty());
        assert!(leaps(&record(|t| 3.0 - (0.5 * (60.0 - t)).exp().min(1.0)), 0.01).is_empty());
        // What happens every forty rows is no accident.
        assert!(leaps(&record(|t| wave(t) + 0.3 * (t / 40.0).floor()), 0.01).is_empty());
        let moved = leaps(
            &record(|t| wave(t) + 0.3 * f64::from((60.5..90.5).contains(&t) || (120.5..140.5).contains(&t))),
            0.01,
        );
        assert_eq!(moved.len(), 4);
    }

    #[test]
    fn a_peak_is_between_two_rows_and_a_step_is_none() {
        let course = |of: &dyn Fn(f64) -> f64| {
            (0..400).map(|at| (0.5 * f64::from(at), of(0.5 * f64::from(at)))).collect::<Vec<_>>()
        };
        let jolt = |t: f64| 0.1 * (0.3 * t).sin() + (t - 120.5) * (-0.3 * (t - 120.5).powi(2)).exp();
        assert!(is_peak(&course(&jolt), [120.0, 121.0], 1.0));
        let peak = |t: f64| 1.0 + 0.1 * (0.3 * t).sin() + 5.0 * f64::from((t - 120.5).abs() < 0.75);
        assert!(is_peak(&course(&peak), [120.0, 121.0], 1.0));
        assert!(!is_peak(&course(&peak), [80.0, 81.0], 1.0));
        assert!(!is_peak(&course(&|t| f64::from(t > 120.5)), [120.0, 121.0], 1.0));
    }
}
