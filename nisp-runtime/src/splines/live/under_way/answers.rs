//! The answers of rows that have waited.

use super::{Live, SLACK};
use crate::splines::live::Smoothed;
use crate::splines::live::met::{Nearby, count_all, count_bend, count_near};
use crate::splines::live::opening::Opening;
use crate::units::{Declared, Engine, Number, Scale};

impl Live {
    /// Answers the rows that have waited for a lag.
    pub(super) fn answer(&mut self, found: &mut Vec<Smoothed>) {
        let slack = SLACK * self.window.grid().width;
        while self.pending.front().is_some_and(|(at, _)| *at <= self.last - self.lag + slack) {
            found.extend(self.answer_next());
        }
        self.given.keep(self.window.gone());
        self.given.take(&self.window, self.wanted().saturating_sub(1));
    }

    /// Answers the rows that wait before a place in the declared unit.
    pub(in super::super) fn answer_before(&mut self, place: f64) -> Vec<Smoothed> {
        let place = self.place(place);
        let mut found = Vec::new();
        while self.pending.front().is_some_and(|(at, _)| *at < place) {
            found.extend(self.answer_next());
        }
        found
    }

    fn answer_next(&mut self) -> Option<Smoothed> {
        let next = self.pending.front()?.0;
        self.opening.take_if(|opening| !opening.answers(next));
        let decided = self.window.decided();
        let (window, opening) = (&mut self.window, self.opening.as_ref());
        for nearby in &mut self.nearby {
            nearby.count_up(&self.pending, decided, &mut |_, events, mean| count_near((window, opening), events, mean));
        }
        // The answer to the first rows has a prior of its own.
        if opening.is_none() {
            for bends in &mut self.bends {
                bends.count_up(&self.pending, decided, &mut |at, _, mean| count_bend(window.bend(at), mean));
            }
        }
        let (at, events) = self.pending.pop_front()?;
        let counted = self.nearby.iter_mut().chain(&mut self.bends);
        counted.for_each(|nearby| nearby.counted = nearby.counted.saturating_sub(1));
        count_all((window, opening), &events, &mut self.square);
        let has_deviations = window.has_deviations();
        let mut beyond = 0.0_f64;
        let read = |(head, outward): (usize, &Scale<Engine, Declared>)| {
            let (value, deviation) = opening.map_or_else(|| window.read(head, at), |opening| opening.read(head, at));
            let (value, far) = window.within(head, (value, deviation));
            beyond = beyond.max(far);
            let outward = |x| outward.of(Number::engine(x)).as_declared();
            (outward(value), if has_deviations { outward(deviation) } else { f64::NAN })
        };
        let heads = self.outward.iter().enumerate().map(read).collect();
        let outward = |at| self.inward.at.inverse().of(Number::engine(at)).as_declared();
        let most = |means: &[Nearby]| means.iter().map(|mean| mean.square.sqrt()).fold(0.0, f64::max);
        let (nearby, bend) = (most(&self.nearby), most(&self.bends));
        let (lag, misfit, leaning) = (outward(self.last - at), self.square.sqrt(), self.window.weights().leaning);
        let is_stray = events.iter().any(|event| event.is_stray);
        let given = self.given.check();
        // Rows that are not as they were measured are the likely cause of all else.
        let other = opening.and_then(Opening::against).or_else(|| self.given.lasting());
        let answer = Smoothed {
            at: outward(at),
            lag,
            heads,
            misfit,
            nearby,
            bend,
            learned: self.window.learned(),
            leaning,
            beyond,
            given: given.map_or(0.0, |check| check.value),
            doubt: other.or(given.filter(|check| !check.passed).map(|check| &check.message)).cloned(),
            is_stray,
            is_held: false,
        };
        if answer.is_met() {
            self.unsound = 0;
        } else {
            self.unsound += 1;
            self.leave_out(at);
        }
        Some(answer)
    }

    /// Answers all rows that wait.
    pub(in super::super) fn finish(&mut self) -> Vec<Smoothed> {
        std::iter::from_fn(|| self.answer_next()).collect()
    }
}
