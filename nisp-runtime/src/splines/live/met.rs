//! How well rows are met, and how sources bend between them: running means of squares.

use std::collections::VecDeque;

use super::event::Event;
use super::opening::Opening;
use super::window::Window;

/// Values that the running mean of misfits looks back over, and the square that one may count for: a value that stands alone
/// does not make equations wrong.
const LOOKED_BACK: f64 = 100.0;
const LARGEST_SQUARE: f64 = 16.0;
/// The same about a place: answers beside a value that stands alone are wrong.
const NEARBY: f64 = 12.0;
const LARGEST_NEARBY: f64 = 200.0;

/// A running mean of squares up to a row that waits.
pub(super) struct Nearby {
    /// How many rows that is behind the one that is answered.
    ahead: usize,
    pub(super) square: f64,
    /// Rows that wait and have been counted.
    pub(super) counted: usize,
}

impl Nearby {
    /// Of the rows up to the one that is so many behind the answered one.
    pub(super) fn ahead(ahead: usize) -> Self {
        Self { ahead, square: 1.0, counted: 0 }
    }

    /// Counts the rows that wait: the first, and those before a place.
    pub(super) fn count_up(
        &mut self,
        pending: &VecDeque<(f64, Vec<Event>)>,
        decided: f64,
        count: &mut dyn FnMut(f64, &[Event], &mut f64),
    ) {
        let own = pending.iter().take(self.ahead + 1).skip(self.counted);
        for (at, events) in own.take_while(|(at, _)| *at < decided || *at == pending[0].0) {
            count(*at, events, &mut self.square);
            self.counted += 1;
        }
    }
}

/// Counts a row's values in a mean about a place, unless it is a stray.
pub(super) fn count_near(answers: (&Window, Option<&Opening>), events: &[Event], mean: &mut f64) {
    count(answers, events.iter().filter(|event| !event.is_stray), mean, (NEARBY, LARGEST_NEARBY));
}

/// Counts how far sources bend at a row in such a mean.
pub(super) fn count_bend(square: Option<f64>, mean: &mut f64) {
    *mean += square.map_or(0.0, |square| (square.min(LARGEST_NEARBY) - *mean) / NEARBY);
}

/// Counts all of a row's values in the mean that looks back. Strays are counted too: where they are many, the equations are wrong.
pub(super) fn count_all(answers: (&Window, Option<&Opening>), events: &[Event], mean: &mut f64) {
    count(answers, events.iter(), mean, (LOOKED_BACK, LARGEST_SQUARE));
}

/// Counts the misfits of a row's values in a running mean of their squares over so many values, none larger than that.
fn count<'a>(
    (window, opening): (&Window, Option<&Opening>),
    events: impl Iterator<Item = &'a Event>,
    mean: &mut f64,
    (values, largest): (f64, f64),
) {
    let splines = opening.map(Opening::splines);
    for event in events {
        window.misfits(event, splines, &mut |misfit| *mean += ((misfit * misfit).min(largest) - *mean) / values);
    }
}
