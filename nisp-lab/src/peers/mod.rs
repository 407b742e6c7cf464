//! `nisp-lab peers`: problems that others publish with their programs, solved by the settings of the command line.

mod problem;

use std::fs;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use nisp::solve::driver::{Flow, Status};
use nisp::{Settings, Solution, recover};
use nisp_cli::interrupt;
use nisp_cli::terminal::{print, progress};
use nisp_equations::{Prepared, Request};
use serde_json::json;

use crate::cases::Cases;
use crate::random::Random;
use problem::{Data, Problem, Truth, problems};

/// What came of an unknown.
struct Row {
    problem: &'static str,
    unknown: &'static str,
    /// Of a source over its points, root mean squares; of a parameter, magnitudes.
    relative_error: f64,
    /// Share of points within two deviations, where there are error bars.
    cover: Option<f64>,
    wall_s: f64,
    status: &'static str,
    /// Whether all checks of the answer passed.
    sound: bool,
}

/// Solves the problems and prints what came of them.
pub(crate) fn peers(options: &Cases) -> Result<ExitCode, String> {
    interrupt::listen(crate::NAME)?;
    let mut rows = Vec::new();
    if !options.json {
        print(&format!("{:14} {:8} {:>10} {:>6} {:>8}  status\n", "problem", "unknown", "error", "cover", "wall s"))?;
    }
    for problem in problems() {
        if options.only.as_ref().is_some_and(|only| !problem.name.contains(only)) {
            continue;
        }
        progress(problem.name);
        let found = solve(&problem, options)?;
        interrupt::check()?;
        progress("");
        if !options.json {
            print(&found.iter().map(line).collect::<String>())?;
        }
        rows.extend(found);
    }
    if rows.is_empty() {
        return Err("no problem has such a name".into());
    }
    if options.json {
        print(&format!("{}\n", json!({ "rows": rows.iter().map(object).collect::<Vec<_>>() })))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Reads a problem's text and binds it to its data.
fn prepare(problem: &Problem, data: &Data) -> Result<Prepared, String> {
    let fault = |error: std::io::Error| error.to_string();
    let folder = tempfile::tempdir().map_err(fault)?;
    let [text, table] = [format!("{}.pde", problem.name), "data.csv".into()].map(|name| folder.path().join(name));
    fs::write(&text, problem.text).map_err(fault)?;
    fs::write(&table, csv(data)).map_err(fault)?;
    let entry = crate::entry(&text.to_string_lossy())?;
    let request = Request { data: vec![(None, table)], ..Request::default() };
    entry.prepare(&request).map_err(|error| error.to_string())
}

fn solve(problem: &Problem, options: &Cases) -> Result<Vec<Row>, String> {
    let data = (problem.data)(&mut Random::new(options.seed));
    let start = Instant::now();
    let prepared = prepare(problem, &data)?;
    let settings = Settings {
        seed: options.seed,
        budget: Some(Duration::from_secs_f64(options.budget)),
        threads: options.threads(),
        ..Settings::default()
    };
    let mut watch = |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
    let mut solution = recover(&prepared.problem, &settings, &mut watch).map_err(|error| error.to_string())?;
    let sound = solution.verdict.passed();
    let unknowns = compare(&mut solution, &data.truth);
    let wall_s = start.elapsed().as_secs_f64();
    let status = match solution.status {
        Status::Converged => "converged",
        Status::Budget => "budget",
        Status::NotConverged | Status::Interrupted => "not_converged",
        Status::Inconsistent => "inconsistent",
    };
    let row = |(unknown, relative_error, cover)| Row {
        problem: problem.name,
        unknown,
        relative_error,
        cover,
        wall_s,
        status,
        sound,
    };
    Ok(unknowns.into_iter().map(row).collect())
}

fn csv(data: &Data) -> String {
    let rows = data.rows.iter().map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
    [data.columns.join(",")].into_iter().chain(rows).map(|line| line + "\n").collect()
}

/// Error and cover of every unknown.
fn compare(solution: &mut Solution, truth: &Truth) -> Vec<(&'static str, f64, Option<f64>)> {
    match truth {
        Truth::Parameters(parameters) => {
            let learned = solution.learned();
            let of = |(name, truth): &(&'static str, f64)| {
                let found = learned.iter().find(|learned| learned.name == *name)?;
                let off = (found.value - truth).abs();
                let cover = found.deviation.map(|deviation| f64::from(u8::from(off <= 2.0 * deviation)));
                Some((*name, off / truth.abs(), cover))
            };
            parameters.iter().filter_map(of).collect()
        }
        Truth::Source(name, places, values) => {
            let estimates = solution.evaluate_with_errors(&places.concat());
            let Some(found) = estimates.into_iter().find(|estimate| estimate.name == *name) else { return Vec::new() };
            let off: Vec<f64> = found.values.iter().zip(values).map(|(found, value)| (found - value).abs()).collect();
            let norm = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
            let cover = found.deviations.map(|deviations| {
                let within = off.iter().zip(&deviations).filter(|(off, deviation)| **off <= 2.0 * **deviation);
                within.count() as f64 / off.len() as f64
            });
            vec![(name, norm(&off) / norm(values), cover)]
        }
    }
}

fn line(row: &Row) -> String {
    let cover = row.cover.map_or_else(String::new, |cover| format!("{cover:.2}"));
    let Row { problem, unknown, relative_error, wall_s, status, sound, .. } = row;
    let doubt = if *sound { "" } else { ", not sound" };
    format!("{problem:14} {unknown:8} {relative_error:>10.1e} {cover:>6} {wall_s:>8.2}  {status}{doubt}\n")
}

fn object(row: &Row) -> serde_json::Value {
    json!({
        "problem": row.problem,
        "unknown": row.unknown,
        "relative_error": row.relative_error,
        "cover": row.cover,
        "wall_s": row.wall_s,
        "status": row.status,
        "sound": row.sound,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_is_bound_and_has_what_is_sought() {
        for problem in problems() {
            let data = (problem.data)(&mut Random::new(0));
            let prepared = prepare(&problem, &data).unwrap_or_else(|error| panic!("{}: {error}", problem.name));
            let schema = prepared.problem.scene().schema;
            match data.truth {
                Truth::Source(name, places, values) => {
                    assert!(schema.heads.iter().any(|head| head.name == name && head.source), "{}", problem.name);
                    assert!(places.len() == values.len() && places[0].len() == schema.coordinates.len());
                }
                Truth::Parameters(sought) => {
                    let is_learned = |name: &str| {
                        let own = schema.scalars.iter().find(|scalar| scalar.name == name);
                        own.is_some_and(|own| matches!(own.origin, nisp::schema::Origin::Learned { .. }))
                    };
                    assert!(sought.iter().all(|(name, _)| is_learned(name)), "{}", problem.name);
                }
            }
        }
    }
}
