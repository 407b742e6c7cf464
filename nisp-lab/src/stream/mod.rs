//! `nisp-lab stream`: how fast and how well a session follows a tool that moves over the membrane.

mod membrane;
mod tools;

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use nisp::solve::driver::Flow;
use nisp::{Session, Settings, Solution, recover};
use nisp_cli::interrupt;
use nisp_cli::options::{count, number, seed};
use nisp_cli::terminal::{print, progress};
use nisp_data::Cloud;
use nisp_data::overlap::intersection_over_union;
use nisp_equations::contact::Contact;
use nisp_equations::{Prepared, Request};

use crate::random::Random;
use membrane::{AXES, Membrane, POISSON, PRESSURE, THICKNESS, YOUNG};
use tools::{Motion, motions};

/// What to follow.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Standard deviation of the clouds along z, in millimetres.
    #[arg(long, value_name = "MM", default_value_t = 1.0, value_parser = number)]
    noise: f64,
    /// Points of a cloud.
    #[arg(long, value_name = "N", default_value_t = 3000, value_parser = count)]
    points: usize,
    /// Cells of the session's lattice along the membrane [default: as many as a single answer has].
    #[arg(long, value_name = "N", value_parser = count)]
    cells: Option<usize>,
    /// Every so many frames the answer is compared with one that is sought from nothing, as `nisp solve` does.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = count)]
    beside: usize,
    /// Only motions whose name contains this.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Seed of points and noise.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Threads [default: one per processor].
    #[arg(long, value_name = "N", value_parser = count)]
    threads: Option<usize>,
}

/// Share of the rim's semi-axes within which a camera sees the surface.
const SEEN: f64 = 0.96;
/// Wall time of an answer from nothing.
const BUDGET: Duration = Duration::from_secs(600);

/// An answer beside the truth.
struct Scored {
    mask: Vec<bool>,
    iou: f64,
    force: f64,
    error: f64,
}

/// Follows every motion and prints what came of it.
pub(crate) fn stream(options: &Options) -> Result<ExitCode, String> {
    interrupt::listen(crate::NAME)?;
    print(
        "| motion | frames | sought from nothing | update: median, 99th percentile [ms] | processor time of an update, mean [ms] | IoU: session, single | error of the force [N]: session, single | forces apart [N] |\n|---|---|---|---|---|---|---|---|\n",
    )?;
    let motions = motions();
    for motion in motions.iter().filter(|motion| options.only.as_ref().is_none_or(|only| motion.name.contains(only))) {
        let row = follow(motion, options)?;
        progress("");
        print(&row)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Follows a motion; a row of the table.
fn follow(motion: &Motion, options: &Options) -> Result<String, String> {
    let mut random = Random::new(options.seed);
    let mut membrane = Membrane::new().map_err(|error| error.to_string())?;
    let mut session: Option<(Session, Prepared)> = None;
    let (mut latencies, mut own, mut single) = (Vec::new(), Vec::new(), Vec::new());
    let (mut sought, mut worked) = (0, 0.0);
    for frame in 0..motion.frames {
        interrupt::check()?;
        progress(&format!("{}: frame {frame} of {}", motion.name, motion.frames));
        let tool = |x: f64, y: f64| (motion.height)(frame as f64 / (motion.frames - 1) as f64, x, y);
        membrane.press(&tool).map_err(|fault| fault.to_string())?;
        let pressures = membrane.pressures(&tool);
        let truth = Truth {
            places: membrane.places(),
            mask: pressures.iter().map(|pressure| *pressure > PRESSURE / 2.0).collect(),
            force: membrane.force(&pressures),
        };
        let cloud = seen(&membrane, options, &mut random);
        let fresh = prepared(&cloud, None)?;
        if session.is_none() {
            let own = prepared(&cloud, options.cells)?;
            let of = Session::new(own.problem.clone(), suited(&own, options)).map_err(|error| error.to_string())?;
            session = Some((of, own));
        }
        let Some((session, first)) = &mut session else { continue };
        let (Some(frames), Some(contact)) = (&first.frames, &first.contact) else { continue };
        let (began, busy) = (Instant::now(), processor_ms());
        frames.bind(session.problem(), Path::new("frame"), cloud).map_err(|error| error.to_string())?;
        let solution = session.update(&mut |_| Flow::Continue).map_err(|error| error.to_string())?;
        let scored = score(solution, contact, &truth);
        if solution.carrier_reason.contains("no answer") {
            sought += 1;
        } else {
            latencies.push(1e3 * began.elapsed().as_secs_f64());
            worked += processor_ms() - busy;
        }
        if frame % options.beside == options.beside - 1 {
            let settings = suited(&fresh, options);
            let alone =
                recover(&fresh.problem, &settings, &mut |_| Flow::Continue).map_err(|error| error.to_string())?;
            own.push(scored);
            single.push(score(&alone, contact, &truth));
        }
    }
    latencies.sort_by(f64::total_cmp);
    let percentile = |share: f64| {
        latencies.get((share * latencies.len() as f64) as usize).or(latencies.last()).copied().unwrap_or(f64::NAN)
    };
    let mean = |all: &[Scored], of: &dyn Fn(&Scored) -> f64| all.iter().map(of).sum::<f64>() / all.len().max(1) as f64;
    let apart = own.iter().zip(&single).map(|(own, single)| (own.force - single.force).abs()).fold(0.0, f64::max);
    let overlap: f64 =
        own.iter().zip(&single).filter_map(|(own, single)| intersection_over_union(&own.mask, &single.mask).ok()).sum();
    Ok(format!(
        "| {} | {} | {sought} | {:.0}, {:.0} | {:.0} | {:.3}, {:.3} (of each other {:.3}) | {:.3}, {:.3} | {apart:.3} at most |\n",
        motion.name,
        motion.frames,
        percentile(0.5),
        percentile(0.99),
        worked / latencies.len() as f64,
        mean(&own, &|scored| scored.iou),
        mean(&single, &|scored| scored.iou),
        overlap / own.len().max(1) as f64,
        mean(&own, &|scored| scored.error),
        mean(&single, &|scored| scored.error),
    ))
}

/// Processor time of all threads so far, in milliseconds, as Linux counts it; not a number elsewhere.
fn processor_ms() -> f64 {
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let nanoseconds = |thread: std::fs::DirEntry| -> Option<f64> {
        let counts = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        counts.split_whitespace().next()?.parse().ok()
    };
    1e-6 * threads.flatten().filter_map(nanoseconds).sum::<f64>()
}

/// What is true of a frame.
struct Truth<'a> {
    places: &'a [f64],
    mask: Vec<bool>,
    force: f64,
}

fn score(solution: &Solution, contact: &Contact, truth: &Truth<'_>) -> Scored {
    let values = |name: &str, points: &[f64]| {
        let estimate = solution.evaluate(points).into_iter().find(|estimate| estimate.name == name);
        estimate.map(|estimate| estimate.values)
    };
    let force = contact.score(&values, None).map_or(f64::NAN, |score| score.magnitude());
    let mask = contact.rule.mask(&values("f", truth.places).unwrap_or_default());
    let iou = if truth.mask == mask { 1.0 } else { intersection_over_union(&mask, &truth.mask).unwrap_or(f64::NAN) };
    Scored { mask, iou, force, error: (force - truth.force).abs() }
}

/// A cloud of the surface, noisy along z.
fn seen(membrane: &Membrane, options: &Options, random: &mut Random) -> Cloud {
    let mut points = Vec::new();
    while points.len() < options.points {
        let mut point = membrane.point(random.uniform(), [random.uniform(), random.uniform()]);
        if (point[0] / AXES[0]).hypot(point[1] / AXES[1]) < SEEN {
            point[2] += 1e-3 * options.noise * random.normal();
            points.push(point);
        }
    }
    Cloud { points, ..Cloud::default() }
}

fn prepared(cloud: &Cloud, cells: Option<usize>) -> Result<Prepared, String> {
    let entry = crate::entry("membrane")?;
    let parameters =
        [("p", PRESSURE), ("E", YOUNG), ("t", 1e3 * THICKNESS), ("nu", POISSON), ("a", AXES[0]), ("b", AXES[1])];
    let request = Request {
        frame: Some(("frame".into(), cloud.clone())),
        parameters: parameters.map(|(name, value)| (name.into(), value)).to_vec(),
        cells,
        ..Request::default()
    };
    entry.prepare(&request).map_err(|error| error.to_string())
}

fn suited(prepared: &Prepared, options: &Options) -> Settings {
    let threads = options.threads.unwrap_or_else(nisp_cli::processors);
    prepared.suited(Settings { budget: Some(BUDGET), threads, ..Settings::default() })
}
