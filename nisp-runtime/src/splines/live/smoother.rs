//! The smoother: rows in, answers at the lag out.

use std::collections::VecDeque;
use std::thread::{self, JoinHandle};

use super::again::Patience;
use super::evidence::{Stretch, Weights};
use super::grid::Grid;
use super::opening::Opening;
use super::record::{Layout, MeasuredRow};
use super::window::{Event, Known, Window};
use super::{LagSettings, LiveError, RowColumn, Smoothed};
use crate::problem::Problem;
use crate::solve::fault::Fault;

/// Rows that say anything of a noise and a source.
const FEWEST: usize = 10;
/// Cells that a lag may take.
const MOST_CELLS: usize = 20_000;
/// How much larger a source's deviation may be at the lag than after any wait.
const NEAR: f64 = 1.05;
/// Steps over the first cells at most, and the change that no longer matters.
const FIRST_STEPS: usize = 20;
const SETTLED: f64 = 1e-8;
const MORE_STEPS: usize = 5;
const SMALL: f64 = 0.5;
/// Rows of a later stretch that is asked for noise and smoothness, at most, and rows between such stretches, at most.
const STRETCH: usize = 1000;
const BETWEEN: usize = 4000;
/// Values that the running mean of misfits looks back over, and the square that one may count for: a value that stands alone
/// does not make equations wrong.
const LOOKED_BACK: f64 = 100.0;
const LARGEST_SQUARE: f64 = 16.0;
/// The same about a place: answers beside a value that stands alone are wrong.
const NEARBY: f64 = 12.0;
const LARGEST_NEARBY: f64 = 200.0;
/// Share of a cell by which a place may miss the lag.
const SLACK: f64 = 1e-6;

/// Smooths a record as it comes: every row is answered once the record is a lag farther.
///
/// Work and memory of a row are bounded, whatever the length of the record. The same rows give the same answers.
pub struct FixedLagSmoother {
    problem: Problem,
    pub(super) settings: LagSettings,
    layout: Layout,
    /// Place of the last row, in the declared unit.
    last: Option<f64>,
    /// Rows in declared units until noise and smoothness are known.
    waiting: Vec<MeasuredRow>,
    pub(super) live: Option<Live>,
    pub(super) patience: Patience,
}

/// Rows under way.
pub(super) struct Live {
    window: Window,
    /// The answer to the first rows, while one of them waits.
    opening: Option<Opening>,
    /// From declared units to the engine's: of the coordinate, and of each column.
    inward: (f64, Vec<f64>),
    outward: Vec<f64>,
    lag: f64,
    /// Places of rows that have no answer yet, with what was measured there.
    pending: VecDeque<(f64, Vec<Event>)>,
    /// Conditions at places that the record has not reached yet.
    conditions: VecDeque<Event>,
    last: f64,
    /// Running mean of the squares of misfits over the noise, of rows that have an answer.
    square: f64,
    /// The same of fewer rows, up to the one that is answered and up to two behind it: a value that stands alone, or a source that
    /// is followed too slowly, spoils answers on both of its sides.
    nearby: [Nearby; 3],
    /// The last rows, for the next stretch.
    recent: VecDeque<MeasuredRow>,
    rows: usize,
    /// Number of the row at which a stretch is asked next, or its answer taken over.
    due: usize,
    asked: Option<JoinHandle<Result<Weights, LiveError>>>,
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
                Err(error) => return self.begin_again().ok_or(error),
                Ok(Reach::Gap) => {
                    found.extend(live.finish());
                    self.live = None;
                }
            }
        }
        self.waiting.push(MeasuredRow { at, values: values.to_vec() });
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
    pub(super) fn begin_with(
        &mut self,
        rows: Vec<MeasuredRow>,
        lag: Option<f64>,
        open: f64,
    ) -> Result<Vec<Smoothed>, LiveError> {
        let bound = self.layout.bound(&self.problem, &rows)?;
        let (stretch, opening) = rayon::join(|| Stretch::solve(&bound, None), || Opening::solve(&bound));
        let stretch = stretch?;
        let schema = self.problem.scene().schema;
        let system = bound.system;
        let by = system.inward(&schema.coordinates[0].unit);
        let inward = (by, self.layout.columns.iter().map(|column| system.inward(&column.unit)).collect::<Vec<_>>());
        let rows: Vec<MeasuredRow> = rows.iter().map(|row| scaled_row(&inward, row.at, &row.values)).collect();
        let (start, end) = (rows[0].at, rows[rows.len() - 1].at);
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
                conditions.extend(places.map(|&at| Event { group, at, columns: Vec::new() }));
            }
        }
        for &group in &self.layout.continuous {
            conditions.extend(grid.beginning().map(|at| Event { group, at, columns: Vec::new() }));
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
            nearby: [0, reach / 2, reach].map(|ahead| Nearby { ahead, square: 1.0, counted: 0 }),
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
}

/// A running mean of squares up to a row that waits.
struct Nearby {
    /// How many rows that is behind the one that is answered.
    ahead: usize,
    square: f64,
    /// Rows that wait and have been counted.
    counted: usize,
}

impl Nearby {
    fn count_up(&mut self, answers: (&Window, Option<&Opening>), pending: &VecDeque<(f64, Vec<Event>)>) {
        for (_, events) in pending.iter().take(self.ahead + 1).skip(self.counted) {
            count(answers, events, &mut self.square, (NEARBY, LARGEST_NEARBY));
            self.counted += 1;
        }
    }
}

/// Whether a row could be reached from the last one.
enum Reach {
    Whole,
    Gap,
}

impl Live {
    fn inward(&self, at: f64, values: &[f64]) -> MeasuredRow {
        scaled_row(&self.inward, at, values)
    }

    /// Takes the first rows, whose first cells are found together. Gives back those behind a gap.
    fn replay(
        &mut self,
        layout: &Layout,
        rows: Vec<MeasuredRow>,
        known: Known<'_>,
        found: &mut Vec<Smoothed>,
    ) -> Result<Vec<MeasuredRow>, LiveError> {
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

    fn ask(&mut self, layout: &Layout, row: MeasuredRow) {
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

    fn push(
        &mut self,
        layout: &Layout,
        row: MeasuredRow,
        known: Known<'_>,
        found: &mut Vec<Smoothed>,
    ) -> Result<Reach, LiveError> {
        self.renew(layout)?;
        let (right, width) = (self.window.grid().right(), self.window.grid().width);
        let cells = ((row.at - right) / width - SLACK).ceil().max(0.0);
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

    /// A step, down to the first row that waits.
    fn solve(&mut self) -> Result<(), Fault> {
        let grid = self.window.grid();
        let wanted = self.pending.front().map_or(grid.tail_start(), |(at, _)| grid.cell(*at));
        let from = wanted.min(grid.tail_start()).max(grid.begun());
        for _ in 0..MORE_STEPS {
            if self.window.solve(from)? < SMALL {
                break;
            }
        }
        Ok(())
    }

    /// Answers the rows that have waited for a lag.
    fn answer(&mut self, found: &mut Vec<Smoothed>) {
        let slack = SLACK * self.window.grid().width;
        while self.pending.front().is_some_and(|(at, _)| *at <= self.last - self.lag + slack) {
            found.extend(self.answer_next());
        }
    }

    /// True where equations and data no longer agree.
    pub(super) fn is_lost(&self) -> bool {
        let nearby = self.nearby[..1].iter().map(|nearby| nearby.square.sqrt());
        nearby.fold(0.0, f64::max) > Smoothed::NEARBY || self.square.sqrt() > Smoothed::MISFIT
    }

    /// So many of the last rows at most, in declared units.
    pub(super) fn last_rows(&self, most: usize) -> Vec<MeasuredRow> {
        self.outward(self.recent.iter().skip(self.recent.len().saturating_sub(most)))
    }

    /// Rows in declared units.
    fn outward<'a>(&self, rows: impl Iterator<Item = &'a MeasuredRow>) -> Vec<MeasuredRow> {
        let (by, factors) = &self.inward;
        let outward: (f64, Vec<f64>) = (by.recip(), factors.iter().map(|factor| factor.recip()).collect());
        rows.map(|row| scaled_row(&outward, row.at, &row.values)).collect()
    }

    /// The lag, and the place of the first row without an answer, in the declared unit.
    pub(super) fn declared_lag(&self) -> f64 {
        self.lag / self.inward.0
    }

    pub(super) fn first_waiting(&self) -> Option<f64> {
        self.pending.front().map(|(at, _)| at / self.inward.0)
    }

    /// Answers the rows that wait before a place in the declared unit.
    pub(super) fn answer_before(&mut self, place: f64) -> Vec<Smoothed> {
        let place = place * self.inward.0;
        let mut found = Vec::new();
        while self.pending.front().is_some_and(|(at, _)| *at < place) {
            found.extend(self.answer_next());
        }
        found
    }

    fn answer_next(&mut self) -> Option<Smoothed> {
        let next = self.pending.front()?.0;
        self.opening.take_if(|opening| !opening.answers(next));
        let (window, opening) = (&mut self.window, self.opening.as_ref());
        for nearby in &mut self.nearby {
            nearby.count_up((window, opening), &self.pending);
        }
        let (at, events) = self.pending.pop_front()?;
        self.nearby.iter_mut().for_each(|nearby| nearby.counted = nearby.counted.saturating_sub(1));
        count((window, opening), &events, &mut self.square, (LOOKED_BACK, LARGEST_SQUARE));
        let read = |(head, outward): (usize, &f64)| {
            let (value, deviation) = opening.map_or_else(|| window.read(head, at), |opening| opening.read(head, at));
            (value * outward, deviation * outward)
        };
        let heads = self.outward.iter().enumerate().map(read).collect();
        let outward = self.inward.0.recip();
        let nearby = self.nearby.iter().map(|nearby| nearby.square.sqrt()).fold(0.0, f64::max);
        let (lag, misfit, leaning) = ((self.last - at) * outward, self.square.sqrt(), self.window.weights().leaning);
        Some(Smoothed { at: at * outward, lag, heads, misfit, nearby, leaning })
    }

    /// Answers all rows that wait.
    fn finish(&mut self) -> Vec<Smoothed> {
        std::iter::from_fn(|| self.answer_next()).collect()
    }

    /// Asks the last rows for noise and smoothness now and then, on another thread. What they say is taken over at a row whose
    /// number is known beforehand, so that answers do not depend on time.
    fn renew(&mut self, layout: &Layout) -> Result<(), LiveError> {
        if self.rows < self.due {
            return Ok(());
        }
        let between = self.rows.min(BETWEEN);
        match self.asked.take() {
            Some(asked) => {
                // A stretch that cannot be solved leaves what is known as it is.
                if let Ok(Ok(weights)) = asked.join() {
                    self.window.weigh(weights);
                }
                self.due = self.rows + between;
            }
            None => {
                let stretch = layout.stretch(&self.window.bound, self.recent.make_contiguous());
                let from = self.window.weights().clone();
                let solve = move || Stretch::solve(&stretch, Some(&from)).map(|stretch| stretch.weights);
                self.asked = thread::Builder::new().name("evidence".into()).spawn(solve).ok();
                self.due = self.rows + between / 4;
            }
        }
        Ok(())
    }
}

/// Counts the misfits of a row's values in a running mean of their squares over so many values, none larger than that.
fn count(
    (window, opening): (&Window, Option<&Opening>),
    events: &[Event],
    mean: &mut f64,
    (values, largest): (f64, f64),
) {
    let splines = opening.map(Opening::splines);
    for event in events {
        window.misfits(event, splines, &mut |misfit| *mean += ((misfit * misfit).min(largest) - *mean) / values);
    }
}

fn scaled_row((by, factors): &(f64, Vec<f64>), at: f64, values: &[f64]) -> MeasuredRow {
    MeasuredRow { at: at * by, values: values.iter().zip(factors).map(|(value, factor)| value * factor).collect() }
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
