//! `nisp calibrate`: from frames of a sensor that nothing touches to what every later frame is read with.

use std::fmt::Write;
use std::process::ExitCode;
use std::time::Duration;

use crate::interrupt;
use crate::processors;
use crate::terminal::{NOT_CONVERGED, NOT_WRITTEN, note, print, progress};
use nisp::solve::driver::{Flow, Status};
use nisp::{LearnedValue, Report, Settings, Solution, recover};
use nisp_data::colour::ColourScale;
use nisp_data::picture::{FieldMap, Grid, MapPanel, Quantity, field_map};
use nisp_data::{DataError, OutDir};
use nisp_equations::contact::{Calibration, LEARNED, Learned};
use nisp_equations::{Entry, PrepareError, Request};
use serde_json::json;

use crate::args::Frames;
use crate::options::view;
use crate::program::Program;

/// What is written.
const FILE: &str = "calibration.toml";
const PLOT: &str = "deviation.svg";

/// One law of the material, fitted to the frames.
struct Fit {
    calibration: Calibration,
    learned: Vec<LearnedValue>,
    solution: Solution,
}

/// Fits every law that the equation has, keeps the one that leaves least, and writes it.
pub(crate) fn calibrate(program: &Program, options: &Frames) -> Result<ExitCode, String> {
    let entry = program.entry(&options.equation)?;
    let laws = entry.calibrates();
    if laws.is_empty() {
        return Err(format!("`{}` cannot be calibrated; `nisp calibrate bubble` can", options.equation));
    }
    interrupt::listen(program.name)?;
    OutDir::require_free(&options.out, &[FILE, PLOT]).map_err(|error| error.to_string())?;
    let mut fits = Vec::new();
    let mut failed = Vec::new();
    for law in laws {
        match fit(&entry, law, options).map_err(|error| error.to_string())? {
            Ok(fit) => fits.push(fit),
            Err(why) => failed.push(why),
        }
    }
    fits.sort_by(|one, other| one.calibration.found.misfit_m.total_cmp(&other.calibration.found.misfit_m));
    let Some(best) = fits.first() else {
        let mut text = failed.join("\n");
        text.push_str("\nno calibration was made: check pressure, sizes, unit and frame, or give more --budget\n");
        note(&text);
        return Ok(ExitCode::from(NOT_CONVERGED));
    };
    let text = best.calibration.text().map_err(|error| error.to_string())?;
    let mut files = vec![(FILE, text.into_bytes())];
    let mut warnings = failed;
    warnings.extend(fits.iter().filter(|fit| fit.solution.status == Status::Budget).map(|fit| {
        let law = &fit.calibration.scene;
        format!("{law}: the budget was spent before the fit had settled; give more --budget")
    }));
    warnings.extend(best.solution.verdict.failed().map(|check| check.message.clone()));
    let doubts: Vec<String> =
        best.calibration.doubts().into_iter().filter(|own| own.value > own.limit).map(|own| own.message).collect();
    let is_settled = best.solution.status != Status::Budget && doubts.is_empty();
    warnings.extend(doubts);
    warnings.extend(best.calibration.doubt());
    match picture(&best.calibration) {
        Ok(bytes) => files.push((PLOT, bytes)),
        Err(error) => warnings.push(format!("{PLOT} is not drawn: {error}")),
    }
    let out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    interrupt::clean(out.traces());
    if let Err(error) = out.write(&files) {
        note(&format!("{}: {error}\n", program.name));
        return Ok(ExitCode::from(NOT_WRITTEN));
    }
    print(&if options.json {
        object(best, &fits, &warnings, options)
    } else {
        table(best, &fits, &warnings, options)
    })?;
    Ok(if is_settled { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) })
}

/// Fits one law; what went wrong where it does not fit.
fn fit(entry: &Entry, law: &'static str, options: &Frames) -> Result<Result<Fit, String>, PrepareError> {
    let request = Request {
        scene: Some(law.into()),
        data: options.reference.iter().map(|path| (None, path.clone())).collect(),
        view: view(options.unit, options.camera.as_deref())?,
        parameters: options.set.clone(),
        ..Request::default()
    };
    let prepared = entry.prepare(&request)?;
    let budget = Some(Duration::from_secs_f64(options.budget));
    let settings = prepared.suited(Settings { budget, threads: processors(), ..Settings::default() });
    let mut monitor = |report: Report<'_>| {
        progress(&format!("{law}: {:6.1} of {} s  step {}", report.elapsed_s, options.budget, report.iteration));
        if interrupt::asked() { Flow::Stop } else { Flow::Continue }
    };
    let solved = recover(&prepared.problem, &settings, &mut monitor);
    progress("");
    let mut solution = match solved {
        Ok(solution) => solution,
        Err(error) => return Ok(Err(format!("{law}: {error}"))),
    };
    if !matches!(solution.status, Status::Converged | Status::Inconsistent | Status::Budget) {
        let why = solution.warnings.first().map_or("no answer was reached", |warning| warning.message.as_str());
        return Ok(Err(format!("{law}: {why}")));
    }
    let learned = solution.learned();
    let (Some(references), Some(contact)) = (&prepared.references, &prepared.contact) else {
        return Ok(Err(format!("{law}: the scene does not calibrate")));
    };
    let values = |name: &str, points: &[f64]| {
        let estimate = solution.evaluate(points).into_iter().find(|estimate| estimate.name == name);
        estimate.map(|estimate| estimate.values)
    };
    let value = |name: &str| learned.iter().find(|learned| learned.name == name).map(|learned| learned.value);
    let young_deviation = learned.iter().find(|learned| learned.name == "E").and_then(|learned| learned.deviation);
    let found = Learned { value: &value, young_deviation, together: solution.learned_together(&LEARNED) };
    let calibration = references.calibration(entry, law, contact, &values, found)?;
    Ok(Ok(Fit { calibration, learned, solution }))
}

/// The deviation that is taken off every frame.
fn picture(calibration: &Calibration) -> Result<Vec<u8>, DataError> {
    let (places, sizes) = calibration.deviation.sizes();
    let millimetres: Vec<f64> = sizes.iter().map(|size| 1e3 * size).collect();
    let panel = MapPanel {
        title: "seen above the theory".into(),
        value: Quantity::new("deviation", "mm"),
        grid: Grid::from_points(&places, &millimetres)?,
        scale: ColourScale::diverging(&millimetres),
        contours: Vec::new(),
    };
    let map = FieldMap {
        title: "What the theory of the free bubble does not explain".into(),
        subtitle: format!("{}, scene {}", calibration.equation, calibration.scene),
        x: Quantity::new("x", "m"),
        y: Quantity::new("y", "m"),
        outline: Vec::new(),
        marks: Vec::new(),
        panels: vec![panel],
    };
    Ok(field_map(&map)?.svg().into())
}

fn table(best: &Fit, fits: &[Fit], warnings: &[String], options: &Frames) -> String {
    let mut text = String::new();
    // Writing into a string cannot fail.
    let mut line = |content: String| {
        let _ = writeln!(text, "{}", content.trim_end());
    };
    let found = best.calibration.found;
    line(format!("{} from {} frames, {} points", best.calibration.equation, found.frames, found.points));
    for fit in fits {
        let (misfit, mark) =
            (1e3 * fit.calibration.found.misfit_m, if std::ptr::eq(fit, best) { ", taken" } else { "" });
        let name = fit.calibration.scene.as_str();
        line(format!("  {name:18} leaves {misfit:.3} mm after {:.1} s{mark}", fit.solution.wall_s));
    }
    line(format!("  {:18} leaves {:.3} mm", "with the deviation", 1e3 * found.noise_m));
    for learned in &best.learned {
        let deviation = learned.deviation.map_or_else(String::new, |deviation| format!(" ± {deviation:.1e}"));
        line(format!("learned {} = {:.4e}{deviation} {}", learned.name, learned.value, learned.unit.text));
    }
    line(format!("held: {}", best.calibration.held));
    for warning in warnings {
        line(format!("warning: {warning}"));
    }
    line(format!("wrote {FILE} and {PLOT} to {}", options.out.display()));
    let file = options.out.join(FILE);
    line(format!("next: nisp solve {} --calibration {} --data FRAME --set p=VALUE", options.equation, file.display()));
    text
}

fn object(best: &Fit, fits: &[Fit], warnings: &[String], options: &Frames) -> String {
    let learned = best.learned.iter().map(|learned| {
        json!({
            "name": learned.name,
            "unit": learned.unit.text,
            "value": learned.value,
            "deviation": learned.deviation,
        })
    });
    let laws = fits.iter().map(|fit| {
        json!({ "scene": fit.calibration.scene, "misfit_m": fit.calibration.found.misfit_m, "wall_s": fit.solution.wall_s })
    });
    let found = best.calibration.found;
    let object = json!({
        "equation": best.calibration.equation,
        "scene": best.calibration.scene,
        "laws": laws.collect::<Vec<_>>(),
        "learned": learned.collect::<Vec<_>>(),
        "held": best.calibration.held,
        "frames": found.frames,
        "points": found.points,
        "misfit_m": found.misfit_m,
        "noise_m": found.noise_m,
        "camera_m": found.camera,
        "warnings": warnings,
        "file": options.out.join(FILE).display().to_string(),
    });
    format!("{object}\n")
}
