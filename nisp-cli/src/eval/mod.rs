//! `nisp eval`: values, derivatives and declared expressions of a saved answer, without its data.

mod points;
mod report;

use std::path::Path;
use std::process::ExitCode;

use crate::terminal::{NOT_CONVERGED, NOT_WRITTEN, note, print};
use nisp::{Estimate, OpenAnswer, SavedAnswer};
use nisp_data::input::read_bytes;
use nisp_interpreter::{ask, is_same_equation, open};

use crate::args::EvalOptions;
use crate::inputs::spare;
use crate::program::Program;

/// Bytes of an answer at most: the largest networks that fit into memory stay below.
const MOST_BYTES: u64 = 4 << 30;

/// What was read of an answer.
struct Evaluated {
    saved: SavedAnswer,
    answer: OpenAnswer,
    /// Point by point, in declared units.
    points: Vec<f64>,
    /// What was asked for, NaN at points outside.
    estimates: Vec<Estimate>,
    /// What its user should know, one line each.
    warnings: Vec<String>,
}

/// Reads an answer at the points that are wanted, and prints or writes what it says there.
pub(crate) fn eval(program: &Program, options: &EvalOptions) -> Result<ExitCode, String> {
    let path = &options.answer;
    options.out.iter().try_for_each(|out| spare(&options.inputs(), out))?;
    let saved = read(path)?;
    let (answer, names) = match &options.of {
        None => {
            let answer = open(&saved).map_err(|error| format!("{}: {error}", path.display()))?;
            let names = answer.scene().heads.iter().map(|head| head.name.to_string()).collect();
            (answer, names)
        }
        Some(expressions) => ask(&saved, expressions).map_err(|error| format!("--of: {error}"))?,
    };
    if names.is_empty() {
        return Err("--of: nothing is asked for; name fields, sources, definitions or expressions of them".into());
    }
    let points = points::wanted(&answer, saved.begin(), options)?;
    let mut evaluated = evaluated(saved, answer, points, &names)?;
    evaluated.warnings.extend(changed(program, &evaluated.saved));
    for warning in &evaluated.warnings {
        note(&format!("warning: {warning}\n"));
    }
    let table = evaluated.table().map_err(|error| error.to_string())?;
    if let Some(path) = &options.out
        && let Err(error) = table.write(path)
    {
        note(&format!("{}: {error}\n", program.name));
        return Ok(ExitCode::from(NOT_WRITTEN));
    }
    let text = match (options.json, &options.out) {
        (true, _) => evaluated.json(),
        (false, None) => report::csv(&table),
        (false, Some(path)) => format!("wrote {} rows to {}\n", table.rows(), path.display()),
    };
    if let Err(message) = print(&text) {
        note(&format!("{}: {message}\n", program.name));
        return Ok(ExitCode::from(NOT_WRITTEN));
    }
    Ok(if is_reliable(&evaluated.saved) { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) })
}

fn read(path: &Path) -> Result<SavedAnswer, String> {
    let bytes = read_bytes(path, MOST_BYTES).map_err(|error| error.to_string())?;
    SavedAnswer::from_bytes(&bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// As `nisp solve` says it by its exit code.
fn is_reliable(saved: &SavedAnswer) -> bool {
    ["converged", "budget"].contains(&saved.status()) && saved.failed().next().is_none()
}

/// What an answer says at points, and what is to be said of that.
fn evaluated(saved: SavedAnswer, answer: OpenAnswer, points: Vec<f64>, names: &[String]) -> Result<Evaluated, String> {
    let axes = answer.scene().coordinates.len();
    let is_inside: Vec<bool> = points.chunks_exact(axes).map(|point| answer.contains(point)).collect();
    let outside = is_inside.iter().filter(|inside| !**inside).count();
    if outside == is_inside.len() {
        let where_to = points::ranges(&answer);
        return Err(format!("none of the {outside} points lies where the answer holds: {where_to}"));
    }
    let inside = points.chunks_exact(axes).zip(&is_inside).filter(|(_, inside)| **inside);
    let known = answer.evaluate(&inside.flat_map(|(point, _)| point.to_vec()).collect::<Vec<f64>>());
    let asked = names.iter().filter_map(|name| known.iter().find(|estimate| estimate.name == name));
    let estimates: Vec<Estimate> = asked.map(|estimate| spread(estimate, &is_inside)).collect();
    let mut warnings = Vec::new();
    if !is_reliable(&saved) {
        warnings.push(format!("the answer is not to be relied on: its run ended {}", saved.status()));
    }
    warnings.extend(saved.failed().map(|message| format!("failed when it was solved: {message}")));
    if outside > 0 {
        let all = is_inside.len();
        warnings.push(format!(
            "{outside} of {all} points lie outside of those that the answer was found from, and have no value: {}",
            points::ranges(&answer)
        ));
    }
    if estimates.iter().all(|estimate| estimate.deviations.is_none()) {
        warnings.push("the answer was saved without error bars".into());
    }
    Ok(Evaluated { saved, answer, points, estimates, warnings })
}

/// Values at some points as values at all, NaN at the others.
fn spread(estimate: &Estimate, is_inside: &[bool]) -> Estimate {
    let all = |values: &Vec<f64>| {
        let mut values = values.iter();
        is_inside
            .iter()
            .map(|inside| if *inside { values.next().copied().unwrap_or(f64::NAN) } else { f64::NAN })
            .collect()
    };
    Estimate { values: all(&estimate.values), deviations: estimate.deviations.as_ref().map(all), ..estimate.clone() }
}

/// That the program's own equation of this name is another one now.
fn changed(program: &Program, saved: &SavedAnswer) -> Option<String> {
    let scenes = program.equations.iter().flat_map(|entry| &entry.scenes);
    let own = scenes.into_iter().find(|scene| scene.schema.module == saved.module())?;
    let said = "is not the one that ships with this version; values are those of the equation as it was saved";
    (!is_same_equation(own.text, saved.equation()))
        .then(|| format!("the answer's equation `{}` {said}", saved.module()))
}
