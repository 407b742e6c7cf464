//! When a window no longer fits its rows, it begins again: the last rows are solved as the first ones were. A source that sets in after
//! quiet rows is rougher than these said, and a state that steps have spoiled does not come back by itself.

use super::record::MeasuredRow;

/// Rows after a beginning before the next one, at least and at most: equations that are wrong stay wrong.
const SOON: usize = 50;
const LATE: usize = 4000;
/// A beginning has helped if the next one is due only after so many waits.
const HELPED: usize = 4;
/// How many times the number of first rows a new beginning is made from.
pub(super) const ROWS: usize = 2;

/// How far from its neighbours a value stands alone, over how far most are.
const STRAY: f64 = 12.0;
/// What of the lag is left to later rows when the last ones are answered as a whole.
pub(super) const OPEN: f64 = 0.5;

/// How many rows go by before the window may begin again.
pub(super) struct Patience {
    since: usize,
    wait: usize,
}

impl Default for Patience {
    fn default() -> Self {
        Self { since: 0, wait: SOON }
    }
}

impl Patience {
    pub(super) fn row(&mut self) {
        self.since += 1;
    }

    pub(super) fn is_over(&self) -> bool {
        self.since >= self.wait
    }

    pub(super) fn begun(&mut self) {
        self.wait = if self.since < HELPED * self.wait { (2 * self.wait).min(LATE) } else { SOON };
        self.since = 0;
    }
}

/// Sets all values of a row to NaN if one of them stands alone: it is far from the line between its neighbours, and farther than these
/// are from theirs. A window that begins with such a value follows it.
pub(super) fn without_strays(mut rows: Vec<MeasuredRow>) -> Vec<MeasuredRow> {
    for column in 0..rows[0].values.len() {
        let off = |at: usize| {
            let [before, own, after] = [at - 1, at, at + 1].map(|at| (rows[at].at, rows[at].values[column]));
            let share = (own.0 - before.0) / (after.0 - before.0);
            (own.1 - before.1 - share * (after.1 - before.1)).abs()
        };
        let off: Vec<f64> = (1..rows.len() - 1).map(off).collect();
        let mut known: Vec<f64> = off.iter().copied().filter(|off| !off.is_nan()).collect();
        known.sort_by(f64::total_cmp);
        // Values that mostly stay as they are, as rounded ones do, have no usual distance.
        let Some(usual) = known.get(known.len() / 2).copied().filter(|usual| *usual > 0.0) else { continue };
        let beside = |at: usize| off[at.saturating_sub(1)..(at + 2).min(off.len())].iter().copied().fold(0.0, f64::max);
        let strays: Vec<usize> =
            (0..off.len()).filter(|&at| off[at] > STRAY * usual && off[at] == beside(at)).collect();
        strays.into_iter().for_each(|at| rows[at + 1].values.fill(f64::NAN));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(value: impl Fn(usize) -> f64) -> Vec<MeasuredRow> {
        (0..40).map(|i| MeasuredRow { at: i as f64, values: vec![value(i), 1.0] }).collect()
    }

    fn left_out(rows: Vec<MeasuredRow>) -> Vec<usize> {
        let rows = without_strays(rows);
        (0..rows.len()).filter(|&at| rows[at].values.iter().all(|value| value.is_nan())).collect()
    }

    #[test]
    fn a_value_that_stands_alone_is_left_out_and_its_neighbours_are_not() {
        let wave = |i: usize| (0.4 * i as f64).sin();
        assert!(left_out(rows(wave)).is_empty());
        assert_eq!(left_out(rows(|i| if i == 17 { 9.0 } else { wave(i) })), [17]);
        // Rounded values stay and jump.
        assert!(left_out(rows(|i| (i / 15) as f64)).is_empty());
    }
}
