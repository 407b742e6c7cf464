//! A run as one JSON object for programs.

use std::path::{Path, PathBuf};

use crate::rivals::{self, Rivals};
use crate::score::Found;
use nisp::solve::driver::Status;
use nisp::{Estimate, LearnedValue, Solution, TermReport};
use nisp_data::cloud::LengthUnit;
use nisp_equations::contact::Patch;
use serde_json::{Map, Value, json};

use super::Run;

/// The object of `--json`, on one line.
pub(crate) fn json(solution: &Solution, run: &Run<'_>, found: &Found) -> String {
    let heads = |source: bool| -> Vec<Value> {
        run.answer.estimates.iter().filter(|estimate| estimate.source == source).map(head).collect()
    };
    let mut object = json!({
        "scene": run.options.equation,
        "status": status(solution),
        "seed": run.settings.seed,
        "precision": solution.precision(),
        "carrier": { "name": solution.carrier, "reason": solution.carrier_reason },
        "optimizer": solution.method(),
        "threads": run.settings.threads,
        "wall_s": solution.wall_s,
        "iterations": solution.iterations,
        "loss": solution.loss,
        "warnings": run.warnings,
        "verdict": verdict(solution),
        "errors": errors(found),
        "coordinates": coordinates(solution, run),
        "sources": heads(true),
        "state": heads(false),
        "learned": found.learned.iter().map(learned).collect::<Vec<_>>(),
        "terms": found.terms.iter().map(term).collect::<Vec<_>>(),
        "groups": groups(solution),
        "skipped": solution.scene().skipped,
        "data": data(run),
        "files": files(run),
        "settings": settings(solution, run),
    });
    if let Some(contact) = &found.contact {
        object["force"] = json!(contact.force);
        object["force_sd"] = json!(found.force_deviation);
        object["seen"] = json!(found.seen);
        object["patches"] = contact.patches.iter().map(patch).collect();
    }
    if let Some(asked) = &run.rivals {
        object["rivals"] = rivals(asked);
    }
    format!("{object}\n")
}

/// Classical methods: their errors, or why there is none.
fn rivals(rivals: &Rivals) -> Value {
    let error =
        |error: &rivals::Error| json!({ "source": error.source, "method": error.method, "mean_abs": error.mean_abs });
    json!({
        "errors": rivals.errors.iter().map(error).collect::<Vec<_>>(),
        "force_N": rivals.contact.as_ref().map(|(_, contact)| contact.magnitude()),
        "none": rivals.none,
    })
}

/// An interrupted run is one that has not converged.
pub(crate) fn status(solution: &Solution) -> &'static str {
    match solution.status {
        Status::Interrupted => Status::NotConverged.name(),
        status => status.name(),
    }
}

/// Every check of the answer.
fn verdict(solution: &Solution) -> Vec<Value> {
    let checks = solution.verdict.checks.iter().map(|check| {
        json!({
            "check": check.check,
            "group": check.group,
            "term": check.term,
            "value": check.value,
            "limit": check.limit,
            "passed": check.passed,
            "message": check.message,
        })
    });
    checks.collect()
}

/// Everything that was scored, by name.
fn errors(found: &Found) -> Map<String, Value> {
    let mut errors = Map::new();
    for score in &found.scores {
        errors.insert(score.name.into(), score.mean_abs.into());
        if let Some(if_zero) = score.if_zero {
            errors.insert(format!("{}_if_zero", score.name), if_zero.into());
        }
    }
    for learned in &found.learned {
        errors.insert(learned.name.into(), learned.value.into());
        errors.insert(format!("{}_sd", learned.name), learned.deviation.into());
    }
    if let Some(contact) = &found.contact {
        errors.insert("force_N".into(), contact.magnitude().into());
        if let Some(against) = &contact.against {
            errors.insert("iou".into(), against.iou.into());
            errors.insert("patch_chamfer_mm2".into(), against.patch_chamfer_mm2.into());
            errors.insert("force_error_N".into(), against.force_error.into());
        }
    }
    errors
}

/// A connected touched part, in SI units.
pub(crate) fn patch(patch: &Patch) -> Value {
    json!({
        "centre_at_rest_m": patch.centre_at_rest,
        "centre_m": patch.centre,
        "area_at_rest_m2": patch.area_at_rest,
        "area_m2": patch.area,
        "force_N": patch.force,
    })
}

/// The points of the answer, coordinate by coordinate.
fn coordinates(solution: &Solution, run: &Run<'_>) -> Vec<Value> {
    let coordinates = solution.scene().coordinates;
    let values =
        |at: usize| -> Vec<f64> { run.prepared.points.iter().skip(at).step_by(coordinates.len()).copied().collect() };
    let numbered = coordinates.iter().enumerate();
    numbered.map(|(at, own)| json!({ "name": own.name, "unit": own.unit.text, "values": values(at) })).collect()
}

/// A source or a field at the points of the answer.
fn head(estimate: &Estimate) -> Value {
    json!({
        "name": estimate.name,
        "unit": estimate.unit.text,
        "values": estimate.values,
        "deviations": estimate.deviations,
    })
}

/// A learned parameter.
pub(crate) fn learned(learned: &LearnedValue) -> Value {
    json!({
        "name": learned.name,
        "unit": learned.unit.text,
        "value": learned.value,
        "deviation": learned.deviation,
    })
}

/// What is left of an equation, a condition or an observation.
fn term(term: &TermReport) -> Value {
    json!({
        "name": term.name,
        "equation": term.equation,
        "observation": term.observation,
        "unit": term.unit.text,
        "rms": term.rms,
        "size": term.size,
        "noise": term.noise,
    })
}

fn groups(solution: &Solution) -> Vec<Value> {
    let groups = solution.groups();
    groups.map(|(own, points)| json!({ "name": own.name, "points": points, "channels": own.channels })).collect()
}

/// Where the data come from, and what was taken as declared beside them.
fn data(run: &Run<'_>) -> Value {
    let assumed = run.prepared.assumed.iter();
    let assumed = assumed.map(|own| json!({ "name": own.name, "value": own.value, "unit": own.unit }));
    json!({ "source": run.prepared.source, "assumed": assumed.collect::<Vec<_>>() })
}

/// What was written, where, and why that is not the folder that was asked for.
fn files(run: &Run<'_>) -> Value {
    let folder = run.written.folder.as_deref().map(text);
    let names: Vec<_> = run.answer.files.iter().map(|(name, _)| *name).collect();
    json!({
        "names": folder.as_ref().map_or(Vec::new(), |_| names),
        "folder": folder,
        "fault": run.written.fault.as_ref().map(ToString::to_string),
    })
}

fn settings(solution: &Solution, run: &Run<'_>) -> Value {
    let (options, settings) = (run.options, run.settings);
    let pairs = |own: &[(String, String)]| own.iter().cloned().collect::<std::collections::BTreeMap<_, _>>();
    json!({
        "scene": solution.scene().name,
        "data": files_of(&options.data),
        "sample": options.sample.as_deref().map(text),
        "cloud": options.cloud,
        "calibration": options.calibration.as_deref().map(text),
        "unit": options.unit.map(LengthUnit::symbol),
        "camera": options.camera.as_deref().map(text),
        "truth": options.truth.as_deref().map(text),
        "columns": pairs(&options.column),
        "parameters": options.set.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "optimizer": settings.optimizer.name(),
        "precision": settings.precision.name(),
        "carrier": options.carrier,
        "width": options.width,
        "layers": options.layers,
        "activation": settings.architecture.activation.name(),
        "resample": options.resample,
        "budget_s": settings.budget.map(|budget| budget.as_secs_f64()),
        "iterations": options.iterations,
        "out": text(&options.out),
        "checkpoint": options.checkpoint,
        "resume": options.resume.as_deref().map(text),
        "isa": solution.isa(),
    })
}

/// A file alone as its path; several, or one for a group, as `GROUP=FILE`.
fn files_of(data: &[(Option<String>, PathBuf)]) -> Value {
    let one = |(group, path): &(Option<String>, PathBuf)| match group {
        Some(group) => format!("{group}={}", text(path)),
        None => text(path),
    };
    match data {
        [] => Value::Null,
        [only @ (None, _)] => one(only).into(),
        _ => data.iter().map(one).collect(),
    }
}

/// A path as text; letters that are none are replaced.
fn text(path: &Path) -> String {
    path.display().to_string()
}
