//! Rows under way: what waits for its answer, what was asked last, and how well rows are met.

mod answers;
mod spoiled;

use std::collections::VecDeque;
use std::thread::{self, JoinHandle};

use super::event::Event;
use super::evidence::{Stretch, Weights};
use super::given::Given;
use super::lag::{settled_lag, sought};
use super::met::Nearby;
use super::opening::Opening;
use super::record::{Inward, Layout, MeasuredRow};
use super::window::{Known, Window};
use super::{LiveError, Smoothed};
use crate::solve::fault::Fault;
use crate::units::{Declared, Engine, Number, Scale};

/// The last rows, of which nothing says yet whether they are strays. What a stretch says does not rest on them.
pub(super) const UNTOLD: usize = 3;
/// Steps over the first cells at most, and the change that no longer matters.
const FIRST_STEPS: usize = 20;
const SETTLED: f64 = 1e-8;
/// Steps at a row at most, and the largest change of a coefficient, in natural sizes, after which one is enough.
const MORE_STEPS: usize = 5;
const SMALL: f64 = 0.5;
/// Rows of a later stretch that is asked for noise and smoothness, at most, and rows between such stretches, at most.
const STRETCH: usize = 1000;
const BETWEEN: usize = 4000;
/// Unsound answers, one after the other, behind which the window is lost.
const MANY_UNSOUND: usize = 50;
/// Share of a cell by which a place may miss the lag.
pub(super) const SLACK: f64 = 1e-6;

/// Rows under way.
pub(super) struct Live {
    pub(super) window: Window,
    /// The answer to the first rows, while one of them waits.
    pub(super) opening: Option<Opening>,
    pub(super) inward: Inward,
    /// Of each head.
    pub(super) outward: Vec<Scale<Engine, Declared>>,
    pub(super) lag: f64,
    /// As long as it may become: later rows may say that a longer one is worth waiting for.
    pub(super) most_lag: f64,
    /// Places of rows that have no answer yet, with what was measured there.
    pub(super) pending: VecDeque<(f64, Vec<Event>)>,
    /// Conditions at places that the record has not reached yet.
    pub(super) conditions: VecDeque<Event>,
    pub(super) last: f64,
    /// Running mean of the squares of misfits over the noise, of rows that have an answer.
    pub(super) square: f64,
    /// The same of fewer rows, up to the one that is answered and up to two behind it: a value that stands alone, or a source that
    /// is followed too slowly, spoils answers on both of its sides.
    pub(super) nearby: [Nearby; 3],
    /// How far sources bend, up to the row that is answered and up to one behind it.
    pub(super) bends: [Nearby; 2],
    /// The last rows, for the next stretch.
    pub(super) recent: VecDeque<MeasuredRow<Engine>>,
    pub(super) rows: usize,
    /// Answers since the last sound one.
    pub(super) unsound: usize,
    /// What the record says of given numbers.
    pub(super) given: Given,
    /// Number of the row at which a stretch is asked next, or its answer taken over.
    pub(super) due: usize,
    pub(super) asked: Option<JoinHandle<Result<(Weights, f64), LiveError>>>,
}

/// Whether a row could be reached from the last one.
pub(super) enum Reach {
    Whole,
    Gap,
}

impl Live {
    /// Cells that it takes to reach a place.
    pub(super) fn cells_to(&self, at: f64) -> f64 {
        let grid = self.window.grid();
        ((at - grid.right()) / grid.width - SLACK).ceil().max(0.0)
    }

    /// Takes the first rows, whose first cells are found together. Gives back those behind a gap.
    pub(super) fn replay(
        &mut self,
        layout: &Layout,
        rows: Vec<MeasuredRow<Engine>>,
        known: Known<'_>,
        found: &mut Vec<Smoothed>,
    ) -> Result<Vec<MeasuredRow<Engine>>, LiveError> {
        let right = self.window.grid().right();
        let mut rows = rows.into_iter().peekable();
        while let Some(row) = rows.next_if(|row| row.at <= right) {
            self.ask(layout, row);
        }
        self.ask_conditions();
        for _ in 0..FIRST_STEPS {
            if self.window.solve(self.window.grid().begun())? < SETTLED {
                break;
            }
        }
        self.answer(found);
        while let Some(row) = rows.next() {
            if let Reach::Gap = self.push(layout, row.clone(), known, found)? {
                return Ok(std::iter::once(row).chain(rows).collect());
            }
        }
        Ok(Vec::new())
    }

    fn ask(&mut self, layout: &Layout, row: MeasuredRow<Engine>) {
        let events: Vec<Event> = layout.events(&row).collect();
        events.iter().for_each(|event| self.window.ask(event.clone()));
        self.last = row.at;
        self.rows += 1;
        self.pending.push_back((row.at, events));
        self.recent.push_back(row);
        if self.recent.len() > STRETCH {
            self.recent.pop_front();
        }
    }

    fn ask_conditions(&mut self) {
        let right = self.window.grid().right();
        while let Some(condition) = self.conditions.pop_front_if(|condition| condition.at <= right) {
            self.window.ask(condition);
        }
    }

    pub(super) fn push(
        &mut self,
        layout: &Layout,
        row: MeasuredRow<Engine>,
        known: Known<'_>,
        found: &mut Vec<Smoothed>,
    ) -> Result<Reach, LiveError> {
        self.renew(layout)?;
        let cells = self.cells_to(row.at);
        if cells > self.window.grid().cells as f64 {
            return Ok(Reach::Gap);
        }
        for cell in 1..=cells as usize {
            self.window.advance(known);
            self.ask_conditions();
            if cell < cells as usize {
                self.last = self.window.grid().right();
                self.solve()?;
                self.answer(found);
            }
        }
        self.ask(layout, row);
        self.solve()?;
        self.answer(found);
        Ok(Reach::Whole)
    }

    /// The first cell of which something is asked: that of the first row that waits, or of the tail.
    fn wanted(&self) -> usize {
        let grid = self.window.grid();
        let wanted = self.pending.front().map_or(grid.tail_start(), |(at, _)| grid.cell(*at));
        wanted.min(grid.tail_start()).max(grid.begun())
    }

    /// A step with the rows that are there, down to the first row that waits.
    fn step(&mut self) -> Result<(), Fault> {
        let from = self.wanted();
        for _ in 0..MORE_STEPS {
            if self.window.solve(from)? < SMALL {
                break;
            }
        }
        Ok(())
    }

    /// True where equations and data no longer agree, or have not for many rows.
    pub(super) fn is_lost(&self) -> bool {
        let nearby = self.nearby[..1].iter().map(|nearby| nearby.square.sqrt());
        nearby.fold(0.0, f64::max) > Smoothed::NEARBY
            || self.square.sqrt() > Smoothed::MISFIT
            || self.unsound >= MANY_UNSOUND
    }

    /// Says that an answer at a place in the engine's unit is not to be trusted.
    pub(super) fn leave_out(&mut self, at: f64) {
        self.given.leave_out(self.window.grid().number(at));
    }

    /// Whether the row at a place in the declared unit is among those that were taken.
    pub(super) fn has(&self, at: f64) -> bool {
        self.recent.back().is_some_and(|row| row.at >= self.place(at))
    }

    /// The noise of a column in its declared unit, by what the last stretch says.
    pub(super) fn noise(&self, layout: &Layout, column: usize) -> Option<f64> {
        let (group, own) = layout.place_of(column)?;
        let weights = self.window.weights();
        let terms = self.window.bound.problem.scene().schema.groups[group].terms;
        let found = weights
            .noise
            .observations
            .iter()
            .find(|found| found.group == group && terms[found.term].columns.contains(&own) && !found.is_exact())?;
        Some(self.inward.values[column].inverse().of(Number::engine(found.deviation)).as_declared())
    }

    /// A place in the declared unit, in the engine's.
    pub(super) fn place(&self, at: f64) -> f64 {
        self.inward.at.of(Number::declared(at)).as_engine()
    }

    /// So many of the last rows at most.
    pub(super) fn last_rows(&self, most: usize) -> Vec<MeasuredRow<Declared>> {
        let last = self.recent.iter().skip(self.recent.len().saturating_sub(most));
        last.map(|row| row.outward(&self.inward)).collect()
    }

    /// The lag, and the place of the first row without an answer, in the declared unit.
    pub(super) fn declared_lag(&self) -> f64 {
        self.inward.at.back(Number::engine(self.lag)).as_declared()
    }

    pub(super) fn first_waiting(&self) -> Option<f64> {
        self.pending.front().map(|(at, _)| self.inward.at.back(Number::engine(*at)).as_declared())
    }

    /// Asks the last rows for noise, smoothness and lag now and then, on another thread. What they say is taken over at a row whose
    /// number is known beforehand, so that answers do not depend on time.
    fn renew(&mut self, layout: &Layout) -> Result<(), LiveError> {
        if self.rows < self.due {
            return Ok(());
        }
        let between = self.rows.min(BETWEEN);
        match self.asked.take() {
            Some(asked) => {
                // A stretch that cannot be solved leaves what is known as it is.
                if let Ok(Ok((weights, lag))) = asked.join() {
                    self.window.weigh(weights);
                    self.lag = self.lag.max(lag.min(self.most_lag));
                }
                self.due = self.rows + between;
            }
            None => {
                let Some(rows) = told(self.recent.make_contiguous(), self.window.decided()) else { return Ok(()) };
                let ends = (rows[0].at, rows[rows.len() - 1].at);
                let stretch = layout.stretch(&self.window.bound, rows);
                let from = self.window.weights().clone();
                let (sought, width) = (sought(&self.window.bound), self.window.grid().width);
                let solve = move || {
                    let found = Stretch::solve(&stretch, Some(&from))?;
                    let lag = settled_lag(&found, &sought, ends, width);
                    Ok((found.weights, lag))
                };
                self.asked = thread::Builder::new().name("evidence".into()).spawn(solve).ok();
                self.due = self.rows + between / 4;
            }
        }
        Ok(())
    }
}

/// Rows of which it is known whether they are strays: those before the first that is not decided, but for the last ones. Nothing where these
/// are less than half.
fn told(rows: &[MeasuredRow<Engine>], decided: f64) -> Option<&[MeasuredRow<Engine>]> {
    let last = rows.len().saturating_sub(UNTOLD);
    let told = last.min(rows.partition_point(|row| row.at < decided));
    (2 * told >= rows.len()).then(|| &rows[..told])
}
