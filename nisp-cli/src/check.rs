//! `nisp check`: what was understood of an equation and of its data, before anything is solved.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use nisp::noise;
use nisp::schema::{Group, Portion};
use nisp_equations::{Entry, Prepared, Request, Survey, require_partners};

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
    schema.groups.iter().try_for_each(require_partners).map_err(|error| error.to_string())?;
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
        line(format!("group {}{}", group.name, origin(entry, group, prepared.as_ref())));
        for term in group.terms {
            line(format!("  {} {}: {}", term.name, unit(&term.unit), term.equation));
            if latex {
                line(format!("    {}", term.latex));
            }
        }
        if let Some(prepared) = &prepared {
            held(entry, group, prepared).into_iter().for_each(&mut line);
            seen(group, prepared).into_iter().for_each(&mut line);
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

/// How many points a group has, and where they come from; of a single one, where it is.
fn origin(entry: &Entry, group: &Group, prepared: Option<&Prepared>) -> String {
    let lies = match group.place.map(|place| place.portion) {
        Some(Portion::Inside) => " inside its domain",
        Some(Portion::Boundary) => " on the boundary of its domain",
        Some(Portion::Start) => " where its domain begins",
        Some(Portion::End) => " where its domain ends",
        None => "",
    };
    let survey = prepared.and_then(|prepared| Survey::of(entry, prepared, group));
    match survey.map(|survey| (survey.axis(0).count(), survey)) {
        Some((1, survey)) => format!(": 1 point{lies}, {}", survey.place(survey.points)),
        Some((count, _)) => format!(": {count} points{lies}"),
        None if lies.is_empty() => String::new(),
        None => format!(":{lies}"),
    }
}

/// The columns of a group: their ranges, gaps, noise and strays, and how its rows lie in their domain.
fn held(entry: &Entry, group: &Group, prepared: &Prepared) -> Vec<String> {
    let schema = prepared.problem.scene().schema;
    let Some((_, columns)) = prepared.problem.group(group.name) else { return Vec::new() };
    let Some(survey) = Survey::of(entry, prepared, group).filter(|_| !columns.is_empty()) else { return Vec::new() };
    let mut lines = Vec::new();
    for (at, own) in schema.coordinates.iter().enumerate() {
        let domain =
            survey.declared(at).map(|[low, high]| format!(", in a domain of {} to {}", short(low), short(high)));
        lines.push(range(own.name, unit(&own.unit), survey.axis(at)) + &domain.unwrap_or_default());
    }
    let is_observed = |at: usize| group.terms.iter().any(|term| term.columns.contains(&at));
    for (at, (column, values)) in group.columns.iter().zip(columns).enumerate() {
        let mut text = range(column.name, unit(&column.unit), values.iter().copied());
        let gaps = values.iter().filter(|value| value.is_nan()).count();
        if gaps == values.len() {
            text = format!("{}: not measured", column.name);
        } else if gaps > 0 {
            let _ = write!(text, ", not measured in {gaps} of {} rows", values.len());
        }
        if let Some(noise) = survey.noise(values).filter(|_| is_observed(at)) {
            let _ = write!(text, ", noise about {noise:.1e}");
        }
        if let Some(strays) = survey.strays(values).filter(|_| is_observed(at)) {
            let _ = write!(text, ", {strays}");
        }
        lines.push(text);
    }
    lines.extend(survey.notes().into_iter().map(|note| format!("  {note}")));
    lines
}

/// The clouds of a group: their ranges, in the order of the surface's entries, and their noise.
fn seen(group: &Group, prepared: &Prepared) -> Vec<String> {
    let clouds = group.terms.iter().filter_map(|term| Some((term, prepared.problem.cloud(group.name, term.name)?)));
    let said = clouds.map(|(term, cloud)| {
        let entry = |at: usize| {
            let [low, high] = ends(cloud.iter().skip(at).step_by(term.rows).copied());
            format!("{} to {}", short(low), short(high))
        };
        let entries: Vec<String> = (0..term.rows).map(entry).collect();
        let in_space = if term.rows == 3 { cloud.as_chunks::<3>().0 } else { &[] };
        let noise = noise::of_cloud(in_space).map(|noise| format!(", noise about {noise:.1e}")).unwrap_or_default();
        let (points, unit) = (cloud.len() / term.rows.max(1), unit(&term.unit));
        format!("  cloud of {} {unit}: {points} points, {}{noise}", term.name, entries.join(", "))
    });
    said.collect()
}

fn range(name: &str, unit: String, values: impl Iterator<Item = f64>) -> String {
    let [low, high] = ends(values);
    format!("  {name} {unit}: {} to {}", short(low), short(high))
}

/// The least and the greatest of the numbers among some values.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let numbers = values.filter(|value| !value.is_nan());
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// Six digits at most.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
