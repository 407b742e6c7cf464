//! Where a record begins, and where it begins anew.

use super::{FEWEST, FixedLagSmoother};
use crate::problem::BindError;
use crate::splines::live::again::{OPEN, ROWS};
use crate::splines::live::begun::Begun;
use crate::splines::live::held::are_at_rest;
use crate::splines::live::record::MeasuredRow;
use crate::splines::live::under_way::{Live, Reach};
use crate::splines::live::{LiveError, Smoothed};
use crate::units::Declared;

/// How many times as many rows as were asked for may wait until they tell something.
const MOST_WAITS: usize = 8;

impl FixedLagSmoother {
    /// Begins with the rows that wait. Where they leave something open, as a sensor at rest does, twice as many may tell.
    pub(super) fn begin(&mut self, open: f64) -> Result<Vec<Smoothed>, LiveError> {
        let first = self.settings.first_rows.max(FEWEST);
        let mut rows = std::mem::take(&mut self.waiting);
        let count = rows.len();
        let may_wait = open > 0.0 && count < MOST_WAITS * first;
        if may_wait && are_at_rest(&self.layout, &rows) {
            self.waiting = rows;
            self.due = 2 * count;
            return Ok(Vec::new());
        }
        self.held.leave_out(&self.layout, &mut rows);
        self.rests = self.layout.problem(&self.problem, &rows).ok().and_then(|first| first.rests().ok());
        let found = if may_wait {
            match self.begin_with(rows.clone(), self.settings.lag, open) {
                Err(
                    LiveError::Open
                    | LiveError::Fault(_)
                    | LiveError::Bind(BindError::NoPoints { .. } | BindError::NothingMeasured { .. }),
                ) => {
                    self.waiting = rows;
                    self.due = 2 * count;
                    return Ok(Vec::new());
                }
                found => found,
            }
        } else {
            self.begin_with(rows, self.settings.lag, open).map_err(|error| match error {
                LiveError::Bind(BindError::NoPoints { .. }) => LiveError::Unmeasured { rows: count },
                error => error,
            })
        };
        self.due = first;
        found
    }

    fn begin_with(
        &mut self,
        rows: Vec<MeasuredRow<Declared>>,
        lag: Option<f64>,
        open: f64,
    ) -> Result<Vec<Smoothed>, LiveError> {
        let Begun { answers, live, behind } = Begun::with(&self.problem, &self.layout, rows, (lag, open))?;
        self.live = live;
        self.waiting = behind;
        Ok(answers)
    }

    /// Takes a row that a window could not reach, after that has begun again.
    pub(super) fn push_anew(&mut self, row: MeasuredRow<Declared>) -> Vec<Smoothed> {
        let mut found = Vec::new();
        let reach =
            self.live.as_mut().map(|live| live.push(&self.layout, row.inward(&live.inward), &|_, _| None, &mut found));
        match reach {
            Some(Ok(Reach::Whole)) => {}
            Some(Err(_)) if self.live.as_ref().is_some_and(|live| live.has(row.at)) => {
                found.extend(self.wait_again(None));
            }
            _ => found.extend(self.wait_again(Some(row))),
        }
        found
    }

    /// Answers the rows that wait by what is known, and waits for as many as at the beginning: a row that was not taken is the first.
    pub(super) fn wait_again(&mut self, row: Option<MeasuredRow<Declared>>) -> Vec<Smoothed> {
        self.waiting.extend(row);
        self.live.take().iter_mut().flat_map(Live::finish).collect()
    }

    /// Begins again where the window is lost and has had its time: the answers of the rows that wait.
    pub(super) fn recover(&mut self) -> Vec<Smoothed> {
        let is_due = self.patience.is_over() && self.live.as_ref().is_some_and(Live::is_lost);
        if is_due { self.begin_again().unwrap_or_default() } else { Vec::new() }
    }

    /// Begins again: the answers of the rows that wait. What cannot be solved anew stays as it is, and nothing comes of it.
    pub(super) fn begin_again(&mut self) -> Option<Vec<Smoothed>> {
        let mut lost = self.live.take()?;
        self.patience.begun();
        let rows = lost.last_rows(ROWS * self.settings.first_rows);
        // The lag stays what it was said to be.
        let (start, lag) = (rows[0].at, lost.declared_lag());
        let Ok(answers) = self.begin_with(rows, Some(lag), OPEN) else {
            self.live = Some(lost);
            return None;
        };
        let first = lost.first_waiting();
        // Rows behind a gap wait again, but for those that have their answer.
        self.waiting.retain(|row| first.is_some_and(|first| row.at >= first));
        let mut found = lost.answer_before(start);
        found.extend(answers.into_iter().filter(|answer| first.is_some_and(|first| answer.at >= first)));
        Some(found)
    }
}
