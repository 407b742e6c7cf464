//! `nisp check`: what was understood of an equation and of its data, before anything is solved.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use nisp::schema::{Group, Portion};
use nisp_equations::rivals::noise_level;
use nisp_equations::{Entry, Prepared, Request};

use crate::explain::{unit, unknowns};

/// Prints a scene's unknowns and conditions and, with data, where each group's points come from and what each column holds.
pub(crate) fn check(
    entry: &Entry,
    scene: Option<String>,
    data: Vec<(Option<String>, PathBuf)>,
    columns: Vec<(String, String)>,
    latex: bool,
) -> Result<ExitCode, String> {
    let schema = entry.scene(scene.as_deref()).map_err(|error| error.to_string())?.schema;
    let prepared = if data.is_empty() && entry.data.is_empty() {
        None
    } else {
        let request = Request { scene, data, columns, ..Request::default() };
        Some(entry.prepare(&request).map_err(|error| error.to_string())?)
    };
    let mut text = String::new();
    // Writing into a string cannot fail.
    let mut line = |content: String| {
        let _ = writeln!(text, "{}", content.trim_end());
    };
    unknowns(schema).into_iter().for_each(&mut line);
    for group in schema.groups.iter().filter(|group| !group.is_beliefs()) {
        line(format!("group {}{}", group.name, origin(group, prepared.as_ref())));
        for term in group.terms {
            line(format!("  {} {}: {}", term.name, unit(&term.unit), term.equation));
            if latex {
                line(format!("    {}", term.latex));
            }
        }
        if let Some(prepared) = &prepared {
            held(group, prepared).into_iter().for_each(&mut line);
        }
    }
    for warning in schema.warnings {
        line(format!("note: {}", warning.lines().next().unwrap_or_default()));
    }
    if let Some(prepared) = &prepared {
        line(format!("data: {}", prepared.source));
        prepared.warnings.iter().for_each(|warning| line(format!("note: {warning}")));
    } else {
        line("data: none given; `--data FILE` says what is seen in them".into());
    }
    crate::terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// How many points a group has, and where they come from.
fn origin(group: &Group, prepared: Option<&Prepared>) -> String {
    let lies = match group.place.map(|place| place.portion) {
        Some(Portion::Inside) => " inside its domain",
        Some(Portion::Boundary) => " on the boundary of its domain",
        Some(Portion::Start) => " where its domain begins",
        Some(Portion::End) => " where its domain ends",
        None => "",
    };
    let axes = prepared.map(|prepared| prepared.problem.scene().schema.coordinates.len());
    let points = prepared.and_then(|prepared| prepared.problem.group(group.name));
    match points.zip(axes) {
        Some(((points, _), axes)) => match points.coordinates.len() / axes {
            1 => format!(": 1 point{lies}"),
            count => format!(": {count} points{lies}"),
        },
        None if lies.is_empty() => String::new(),
        None => format!(":{lies}"),
    }
}

/// The columns of a group: their ranges, gaps and noise.
fn held(group: &Group, prepared: &Prepared) -> Vec<String> {
    let schema = prepared.problem.scene().schema;
    let Some((points, columns)) = prepared.problem.group(group.name) else { return Vec::new() };
    if columns.is_empty() {
        return Vec::new();
    }
    let axes = schema.coordinates.len();
    let axis = |at: usize| points.coordinates.iter().skip(at).step_by(axes).copied();
    let ranges = schema.coordinates.iter().enumerate().map(|(at, own)| range(own.name, unit(&own.unit), axis(at)));
    let mut lines: Vec<String> = ranges.collect();
    for (column, values) in group.columns.iter().zip(columns) {
        let mut text = range(column.name, unit(&column.unit), values.iter().copied());
        let measured: Vec<(f64, f64)> =
            axis(0).zip(values.iter().copied()).filter(|(_, value)| !value.is_nan()).collect();
        if measured.len() < values.len() {
            let _ = write!(text, ", not measured in {} of {} rows", values.len() - measured.len(), values.len());
        }
        let (at, values): (Vec<f64>, Vec<f64>) = measured.into_iter().unzip();
        // A classical smoother takes a course that it cannot follow for no noise at all.
        if let (1, Some(noise)) = (axes, noise_level(&at, &values).ok().filter(|noise| *noise > 0.0)) {
            let _ = write!(text, ", noise about {noise:.1e}");
        }
        lines.push(text);
    }
    lines
}

fn range(name: &str, unit: String, values: impl Iterator<Item = f64>) -> String {
    let ends = values.filter(|value| !value.is_nan());
    let [low, high] =
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    format!("  {name} {unit}: {} to {}", short(low), short(high))
}

/// Six digits at most.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
