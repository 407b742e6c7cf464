//! The frontier as a table, as CSV and as a plot.

use std::fmt::Write;

use nisp_data::DataError;
use nisp_data::picture::{LogLog, Mark, Picture, Quantity, Series, log_log};
use nisp_equations::Yardstick;

use super::trial::Trial;

/// What a trial reached within a budget.
pub(crate) struct Point {
    pub(super) trial: Trial,
    pub(super) budget: f64,
    pub(super) error: f64,
    pub(super) seconds: f64,
}

/// Everything that was measured.
pub(crate) struct Figures {
    pub(super) points: Vec<Point>,
    pub(super) rivals: Vec<Yardstick>,
    pub(super) samples: usize,
    /// What was added to truths; nothing for a scene that brings its own data.
    pub(super) noise: Option<f64>,
}

impl Figures {
    /// On what it was measured.
    pub(super) fn about(&self, seed: u64) -> String {
        let runs = if self.samples == 1 { "1 run".into() } else { format!("{} runs", self.samples) };
        match self.noise {
            None => format!("{runs}, the data as they are"),
            Some(0.0) => format!("{runs}, exact measurements"),
            Some(noise) => format!("{runs}, noise {noise}, seeds from {seed}"),
        }
    }

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

/// A Markdown table: a row for each method and width, a column for each budget, then the rivals.
pub(crate) fn table(figures: &Figures, about: &str, name: &str, unit: &str, budgets: &[f64]) -> String {
    let mut text = format!("Mean |error of {name}| [{unit}]: {about}.\n\n| method | width |");
    // Writing into a string cannot fail.
    for budget in budgets {
        let _ = write!(text, " {budget} s |");
    }
    let _ = writeln!(text, "\n|---|---|{}", "---|".repeat(budgets.len()));
    for (method, points) in figures.methods() {
        for row in points.chunk_by(|a, b| a.trial.width == b.trial.width) {
            let _ = write!(text, "| {method} | {} |", row[0].trial.width());
            for point in row {
                // A method that has converged says when.
                let early = point.seconds < 0.9 * point.budget;
                let when = if early { format!(" ({:.2} s)", point.seconds) } else { String::new() };
                let _ = write!(text, " {:.2e}{when} |", point.error);
            }
            text.push('\n');
        }
    }
    text.push_str("\n| rival | error | seconds |\n|---|---|---|\n");
    for Yardstick { name: rival, error, seconds } in &figures.rivals {
        let _ = writeln!(text, "| {rival} | {error:.2e} | {seconds:.2} |");
    }
    text
}

/// Every point and every rival, for other tools.
pub(crate) fn csv(figures: &Figures, unit: &str) -> String {
    let mut text = format!("method,width,precision,budget_s,wall_s,mean_abs_error [{unit}]\n");
    for Point { trial, budget, error, seconds } in &figures.points {
        let (method, precision) =
            if trial.local { ("local", "f64") } else { (trial.optimizer.name(), trial.precision.name()) };
        let _ = writeln!(text, "{method},{},{precision},{budget},{seconds},{error:e}", trial.width());
    }
    for Yardstick { name: rival, error, seconds } in &figures.rivals {
        let _ = writeln!(text, "{rival},,f64,,{seconds},{error:e}");
    }
    text
}

/// The best width of each method at each budget; rivals and Adam as levels.
pub(crate) fn plot(
    figures: &Figures,
    title: String,
    about: String,
    name: &str,
    unit: &str,
) -> Result<Picture, DataError> {
    let mut series = Vec::new();
    for (method, points) in figures.methods() {
        series.push(Series { name: method, points: frontier(&points), joined: true });
    }
    let mut marks: Vec<Mark> =
        figures.rivals.iter().map(|rival| Mark::Horizontal(rival.name.clone(), rival.error)).collect();
    let slowest = figures.rivals.iter().map(|rival| rival.seconds).fold(0.0, f64::max);
    if slowest > 0.0 {
        marks.push(Mark::Vertical("slowest rival".into(), slowest));
    }
    let adam = series.iter().filter(|series| series.name.starts_with("adam")).flat_map(|series| &series.points);
    if let Some([seconds, error]) = adam.min_by(|a, b| a[1].total_cmp(&b[1])).copied() {
        marks.push(Mark::Horizontal("best of Adam".into(), error));
        marks.push(Mark::Vertical("best of Adam".into(), seconds));
    }
    let widths = format!("{about}; at each time the best width of those tried");
    log_log(&LogLog {
        title,
        subtitle: widths,
        x: Quantity::new("wall time", "s"),
        y: Quantity::new(&format!("mean |error of {name}|"), unit),
        series,
        marks,
    })
}

/// Least error at each budget, over widths.
fn frontier(points: &[&Point]) -> Vec<[f64; 2]> {
    let mut budgets: Vec<f64> = points.iter().map(|point| point.budget).collect();
    budgets.sort_by(f64::total_cmp);
    budgets.dedup();
    let best = |budget: f64| {
        let own = points.iter().filter(|point| point.budget == budget && point.error > 0.0 && point.error.is_finite());
        own.min_by(|a, b| a.error.total_cmp(&b.error)).map(|point| [point.seconds, point.error])
    };
    budgets.into_iter().filter_map(best).collect()
}
