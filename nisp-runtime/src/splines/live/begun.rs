//! The beginning of a record, or of what is left of it: its first rows are solved as a whole, and a window takes over.

use std::collections::VecDeque;

use super::super::cells::EXACT;
use super::event::Event;
use super::first::First;
use super::given::Given;
use super::grid::Grid;
use super::lag::{settled_lag, sought, width};
use super::met::Nearby;
use super::record::{Inward, Layout, MeasuredRow};
use super::under_way::{Live, SLACK, UNTOLD};
use super::window::Window;
use super::{LiveError, Smoothed};
use crate::problem::Problem;
use crate::units::{Declared, Engine, Number};

/// How many times as long as at first a lag that nobody has chosen may become.
const ROOM: f64 = 2.0;
/// Cells that a lag may take.
const MOST_CELLS: usize = 20_000;

/// What the first rows lead to.
pub(super) struct Begun {
    /// Answers of those that have waited long enough.
    pub(super) answers: Vec<Smoothed>,
    /// The others under way; nothing where there is a gap among the rows.
    pub(super) live: Option<Live>,
    /// Rows behind the gap.
    pub(super) behind: Vec<MeasuredRow<Declared>>,
}

impl Begun {
    /// Finds noise, smoothness and, where it is not given, the lag from rows, and answers them as a whole, but for the
    /// last ones, of which later rows tell more: `open` is that stretch over the lag.
    pub(super) fn with(
        problem: &Problem,
        layout: &Layout,
        mut rows: Vec<MeasuredRow<Declared>>,
        (lag, open): (Option<f64>, f64),
    ) -> Result<Self, LiveError> {
        layout.mark_strays(&mut rows);
        let told = told(&rows, open);
        let first = First::solve(problem, layout, &mut rows[..told])?;
        let begun = Self::of(first, layout, &rows, (lag, open))?;
        // The first solution follows a stray where it takes the source for rougher there. The window does not.
        if !begun.live.as_ref().is_some_and(|live| live.mark_strays(&mut rows[..told])) {
            return Ok(begun);
        }
        Self::of(First::of_marked(problem, layout, &rows[..told])?, layout, &rows, (lag, open))
    }

    /// Goes on from the first rows, solved.
    fn of(
        First { bound, stretch, opening, doubt }: First,
        layout: &Layout,
        rows: &[MeasuredRow<Declared>],
        (lag, open): (Option<f64>, f64),
    ) -> Result<Self, LiveError> {
        let told = told(rows, open);
        let schema = bound.problem.scene().schema;
        let system = bound.system;
        let inward = Inward {
            at: system.inward(&schema.coordinates[0].unit),
            values: layout.columns.iter().map(|column| system.inward(&column.unit)).collect(),
        };
        let rows: Vec<MeasuredRow<Engine>> = rows.iter().map(|row| row.inward(&inward)).collect();
        let (start, end) = (rows[0].at, rows[told - 1].at);
        let width = width(&rows);
        let sought: Vec<usize> = sought(&bound);
        let settled = settled_lag(&stretch, &sought, (start, end), width);
        // Rows that a value says something of.
        let reach = (settled / width).round() as usize;
        let given = lag.map(|lag| inward.at.of(Number::declared(lag)).as_engine());
        let lag = match (lag, given) {
            (Some(lag), Some(given)) if given > MOST_CELLS as f64 * width => {
                return Err(LiveError::Lag { lag, most: MOST_CELLS });
            }
            _ => given.unwrap_or(settled),
        };
        let most_lag = if given.is_some() { lag } else { ROOM * lag };
        // Where rows are exact, cells are as many as in an answer to all of them.
        let width = if stretch.weights.noise.is_exact() { width / EXACT } else { width };
        let grid = Grid::new(start, width, most_lag);
        let mut conditions: Vec<Event> = Vec::new();
        for (group, declared) in schema.groups.iter().enumerate() {
            let is_condition = declared.columns.is_empty() && !declared.is_beliefs();
            if is_condition && !layout.continuous.contains(&group) {
                let places = bound.coordinates[group].iter();
                conditions.extend(places.map(|&at| Event::plain(group, at)));
            }
        }
        for &group in &layout.continuous {
            conditions.extend(grid.beginning().map(|at| Event::plain(group, at)));
        }
        conditions.retain(|condition| condition.at >= start - SLACK * width);
        conditions.sort_by(|a, b| a.at.total_cmp(&b.at));
        let outward = schema.heads.iter().map(|head| system.outward(&head.unit)).collect();
        let known = |head: usize, at: f64| (at <= end).then(|| stretch.value(head, at.max(start)));
        let mut window = Window::new(bound, stretch.weights.clone(), grid, &layout.continuous);
        window.guess(&known);
        let given = Given::behind(end, doubt, &window);
        let mut live = Live {
            window,
            opening: opening.map(|opening| opening.until(end - open * lag)),
            inward,
            outward,
            lag,
            most_lag,
            pending: VecDeque::new(),
            conditions: conditions.into(),
            last: start,
            square: 1.0,
            nearby: [0, reach / 2, reach].map(Nearby::ahead),
            bends: [0, reach / 2].map(Nearby::ahead),
            recent: VecDeque::new(),
            rows: 0,
            unsound: 0,
            given,
            due: 2 * rows.len(),
            asked: None,
        };
        let mut answers = Vec::new();
        let behind = live.replay(layout, rows, &known, &mut answers)?;
        let behind: Vec<MeasuredRow<Declared>> = behind.iter().map(|row| row.outward(&live.inward)).collect();
        if behind.is_empty() {
            return Ok(Self { answers, live: Some(live), behind });
        }
        answers.extend(live.finish());
        Ok(Self { answers, live: None, behind })
    }
}

/// How many of the first rows tell something.
fn told(rows: &[MeasuredRow<Declared>], open: f64) -> usize {
    if open > 0.0 { rows.len() - UNTOLD } else { rows.len() }
}
