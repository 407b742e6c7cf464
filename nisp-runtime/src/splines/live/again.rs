//! When a window no longer fits its rows, it begins again: the last rows are solved as the first ones were. A source that sets in after
//! quiet rows is rougher than these said, and a state that steps have spoiled does not come back by itself.

/// Rows after a beginning before the next one, at least and at most: equations that are wrong stay wrong.
const SOON: usize = 50;
const LATE: usize = 4000;
/// A beginning has helped if the next one is due only after so many waits.
const HELPED: usize = 4;
/// How many times the number of first rows a new beginning is made from.
pub(super) const ROWS: usize = 2;
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
