//! The smoother: rows in, answers at the lag out.

mod begins;

use std::collections::VecDeque;

use super::again::Patience;
use super::held::Held;
use super::record::{Layout, MeasuredRow};
use super::under_way::{Live, Reach};
use super::{LagSettings, LiveError, RowColumn, Smoothed};
use crate::problem::{Problem, Rest};
use crate::units::Declared;

/// Rows that say anything of a noise and a source.
const FEWEST: usize = 10;
/// What a place is off after it has been in the engine's units, as a share of it.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// How far ahead of the last row one may be, at first, over the mean distance of rows, before its place is doubted.
const LEAP: f64 = 10.0;

/// Smooths a record as it comes: every row is answered once the record is a lag farther.
///
/// Work and memory of a row are bounded, whatever the length of the record. The same rows give the same answers.
pub struct FixedLagSmoother {
    problem: Problem,
    settings: LagSettings,
    layout: Layout,
    /// Place of the last row that was taken, in the declared unit.
    last: Option<f64>,
    /// A row far ahead of it, which the next one tells from a wrong place; and the place of the last one that was wrong.
    ahead: Option<MeasuredRow<Declared>>,
    left_out: Option<f64>,
    /// Rows until noise and smoothness are known.
    waiting: Vec<MeasuredRow<Declared>>,
    /// How many of them are asked next.
    due: usize,
    live: Option<Live>,
    patience: Patience,
    held: Held,
    /// Places of rows without an answer as they came: to the engine's units and back is not the same to the last digit.
    places: VecDeque<f64>,
    /// Where the first rows would rest, until it is asked for.
    rests: Option<Vec<Rest>>,
}

impl FixedLagSmoother {
    /// Of a problem with its parameters; groups without columns to which it has points are conditions there, all others hold
    /// along the whole record. Measured groups are not bound: their columns come with the rows.
    ///
    /// # Errors
    /// A scene that splines over one coordinate do not do, or that observes nothing.
    pub fn new(problem: Problem, settings: LagSettings) -> Result<Self, LiveError> {
        let schema = problem.scene().schema;
        if let Some(what) = super::super::refused(schema) {
            return Err(LiveError::Scene(what));
        }
        let layout = Layout::of(&problem)?;
        let held = Held::new(layout.observed().map(|column| layout.is_state(&problem, column)));
        Ok(Self {
            problem,
            settings,
            layout,
            last: None,
            ahead: None,
            left_out: None,
            waiting: Vec::new(),
            due: settings.first_rows.max(FEWEST),
            live: None,
            patience: Patience::default(),
            held,
            places: VecDeque::new(),
            rests: None,
        })
    }

    /// What every row has a number for, in this order.
    pub fn columns(&self) -> &[RowColumn] {
        &self.layout.columns
    }

    /// How long answers wait for later rows, in the coordinate's declared unit; nothing before the first rows have said so.
    pub fn lag(&self) -> Option<f64> {
        self.live.as_ref().map(Live::declared_lag)
    }

    /// Takes a row: its place, and a number for each of [`FixedLagSmoother::columns`], NaN where nothing was measured. Gives the
    /// rows that have waited for it: none while the first rows are gathered, all of them but a lag once they are there, and
    /// one for each row from then on where rows are evenly spaced. After a gap that is longer than the lag and a few cells it
    /// begins anew. A row that is as far ahead waits for the next one, and is [left out](Self::left_out) if that is not behind it.
    ///
    /// # Errors
    /// A row that does not fit: it is left out, and the next may be taken. First rows that do not determine the unknowns.
    pub fn push(&mut self, at: f64, values: &[f64]) -> Result<Vec<Smoothed>, LiveError> {
        self.check(at, values)?;
        let mut found = Vec::new();
        if let Some(ahead) = self.ahead.take() {
            if ahead.at == at {
                // The same place again says nothing of whether it is a wrong one.
                self.ahead = Some(ahead);
                return Err(LiveError::Backwards { at, last: at });
            }
            if ahead.at < at {
                found.extend(self.take(ahead)?);
            } else {
                self.left_out = Some(ahead.at);
            }
        }
        let row = MeasuredRow::new(at, values);
        if self.leaps(at) {
            self.ahead = Some(row);
        } else {
            found.extend(self.take(row)?);
        }
        Ok(found)
    }

    /// The place of a row that was far ahead and is left out, because the last one pushed was not; it is said once.
    pub fn left_out(&mut self) -> Option<f64> {
        self.left_out.take()
    }

    /// Where the rows are that a record begins with, and where they would rest if nothing acted; it is said once. A column in another
    /// unit than its declared one is far off.
    pub fn rests(&mut self) -> Option<Vec<Rest>> {
        self.rests.take()
    }

    /// Whether a row is so far ahead that its place may be a wrong one.
    fn leaps(&self, at: f64) -> bool {
        match (&self.live, &self.waiting[..]) {
            (Some(live), _) => live.cells_to(live.place(at)) > live.window.grid().cells as f64,
            (None, [first, .., last]) => at - last.at > LEAP * (last.at - first.at) / (self.waiting.len() - 1) as f64,
            (None, _) => true,
        }
    }

    /// Takes a row whose place is a right one.
    fn take(&mut self, row: MeasuredRow<Declared>) -> Result<Vec<Smoothed>, LiveError> {
        let (live, layout) = (self.live.as_ref(), &self.layout);
        let noise = |column| live.and_then(|live| live.noise(layout, column)).unwrap_or(f64::NAN);
        self.places.push_back(row.at);
        self.held.take(row.at, layout.observed().map(|column| [row.values[column], noise(column)]));
        let found = self.answered(row)?;
        Ok(self.said(found))
    }

    /// Says of answers where they are, and whether a sensor stood still there.
    fn said(&mut self, mut found: Vec<Smoothed>) -> Vec<Smoothed> {
        for answer in &mut found {
            let slack = ROUNDING * answer.at.abs();
            while let Some(place) = self.places.pop_front_if(|place| *place <= answer.at + slack) {
                if place >= answer.at - slack {
                    answer.at = place;
                    break;
                }
            }
        }
        for answer in found.iter_mut().filter(|answer| self.held.is_at(answer.at)) {
            answer.is_held = true;
            if let Some(live) = &mut self.live {
                live.leave_out(live.place(answer.at));
            }
        }
        found
    }

    /// The answers that a row brings.
    fn answered(&mut self, row: MeasuredRow<Declared>) -> Result<Vec<Smoothed>, LiveError> {
        self.last = Some(row.at);
        let mut found = Vec::new();
        if let Some(live) = &mut self.live {
            self.patience.row();
            match live.push(&self.layout, row.inward(&live.inward), &|_, _| None, &mut found) {
                Ok(Reach::Whole) => {
                    found.extend(self.recover());
                    return Ok(found);
                }
                Err(_) => {
                    let is_taken = live.has(row.at);
                    // What cannot be evaluated here may be so farther on, but a beginning takes as long as many rows.
                    let is_due = self.patience.is_over();
                    match is_due.then(|| self.begin_again()).flatten() {
                        Some(again) if is_taken => found.extend(again),
                        Some(again) => {
                            found.extend(again);
                            found.extend(self.push_anew(row));
                        }
                        None => found.extend(self.wait_again((!is_taken).then_some(row))),
                    }
                    return Ok(found);
                }
                Ok(Reach::Gap) => {
                    found.extend(self.wait_again(Some(row)));
                    return Ok(found);
                }
            }
        }
        self.waiting.push(row);
        if self.waiting.len() >= self.due {
            found.extend(self.begin(1.0)?);
        }
        Ok(found)
    }

    /// The record has ended: gives the rows that wait, at shorter lags.
    ///
    /// # Errors
    /// Fewer rows than it takes to tell noise from a source.
    pub fn finish(&mut self) -> Result<Vec<Smoothed>, LiveError> {
        let mut found = Vec::new();
        if let Some(ahead) = self.ahead.take() {
            if self.live.is_none() && self.waiting.len() < 2 {
                found.extend(self.take(ahead)?);
            } else {
                self.left_out = Some(ahead.at);
            }
        }
        // Rows behind a gap wait again.
        while !self.waiting.is_empty() {
            if self.waiting.len() < FEWEST {
                return Err(LiveError::FewRows { rows: self.waiting.len(), least: FEWEST });
            }
            found.extend(self.begin(0.0)?);
        }
        found.extend(self.live.as_mut().map_or_else(Vec::new, Live::finish));
        Ok(self.said(found))
    }

    fn check(&self, at: f64, values: &[f64]) -> Result<(), LiveError> {
        let columns = &self.layout.columns;
        if values.len() != columns.len() {
            return Err(LiveError::Columns { found: values.len(), expected: columns.len() });
        }
        if !at.is_finite() {
            return Err(LiveError::NotFinite { name: self.problem.scene().schema.coordinates[0].name, value: at });
        }
        if let Some(last) = self.last.filter(|last| at <= *last) {
            return Err(LiveError::Backwards { at, last });
        }
        let is_bad = |(column, value): &(&RowColumn, &f64)| value.is_infinite() || value.is_nan() && !column.may_lack;
        match columns.iter().zip(values).find(is_bad) {
            Some((column, &value)) => Err(LiveError::NotFinite { name: column.name, value }),
            None => Ok(()),
        }
    }
}
