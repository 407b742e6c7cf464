//! `nisp solve`: from a table to a source.

use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Duration;

use nisp::network::Architecture;
use nisp::solve::driver::{Flow, Status};
use nisp::{Estimate, Optimizer, Settings, Solution, Width, recover};
use nisp_data::OutDir;
use nisp_data::Table;
use nisp_data::picture::{Curve, LinePanel, LinePlot, Quantity, line_plot};
use nisp_equations::{Prepared, Request};

use crate::args::Options;
use crate::score::{Score, score};

/// Not converged.
const NOT_CONVERGED: u8 = 3;

/// Solves, writes the results, and says how well it went.
pub(crate) fn solve(options: &Options) -> Result<ExitCode, String> {
    let entry = crate::entry(&options.equation)?;
    let request = Request {
        scene: options.scene.clone(),
        data: options.data.clone(),
        truth: options.truth.clone(),
        columns: options.column.clone(),
        parameters: options.set.clone(),
    };
    let settings = settings(options)?;
    let prepared = entry.prepare(&request).map_err(|error| error.to_string())?;
    let out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    let mut solution = run(&prepared, &settings)?;
    let scores = match &prepared.truth {
        Some(truth) => score(&solution, truth).map_err(|error| error.to_string())?,
        None => Vec::new(),
    };
    let estimates = solution.evaluate_with_errors(&prepared.times);
    write(&out, &prepared, &estimates).map_err(|error| error.to_string())?;
    if options.json {
        println!("{}", json(&solution, options, &scores));
    } else {
        table(&mut solution, &prepared, &scores, &out);
    }
    Ok(if solution.status == Status::NotConverged { ExitCode::from(NOT_CONVERGED) } else { ExitCode::SUCCESS })
}

fn settings(options: &Options) -> Result<Settings, String> {
    if !(options.budget > 0.0 && options.budget.is_finite()) {
        return Err(format!("--budget {}: give a positive number of seconds", options.budget));
    }
    Ok(Settings {
        precision: if options.precision == "f32" { Width::F32 } else { Width::F64 },
        optimizer: Optimizer::from_name(&options.optimizer).unwrap_or(Optimizer::Auto),
        architecture: Architecture::modified(options.width, options.layers),
        seed: options.seed,
        budget: Some(Duration::from_secs_f64(options.budget)),
        iterations: options.iterations,
        threads: options.threads,
    })
}

/// Runs the solver, with a line of progress on a terminal.
fn run(prepared: &Prepared, settings: &Settings) -> Result<Solution, String> {
    let terminal = std::io::stderr().is_terminal();
    let mut shown = 0.0;
    let result = recover(&prepared.problem, settings, &mut |report| {
        if terminal && report.elapsed_s >= shown {
            shown = report.elapsed_s + 0.2;
            eprint!("\r{:6.1} s  step {:7}  loss {:.3e}", report.elapsed_s, report.iteration, report.loss);
        }
        Flow::Continue
    });
    if terminal {
        eprintln!();
    }
    result.map_err(|error| error.to_string())
}

fn status(solution: &Solution) -> &'static str {
    match solution.status {
        Status::Converged => "converged",
        Status::Budget | Status::Interrupted => "budget",
        Status::NotConverged => "not_converged",
    }
}

/// Source and state as CSV, and a plot.
fn write(out: &OutDir, prepared: &Prepared, estimates: &[Estimate]) -> Result<(), nisp_data::DataError> {
    for (name, source) in [("source.csv", true), ("state.csv", false)] {
        let mut table = Table::empty();
        table.push("t", "s", &prepared.times)?;
        for estimate in estimates.iter().filter(|estimate| estimate.source == source) {
            table.push(estimate.name, estimate.unit.text, &estimate.values)?;
            if let Some(deviations) = &estimate.deviations {
                table.push(&format!("{}_sd", estimate.name), estimate.unit.text, deviations)?;
            }
        }
        out.write(name, |to| table.write_to(to))?;
    }
    let mut sorted: Vec<&Estimate> = estimates.iter().collect();
    sorted.sort_by_key(|estimate| !estimate.source);
    let panels = sorted.into_iter().map(|estimate| {
        let mut panel = LinePanel::new(Quantity::new(estimate.name, estimate.unit.text));
        let measured = prepared.measured.iter().find(|(name, _)| *name == estimate.name);
        panel.measured = measured.map(|(_, values)| Curve::new(&prepared.times, values));
        panel.estimate = Some(Curve::new(&prepared.times, &estimate.values));
        panel.deviation.clone_from(&estimate.deviations);
        let truth = prepared.truth.as_ref();
        panel.truth = truth.and_then(|truth| {
            let values = truth.quantity(estimate.name, estimate.unit.text).ok()?;
            Some(Curve::new(truth.column("t").ok()?, values))
        });
        panel
    });
    let plot = LinePlot { title: prepared.source.clone(), x: Quantity::new("t", "s"), panels: panels.collect() };
    line_plot(&plot)?.write_svg(out.file("plot.svg"))
}

fn json(solution: &Solution, options: &Options, scores: &[Score]) -> serde_json::Value {
    let errors: serde_json::Map<_, _> = scores.iter().map(|s| (s.name.clone(), s.mean_abs.into())).collect();
    let warnings: Vec<_> = solution.warnings.iter().map(|warning| warning.message.clone()).collect();
    serde_json::json!({
        "scene": format!("{}/{}", solution.scene().module, solution.scene().name),
        "status": status(solution),
        "seed": options.seed,
        "precision": solution.settings.precision.name(),
        "optimizer": solution.optimizer.name(),
        "threads": options.threads,
        "wall_s": solution.wall_s,
        "iterations": solution.iterations,
        "loss": solution.loss,
        "warnings": warnings,
        "errors": errors,
        "settings": {
            "width": options.width, "layers": options.layers, "budget_s": options.budget,
            "iterations": options.iterations, "isa": solution.isa(),
        },
    })
}

fn table(solution: &mut Solution, prepared: &Prepared, scores: &[Score], out: &OutDir) {
    println!("{} / {} from {}", solution.scene().module, solution.scene().name, prepared.source);
    println!(
        "{} after {:.1} s, {} steps of {}, loss {:.3e}",
        status(solution).replace('_', " "),
        solution.wall_s,
        solution.iterations,
        solution.optimizer.name(),
        solution.loss
    );
    for (group, points) in solution.groups() {
        println!("  group {:10} {:6} points, {} channels", group.name, points, group.channels.len());
    }
    for line in solution.scene().skipped {
        println!("  skipped: {line}");
    }
    for Score { name, unit, mean_abs } in scores {
        println!("  mean absolute error {name:10} {mean_abs:.3e} {unit}");
    }
    for warning in &solution.warnings {
        println!("  warning: {}", warning.message);
    }
    println!("wrote source.csv, state.csv and plot.svg to {}", out.path().display());
}
