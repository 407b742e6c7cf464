//! What a run says of itself: a table for people, one JSON object for programs.

use std::fmt::Write;

use nisp::solve::driver::Status;
use nisp::{Settings, Solution};
use nisp_data::OutDir;
use nisp_equations::Prepared;
use nisp_equations::rivals::mean_abs_error;

use crate::args::Options;
use crate::score::Score;

/// Rivals have no way to be quick on more measurements than this.
const ROWS_FOR_RIVALS: usize = 2000;

fn status(solution: &Solution) -> &'static str {
    match solution.status {
        Status::Converged => "converged",
        Status::Budget => "budget",
        Status::NotConverged | Status::Interrupted => "not_converged",
    }
}

/// How the run ended, in words.
fn end(solution: &Solution) -> &'static str {
    match solution.status {
        Status::Converged => "converged",
        Status::Budget => "budget spent",
        Status::NotConverged => "not converged",
        Status::Interrupted => "interrupted",
    }
}

/// The object of `--json`, on one line.
pub(crate) fn json(
    solution: &Solution,
    options: &Options,
    settings: &Settings,
    scores: &[Score],
    warnings: &[String],
) -> String {
    let mut errors = serde_json::Map::new();
    for score in scores {
        errors.insert(score.name.into(), score.mean_abs.into());
        if let Some(if_zero) = score.if_zero {
            errors.insert(format!("{}_if_zero", score.name), if_zero.into());
        }
    }
    let object = serde_json::json!({
        "scene": options.equation,
        "status": status(solution),
        "seed": settings.seed,
        "precision": settings.precision.name(),
        "optimizer": solution.optimizer.name(),
        "threads": settings.threads,
        "wall_s": solution.wall_s,
        "iterations": solution.iterations,
        "loss": solution.loss,
        "warnings": warnings,
        "errors": errors,
        "settings": {
            "scene": solution.scene().name,
            "data": options.data,
            "truth": options.truth,
            "columns": options.column.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
            "parameters": options.set.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
            "optimizer": settings.optimizer.name(),
            "width": options.width,
            "layers": options.layers,
            "budget_s": options.budget,
            "iterations": options.iterations,
            "out": options.out,
            "isa": solution.isa(),
        },
    });
    format!("{object}\n")
}

/// A short table: errors beside those of simpler answers, time, points, channels, what was skipped.
pub(crate) fn table(
    solution: &mut Solution,
    prepared: &Prepared,
    scores: &[Score],
    warnings: &[String],
    out: &OutDir,
) -> String {
    let mut text = String::new();
    let scene = solution.scene();
    // Writing into a string cannot fail.
    let mut line = |content: String| {
        let _ = writeln!(text, "{}", content.trim_end());
    };
    line(format!("{}, scene {}, from {}", scene.module, scene.name, prepared.source));
    let threads = solution.settings.threads;
    line(format!(
        "{} after {:.1} s: {} steps of {} in {} on {threads} thread{}, loss {:.3e}",
        end(solution),
        solution.wall_s,
        solution.iterations,
        solution.optimizer.name(),
        solution.settings.precision.name(),
        if threads == 1 { "" } else { "s" },
        solution.loss
    ));
    for (group, points) in solution.groups() {
        line(format!("  {:10} {points} points, channels {}", group.name, group.channels.join(" ")));
    }
    for skipped in scene.skipped {
        line(format!("  skipped    {skipped}"));
    }
    if !scores.is_empty() {
        line("mean absolute error".into());
    }
    for score in scores {
        line(format!("  {:26} {:.2e} {}", score.name, score.mean_abs, score.unit));
        if let Some(if_zero) = score.if_zero {
            for (name, error) in
                std::iter::once((format!("{} = 0", score.name), if_zero)).chain(rivals(prepared, score))
            {
                line(format!("    {name:24} {error:.2e} {}", score.unit));
            }
        }
    }
    for learned in solution.learned() {
        let deviation = learned.deviation.map_or_else(String::new, |deviation| format!(" ± {deviation:.2e}"));
        line(format!("learned {} = {:.6e}{deviation} {}", learned.name, learned.value, learned.unit.text));
    }
    for warning in warnings {
        line(format!("warning: {warning}"));
    }
    line(format!("wrote source.csv, state.csv and plot.svg to {}", out.path().display()));
    text
}

/// Errors of the classical rivals, where they can be asked.
fn rivals(prepared: &Prepared, score: &Score) -> Vec<(String, f64)> {
    let known = prepared.truth.as_ref().and_then(|truth| Some((&truth.points, truth.of(score.name)?)));
    let Some((at, values)) = known.filter(|_| prepared.points.len() <= ROWS_FOR_RIVALS) else { return Vec::new() };
    let answers = prepared.contest(at, values).into_iter();
    let errors = answers.map(|answer| (answer.name.into(), mean_abs_error(&answer.source, values)));
    errors.filter(|(_, error)| error.is_finite()).collect()
}
