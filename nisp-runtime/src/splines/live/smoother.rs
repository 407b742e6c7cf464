//! The smoother: rows in, answers at the lag out.

use std::collections::VecDeque;

use super::again::{OPEN, Patience, ROWS};
use super::event::Event;
use super::evidence::Stretch;
use super::grid::Grid;
use super::opening::Opening;
use super::record::{Layout, MeasuredRow};
use super::under_way::{Live, Nearby, Reach, SLACK};
use super::window::Window;
use super::{LagSettings, LiveError, RowColumn, Smoothed};
use crate::problem::Problem;

/// Rows that say anything of a noise and a source.
const FEWEST: usize = 10;
/// The last rows, of which nothing says yet whether they are strays. What the first rows say does not rest on them.
const UNTOLD: usize = 3;
/// Cells that a lag may take.
const MOST_CELLS: usize = 20_000;
/// How much larger a source's deviation may be at the lag than after any wait.
const NEAR: f64 = 1.05;

/// Smooths a record as it comes: every row is answered once the record is a lag farther.
///
/// Work and memory of a row are bounded, whatever the length of the record. The same rows give the same answers.
pub struct FixedLagSmoother {
    problem: Problem,
    settings: LagSettings,
    layout: Layout,
    /// Place of the last row, in the declared unit.
    last: Option<f64>,
    /// Rows in declared units until noise and smoothness are known.
    waiting: Vec<MeasuredRow>,
    live: Option<Live>,
    patience: Patience,
}

impl FixedLagSmoother {
    /// Of a problem with its parameters; groups without columns to which it has points are conditions there, all others hold
    /// along the whole record. Measured groups are not bound: their columns come with the rows.
    ///
    /// # Errors
    /// A scene that splines over one coordinate do not do, or that observes nothing.
    pub fn new(problem: Problem, settings: LagSettings) -> Result<Self, LiveError> {
        let schema = problem.scene().schema;
        let bounded = schema.heads.iter().any(|head| head.transformed).then_some("bounds of fields and sources");
        if let Some(what) = super::super::refused(schema).or(bounded) {
            return Err(LiveError::Scene(what));
        }
        let layout = Layout::of(&problem)?;
        Ok(Self {
            problem,
            settings,
            layout,
            last: None,
            waiting: Vec::new(),
            live: None,
            patience: Patience::default(),
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
    /// begins anew.
    ///
    /// # Errors
    /// A row that does not fit: it is left out, and the next may be taken. First rows that do not determine the unknowns.
    pub fn push(&mut self, at: f64, values: &[f64]) -> Result<Vec<Smoothed>, LiveError> {
        self.check(at, values)?;
        self.last = Some(at);
        let mut found = Vec::new();
        if let Some(live) = &mut self.live {
            let row = live.inward(at, values);
            self.patience.row();
            match live.push(&self.layout, row, &|_, _| None, &mut found) {
                Ok(Reach::Whole) => {
                    found.extend(self.recover());
                    return Ok(found);
                }
                Err(error) => {
                    let is_taken = live.has(at);
                    found.extend(self.begin_again().ok_or(error)?);
                    if is_taken {
                        return Ok(found);
                    }
                    found.extend(self.push_anew(at, values)?);
                    return Ok(found);
                }
                Ok(Reach::Gap) => {
                    found.extend(live.finish());
                    self.live = None;
                }
            }
        }
        self.waiting.push(MeasuredRow::new(at, values));
        if self.waiting.len() >= self.settings.first_rows.max(FEWEST) {
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
        // Rows behind a gap wait again.
        while !self.waiting.is_empty() {
            if self.waiting.len() < FEWEST {
                return Err(LiveError::FewRows { rows: self.waiting.len(), least: FEWEST });
            }
            found.extend(self.begin(0.0)?);
        }
        found.extend(self.live.as_mut().map_or_else(Vec::new, Live::finish));
        Ok(found)
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

    /// Begins with the rows that wait.
    fn begin(&mut self, open: f64) -> Result<Vec<Smoothed>, LiveError> {
        let rows = std::mem::take(&mut self.waiting);
        self.begin_with(rows, self.settings.lag, open)
    }

    /// Finds noise, smoothness and, where it is not given, the lag from rows in declared units, and answers them as a whole, but for the
    /// last ones, of which later rows tell more: `open` is that stretch over the lag.
    fn begin_with(
        &mut self,
        mut rows: Vec<MeasuredRow>,
        lag: Option<f64>,
        open: f64,
    ) -> Result<Vec<Smoothed>, LiveError> {
        self.layout.mark_strays(&mut rows);
        let told = if open > 0.0 { rows.len() - UNTOLD } else { rows.len() };
        let bound = self.layout.bound(&self.problem, &rows[..told])?;
        let (stretch, opening) = rayon::join(|| Stretch::solve(&bound, None), || Opening::solve(&bound));
        let stretch = stretch?;
        let schema = self.problem.scene().schema;
        let system = bound.system;
        let by = system.inward(&schema.coordinates[0].unit);
        let inward = (by, self.layout.columns.iter().map(|column| system.inward(&column.unit)).collect::<Vec<_>>());
        let rows: Vec<MeasuredRow> = rows.iter().map(|row| row.scaled(&inward)).collect();
        let (start, end) = (rows[0].at, rows[told - 1].at);
        let width = width(&rows);
        let sought: Vec<usize> = sought(&bound);
        let settled = settled_lag(&stretch, &sought, (start, end), width);
        // Rows that a value says something of.
        let reach = (settled / width).round() as usize;
        let lag = match lag {
            Some(lag) if lag * by > MOST_CELLS as f64 * width => {
                return Err(LiveError::Lag { lag, most: MOST_CELLS });
            }
            Some(lag) => lag * by,
            None => settled,
        };
        let grid = Grid::new(start, width, lag);
        let mut conditions: Vec<Event> = Vec::new();
        for (group, declared) in schema.groups.iter().enumerate() {
            let is_condition = declared.columns.is_empty() && !declared.is_beliefs();
            if is_condition && !self.layout.continuous.contains(&group) {
                let places = bound.coordinates[group].iter();
                conditions.extend(places.map(|&at| Event::plain(group, at)));
            }
        }
        for &group in &self.layout.continuous {
            conditions.extend(grid.beginning().map(|at| Event::plain(group, at)));
        }
        conditions.retain(|condition| condition.at >= start - SLACK * width);
        conditions.sort_by(|a, b| a.at.total_cmp(&b.at));
        let outward = schema.heads.iter().map(|head| system.outward(&head.unit)).collect();
        let known = |head: usize, at: f64| (at <= end).then(|| stretch.value(head, at.max(start)));
        let mut window = Window::new(bound, stretch.weights.clone(), grid, &self.layout.continuous);
        window.guess(&known);
        let mut live = Live {
            window,
            opening: opening.map(|opening| opening.until(end - open * lag)),
            inward,
            outward,
            lag,
            pending: VecDeque::new(),
            conditions: conditions.into(),
            last: start,
            square: 1.0,
            nearby: [0, reach / 2, reach].map(Nearby::ahead),
            recent: VecDeque::new(),
            rows: 0,
            due: 2 * rows.len(),
            asked: None,
        };
        let mut found = Vec::new();
        let behind = live.replay(&self.layout, rows, &known, &mut found)?;
        if behind.is_empty() {
            self.live = Some(live);
            return Ok(found);
        }
        found.extend(live.finish());
        self.waiting = live.outward(behind.iter());
        Ok(found)
    }

    /// Takes a row that a window could not reach, after that has begun again.
    fn push_anew(&mut self, at: f64, values: &[f64]) -> Result<Vec<Smoothed>, LiveError> {
        let mut found = Vec::new();
        let reach = self.live.as_mut().map(|live| {
            let row = live.inward(at, values);
            live.push(&self.layout, row, &|_, _| None, &mut found)
        });
        if !matches!(reach.transpose()?, Some(Reach::Whole)) {
            found.extend(self.live.take().iter_mut().flat_map(Live::finish));
            self.waiting.push(MeasuredRow::new(at, values));
        }
        Ok(found)
    }

    /// Begins again where the window is lost and has had its time: the answers of the rows that wait.
    fn recover(&mut self) -> Vec<Smoothed> {
        let is_due = self.patience.is_over() && self.live.as_ref().is_some_and(Live::is_lost);
        if is_due { self.begin_again().unwrap_or_default() } else { Vec::new() }
    }

    /// Begins again: the answers of the rows that wait. What cannot be solved anew stays as it is, and nothing comes of it.
    fn begin_again(&mut self) -> Option<Vec<Smoothed>> {
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

/// Heads that the lag waits for: sources, or everything where there are none.
fn sought(bound: &crate::problem::Bound) -> Vec<usize> {
    let heads = bound.problem.scene().schema.heads;
    let sources: Vec<usize> = (0..heads.len()).filter(|&head| heads[head].source).collect();
    if sources.is_empty() { (0..heads.len()).collect() } else { sources }
}

/// Width of a cell: the usual distance of two rows. The median does not mind gaps, and the mean not that rows come in bursts.
fn width(rows: &[MeasuredRow]) -> f64 {
    let mut apart: Vec<f64> = rows.windows(2).map(|pair| pair[1].at - pair[0].at).collect();
    apart.sort_by(f64::total_cmp);
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    mean.min(apart[apart.len() / 2].max(mean / 4.0))
}

/// The distance from the end of a stretch, in whole cells, from which on deviations are nearly those of its middle.
fn settled_lag(stretch: &Stretch, heads: &[usize], (start, end): (f64, f64), width: f64) -> f64 {
    let cells = (((end - start) / width) as usize).max(2);
    let lag = |head: usize| {
        let deviation = |cell: usize| stretch.deviation(head, end - cell as f64 * width);
        let mut middle: Vec<f64> = (cells / 4..=3 * cells / 4).map(deviation).collect();
        middle.sort_by(f64::total_cmp);
        let most = NEAR * middle[middle.len() / 2];
        (1..cells / 2).find(|&cell| deviation(cell) <= most).unwrap_or(cells / 2)
    };
    heads.iter().map(|&head| lag(head)).max().unwrap_or(1) as f64 * width
}
