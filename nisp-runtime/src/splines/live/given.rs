//! What a record says of given numbers: Rao's score test, as of a whole record (`splines/scores.rs`).
//!
//! A cell's rows are turned in once all that was measured there has its answer, about the state as it is then. Their triangle has the given
//! numbers beside the unknowns. When the first unknowns are forgotten, what their rows say of the numbers stays: each row counts once, and
//! a number that is wrong shows the clearer the longer the record is. The first rows have said theirs as a whole.

use std::collections::VecDeque;

use super::event::Event;
use super::opening::Doubt;
use super::window::Window;
use crate::facts::{Known, Score};
use crate::given::given;
use crate::splines::assembly::LEARNED;
use crate::splines::scores::OPEN;
use crate::splines::triangle::{Row, Triangle};
use crate::verdict::{Check, known};

/// What the rows with an answer say of given numbers.
pub(super) struct Given {
    /// The numbers that are asked about, by their slots.
    slots: Vec<usize>,
    /// What the first rows say.
    begun: Vec<Score>,
    /// Rows of answered cells, over the unknowns of the next one and of those on its sides: a place between two may count to either.
    triangle: Triangle,
    /// Sums of the squares of the rows' derivatives by each number.
    wholes: Vec<f64>,
    /// The learned scalars' parameters that the triangle is about.
    about: Vec<f64>,
    /// Number of the next cell of the record.
    next: i64,
    /// What was asked for in cells from there on.
    events: VecDeque<Event>,
    /// Numbers of cells in which an answer is not to be trusted.
    left_out: Vec<i64>,
    check: Option<Check>,
    /// What the first rows say against every answer.
    lasting: Option<String>,
}

impl Given {
    /// Behind the first rows, which end at a place and have said what they say.
    pub(super) fn behind(end: f64, doubt: Doubt, window: &Window) -> Self {
        let weights = window.weights();
        let schema = window.bound.problem.scene().schema;
        let slots = if doubt.goes_on { given(schema, &weights.scalars) } else { Vec::new() };
        let (about, numbers) = (weights.learned.clone(), slots.len());
        let mut triangle = window.empty_triangle(about.len() + numbers);
        for at in 0..about.len() {
            let mut shared = vec![0.0; about.len() + numbers];
            shared[at] = LEARNED.recip();
            triangle.add(Row { first: 0, slopes: &[], shared: &shared, value: 0.0 });
        }
        let next = window.grid().number(end) + 1;
        let mut own = Self {
            slots,
            begun: doubt.scores,
            triangle,
            wholes: vec![0.0; numbers],
            about,
            next,
            events: VecDeque::new(),
            left_out: Vec::new(),
            check: None,
            lasting: doubt.lasting,
        };
        own.judge(window);
        own
    }

    /// What gains most by another value.
    pub(super) fn check(&self) -> Option<&Check> {
        self.check.as_ref()
    }

    /// What speaks against every answer.
    pub(super) fn lasting(&self) -> Option<&String> {
        self.lasting.as_ref()
    }

    /// Keeps what was asked for at a place, until its cell is turned in.
    pub(super) fn keep(&mut self, events: impl Iterator<Item = Event>) {
        if !self.slots.is_empty() {
            self.events.extend(events);
        }
    }

    /// Leaves out what was observed in a cell of the record: an answer there is not to be trusted.
    pub(super) fn leave_out(&mut self, cell: i64) {
        if !self.slots.is_empty() {
            self.left_out.push(cell);
        }
    }

    /// Turns in the cells of the window before one.
    pub(super) fn take(&mut self, window: &Window, before: usize) {
        let grid = window.grid();
        let before = grid.number_of(before);
        if self.slots.is_empty() || self.next >= before {
            return;
        }
        while self.next < before {
            let next = self.next;
            let count = self.events.iter().take_while(|event| grid.number(event.at) <= next).count();
            let mut events: Vec<Event> = self.events.drain(..count).collect();
            events.iter_mut().for_each(|event| event.is_stray |= self.left_out.contains(&next));
            self.left_out.retain(|cell| *cell > next);
            if let Some(cell) = grid.index_of(next).filter(|cell| *cell > 0) {
                let own: Vec<&Event> = events.iter().filter(|event| grid.number(event.at) == next).collect();
                self.take_cell(window, cell, &own);
            }
            self.triangle.shift(window.heads_count());
            self.next += 1;
        }
        self.judge(window);
    }

    /// Turns in a cell. What cannot be evaluated says nothing.
    fn take_cell(&mut self, window: &Window, cell: usize, events: &[&Event]) {
        let (first, learned) = (window.first(cell - 1), &window.weights().learned);
        let moved: Vec<f64> = self.about.iter().zip(learned).map(|(about, own)| about - own).collect();
        let mut shared = Vec::new();
        let (triangle, wholes) = (&mut self.triangle, &mut self.wholes);
        let said = window.rows_of_cell(cell, events, &self.slots, &mut |row, by| {
            shared.clear();
            shared.extend_from_slice(row.shared);
            shared.extend_from_slice(by);
            let beside: f64 = row.shared.iter().zip(&moved).map(|(slope, moved)| slope * moved).sum();
            triangle.add(Row { first: row.first - first, shared: &shared, value: row.value + beside, ..row });
            wholes.iter_mut().zip(by).for_each(|(whole, by)| *whole += by * by);
        });
        said.ok();
    }

    /// What all rows so far say.
    fn judge(&mut self, window: &Window) {
        let mut scores = self.begun.clone();
        let told = self.slots.iter().zip(self.triangle.beside(self.slots.len())).zip(&self.wholes);
        for ((&slot, [slope, curvature]), whole) in told {
            let known = Known::Scalar(slot);
            if curvature <= OPEN * whole {
                continue;
            }
            let begun = scores.iter().position(|score| score.known == known).map(|at| scores.swap_remove(at));
            let (before, curved) = begun.map_or((0.0, 0.0), |begun| (begun.slope, begun.curvature));
            scores.extend(Score::by((known, false), before + slope, curved + curvature));
        }
        let values = known::Values { scalars: &window.weights().scalars, clouds: &[] };
        self.check = known::check(&window.bound, &scores, values);
    }
}
