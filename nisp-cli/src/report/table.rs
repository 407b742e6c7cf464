//! A run as a table for people.

use std::fmt::Write;

use crate::score::Found;
use nisp::Solution;
use nisp::solve::driver::Status;
use nisp_equations::contact::ContactScore;

use super::Run;

/// How the run ended, in words.
fn end(solution: &Solution) -> &'static str {
    let is_out_of_steps = solution.settings.iterations.is_some_and(|most| solution.iterations >= most);
    match solution.status {
        Status::Converged => "converged",
        Status::Budget if is_out_of_steps => "stopped by --iterations",
        Status::Budget => "budget spent",
        Status::NotConverged => "not converged",
        Status::Interrupted => "interrupted",
        Status::Inconsistent => "ended, but inconsistent,",
    }
}

/// A short table: errors beside those of simpler answers, time, points, channels, what was skipped.
pub(crate) fn table(solution: &Solution, run: &Run<'_>, found: &Found) -> String {
    let Run { prepared, warnings, .. } = run;
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
        solution.method(),
        solution.precision(),
        if threads == 1 { "" } else { "s" },
        solution.loss
    ));
    line(format!("  carrier    {}: {}", solution.carrier, solution.carrier_reason));
    for (group, points) in solution.groups().filter(|(group, _)| !group.is_beliefs()) {
        let points = if points == 1 { "1 point".into() } else { format!("{points} points") };
        line(format!("  {:10} {points}, channels {}", group.name, group.channels.join(" ")));
    }
    for skipped in scene.skipped {
        line(format!("  skipped    {skipped}"));
    }
    if !prepared.assumed.is_empty() {
        let assumed: Vec<String> = prepared
            .assumed
            .iter()
            .map(|given| format!("{} = {} {}", given.name, given.value, given.unit).trim_end().into())
            .collect();
        line(format!("  assumed    {} (others with --set)", assumed.join(", ")));
    }
    if found.scores.is_empty() {
        found_rows(found, solution.is_sound()).into_iter().for_each(&mut line);
    } else {
        line("mean absolute error".into());
    }
    for score in &found.scores {
        line(format!("  {:26} {:.2e} {}", score.name, score.mean_abs, score.unit));
        if let Some(if_zero) = score.if_zero {
            let zero = (format!("{} = 0", score.name), if_zero);
            let others = run.rivals.iter().flat_map(|rivals| &rivals.errors).filter(|error| error.source == score.name);
            let others = others.map(|error| (error.method.to_string(), error.mean_abs));
            for (name, error) in std::iter::once(zero).chain(others) {
                line(format!("    {name:24} {error:.2e} {}", score.unit));
            }
        }
    }
    if let Some(why) = run.rivals.as_ref().and_then(|rivals| rivals.none.as_ref()) {
        line(format!("  no classical method: {why}"));
    }
    if let Some(contact) = &found.contact {
        let rival = run.rivals.as_ref().and_then(|rivals| rivals.contact.as_ref());
        contact_rows(contact, found.force_deviation, rival).into_iter().for_each(&mut line);
        if let Some(seen) = found.seen {
            line(format!("  {:26} {:.0} % of the surface", "seen", 100.0 * seen));
        }
    }
    for learned in &found.learned {
        let deviation = learned.deviation.map_or_else(String::new, |deviation| format!(" ± {deviation:.2e}"));
        line(format!("learned {} = {:.6e}{deviation} {}", learned.name, learned.value, learned.unit.text));
    }
    for check in solution.verdict.failed() {
        line(format!("failed: {}", check.message));
    }
    let is_said = |warning: &&String| solution.verdict.failed().any(|check| check.message == **warning);
    for warning in warnings.iter().filter(|warning| !is_said(warning)) {
        line(format!("warning: {warning}"));
    }
    line(run.files_in_words());
    text + &run.tables()
}

/// What was found, where no truth is known.
fn found_rows(found: &Found, is_sound: bool) -> Vec<String> {
    let of = |value: f64, unit: &str| format!("{value:.2e} {unit}").trim_end().to_string();
    // Those of an answer that is not sound are withheld, and the verdict says so.
    let is_exact = is_sound && found.terms.iter().any(|term| term.observation);
    let sizes = found.sizes.iter().map(|size| {
        let bars = match size.deviation {
            Some(deviation) => format!(", standard deviation {}", of(deviation, size.unit)),
            None if is_exact => ", without error bars: noise below 1e-5 of the data's spread counts as rounding".into(),
            None => String::new(),
        };
        (size.name.to_string(), of(size.value, size.unit) + &bars)
    });
    let noise = found.terms.iter().filter_map(|term| {
        let name = term.name.rsplit('.').next().unwrap_or(&term.name);
        Some((format!("noise of {name}"), of(term.noise?, term.unit.text)))
    });
    let rows: Vec<String> = sizes.chain(noise).map(|(name, value)| format!("  {name:26} {value}")).collect();
    if rows.is_empty() { rows } else { [vec!["root mean square".into()], rows].concat() }
}

/// A contact's net force and how well it was found, beside those of a classical way.
fn contact_rows(
    contact: &ContactScore,
    deviation: Option<f64>,
    rival: Option<&(&'static str, ContactScore)>,
) -> Vec<String> {
    let mut rows = vec!["contact".into()];
    let mut add = |name: &str, unit: &str, value: &dyn Fn(&ContactScore) -> Option<f64>| {
        let Some(own) = value(contact) else { return };
        rows.push(format!("  {name:26} {own:.3} {unit}"));
        let other = rival.and_then(|(name, contact)| Some((name, value(contact)?)));
        rows.extend(other.map(|(name, value)| format!("    {name:24} {value:.3} {unit}")));
    };
    add("net force", "N", &|contact| Some(contact.magnitude()));
    add("error of the net force", "N", &|contact| Some(contact.against.as_ref()?.force_error));
    add("overlap of the patch (IoU)", "", &|contact| Some(contact.against.as_ref()?.iou));
    add("Chamfer distance, patch", "mm^2", &|contact| contact.against.as_ref()?.patch_chamfer_mm2);
    let vector = |[x, y, z]: [f64; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
    let bar = deviation.map_or_else(String::new, |deviation| format!(", standard deviation {deviation:.3} N"));
    rows.push(format!("  {:26} {} N{bar}", "force on the body", vector(contact.force)));
    for patch in &contact.patches {
        let (area, centre) = (1e6 * patch.area, patch.centre.map(|x| 1e3 * x));
        let [x, y, z] = centre;
        rows.push(format!(
            "  {:26} {area:.0} mm^2 around ({x:.1}, {y:.1}, {z:.1}) mm, {} N",
            "patch, deformed",
            vector(patch.force)
        ));
    }
    rows
}
