//! The frontier as tables, as CSV and as a plot.

use std::fmt::Write;

use nisp_data::DataError;
use nisp_data::picture::{LogLog, Mark, Picture, Quantity, Series, log_log};
use nisp_equations::Yardstick;

use super::trial::{Outcome, Reached, Trial};
use crate::measure::Measure;

/// What a trial came to within a budget.
pub(crate) struct Point {
    pub(super) trial: Trial,
    pub(super) budget: f64,
    pub(super) outcome: Outcome,
}

impl Point {
    fn reached(&self) -> Option<&Reached> {
        match &self.outcome {
            Outcome::Reached(reached) => Some(reached),
            Outcome::Refused(_) => None,
        }
    }
}

/// Everything that was measured.
pub(crate) struct Figures {
    /// On what it was measured.
    pub(super) about: String,
    /// The error of the head first.
    pub(super) measures: Vec<Measure>,
    pub(super) budgets: Vec<f64>,
    pub(super) widths: Vec<usize>,
    pub(super) points: Vec<Point>,
    pub(super) rivals: Vec<Yardstick>,
}

impl Figures {
    /// Points by method and precision, in the order of the trials.
    fn methods(&self) -> Vec<(String, Vec<&Point>)> {
        let mut methods: Vec<(String, Vec<&Point>)> = Vec::new();
        for point in &self.points {
            let name = point.trial.name();
            match methods.iter_mut().find(|(own, _)| *own == name) {
                Some((_, points)) => points.push(point),
                None => methods.push((name, vec![point])),
            }
        }
        methods
    }
}

/// Markdown: a table for each measure, with a row for each method and a column for each budget and width, then the rivals.
pub(crate) fn tables(figures: &Figures) -> String {
    let mut text = format!("{}.\n", figures.about);
    for (index, measure) in figures.measures.iter().enumerate() {
        table(figures, index, *measure, &mut text);
    }
    rivals(figures, &mut text);
    refusals(figures, &mut text);
    text
}

// Writing into a string cannot fail.
fn table(figures: &Figures, index: usize, measure: Measure, text: &mut String) {
    let Figures { budgets, widths, .. } = figures;
    let _ = write!(text, "\n| {} |", measure.title());
    for budget in budgets {
        for width in widths {
            let _ = match widths.len() {
                1 => write!(text, " {budget} s |"),
                _ => write!(text, " {budget} s, width {width} |"),
            };
        }
    }
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(budgets.len() * widths.len()));
    for (method, points) in figures.methods() {
        let _ = write!(text, "| {method} |");
        for budget in budgets {
            for (column, width) in widths.iter().enumerate() {
                let is_here = |trial: &Trial| if trial.local { column == 0 } else { trial.width == *width };
                let point = points.iter().find(|point| point.budget == *budget && is_here(&point.trial));
                let _ = match point {
                    Some(point) => write!(text, " {} |", cell(point, index, measure)),
                    // Local functions have no width.
                    None => write!(text, " |"),
                };
            }
        }
        text.push('\n');
    }
}

/// A value; beside an error also the time, where a method did not end with the budget.
fn cell(point: &Point, index: usize, measure: Measure) -> String {
    let Some(reached) = point.reached() else { return "n/a".into() };
    let value = measure.shown(reached.values[index]);
    let share = reached.seconds / point.budget;
    if index > 0 || (0.9..1.1).contains(&share) {
        return value;
    }
    let how = if reached.gave_up && share < 1.0 { ", gave up" } else { "" };
    format!("{value} ({:.2} s{how})", reached.seconds)
}

fn rivals(figures: &Figures, text: &mut String) {
    if figures.rivals.is_empty() {
        return;
    }
    let contact = figures.rivals.iter().any(|rival| rival.overlap.is_some());
    let [title, rule] = if contact { [" IoU |", "---|"] } else { ["", ""] };
    let _ = writeln!(text, "\n| rival | {} |{title} seconds |\n|---|---|{rule}---|", figures.measures[0].title());
    for Yardstick { name, error, overlap, seconds } in &figures.rivals {
        let _ = write!(text, "| {name} | {error:.2e} |");
        if contact {
            let _ = write!(text, " {} |", Measure::Overlap.shown(*overlap));
        }
        let _ = writeln!(text, " {seconds:.2} |");
    }
}

/// Why cells are empty.
fn refusals(figures: &Figures, text: &mut String) {
    let mut said = Vec::new();
    for point in &figures.points {
        if let Outcome::Refused(why) = &point.outcome
            && !said.contains(&why)
        {
            let _ = writeln!(text, "{}- n/a: {why}", if said.is_empty() { "\n" } else { "" });
            said.push(why);
        }
    }
}

/// Every point and every rival, for other tools.
pub(crate) fn csv(figures: &Figures) -> String {
    let mut text = String::from("method,width,precision,budget_s,wall_s,gave_up");
    for measure in &figures.measures {
        let _ = write!(text, ",{}", measure.title());
    }
    text.push('\n');
    let mut values = |start: String, values: &[Option<f64>]| {
        text.push_str(&start);
        for value in values {
            let _ = write!(text, ",{}", value.map_or_else(String::new, |value| format!("{value:e}")));
        }
        text.push('\n');
    };
    for Point { trial, budget, outcome } in &figures.points {
        let start = format!("{},{},{},{budget}", trial.method(), trial.width(), trial.precision.name());
        match outcome {
            Outcome::Reached(Reached { values: own, seconds, gave_up }) => {
                values(format!("{start},{seconds},{gave_up}"), own);
            }
            Outcome::Refused(_) => values(format!("{start},,"), &vec![None; figures.measures.len()]),
        }
    }
    for Yardstick { name, error, overlap, seconds } in &figures.rivals {
        let own = figures.measures.iter().map(|measure| match measure {
            Measure::Error(..) => Some(*error),
            Measure::Overlap => *overlap,
            Measure::Distance | Measure::Force | Measure::Learned(..) => None,
        });
        values(format!("{name},,f64,,{seconds},"), &own.collect::<Vec<_>>());
    }
    text
}

/// A measure of the best width of each method at each budget; rivals and Adam as levels. Nothing where nobody has a value.
pub(crate) fn plot(figures: &Figures, measure: Measure, title: String) -> Result<Option<Picture>, DataError> {
    let Some(index) = figures.measures.iter().position(|own| *own == measure) else { return Ok(None) };
    let mut families = Vec::new();
    let mut series = Vec::new();
    for (name, points) in figures.methods() {
        let method = points[0].trial.method();
        let family = families.iter().position(|own| *own == method).unwrap_or(families.len());
        if family == families.len() {
            families.push(method);
        }
        let points = frontier(&points, index);
        let name = if points.is_empty() { format!("{name}: none") } else { name };
        series.push(Series { name, family, points, joined: true });
    }
    let Some(first) = series.iter().flat_map(|series| &series.points).map(|point| point[0]).reduce(f64::min) else {
        return Ok(None);
    };
    let mut marks = Vec::new();
    if index == 0 {
        let drawn = figures.rivals.iter().filter(|rival| rival.error > 0.0 && rival.error.is_finite());
        marks.extend(drawn.map(|rival| Mark::Horizontal(rival.name.clone(), rival.error)));
        let slowest = figures.rivals.iter().map(|rival| rival.seconds).fold(0.0, f64::max);
        if slowest > LEAST_TIME * first {
            marks.push(Mark::Vertical("slowest rival".into(), slowest));
        }
    }
    let adam = series.iter().filter(|series| series.name.starts_with("adam")).flat_map(|series| &series.points);
    if let Some([seconds, error]) = adam.min_by(|a, b| a[1].total_cmp(&b[1])).copied() {
        marks.push(Mark::Horizontal("best of Adam".into(), error));
        marks.push(Mark::Vertical("best of Adam".into(), seconds));
    }
    let chosen = if figures.widths.len() > 1 { "; at each time the best width of those tried" } else { "" };
    let (what, unit) = measure.quantity();
    log_log(&LogLog {
        title,
        subtitle: format!("{}{chosen}", figures.about),
        x: Quantity::new("wall time", "s"),
        y: Quantity::new(&what, unit),
        series,
        marks,
    })
    .map(Some)
}

/// Share of the first point's time from which on a rival's time is worth the room.
const LEAST_TIME: f64 = 1e-2;

/// Least value of a measure at each budget, over widths.
fn frontier(points: &[&Point], index: usize) -> Vec<[f64; 2]> {
    let mut budgets: Vec<f64> = points.iter().map(|point| point.budget).collect();
    budgets.sort_by(f64::total_cmp);
    budgets.dedup();
    let best = |budget: f64| {
        let own = points.iter().filter(|point| point.budget == budget).filter_map(|point| {
            let reached = point.reached()?;
            Some([reached.seconds, reached.values[index].filter(|value| *value > 0.0 && value.is_finite())?])
        });
        own.min_by(|a, b| a[1].total_cmp(&b[1]))
    };
    budgets.into_iter().filter_map(best).collect()
}
