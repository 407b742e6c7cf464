//! Single precision that turns double where it helps no more: how soon it is where double precision alone is after some
//! seconds. Time is measured in the full report only.

use std::path::Path;
use std::time::{Duration, Instant};

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Problem, RecoverError, Report, Settings, Solution, Width, recover, resume};
use nisp_equations::{Prepared, Request, Truth, catalogue};

use crate::row::{Extent, Row};

/// Seconds of double precision.
const SECONDS: f64 = 4.0;
/// Initial weights.
const SEEDS: u64 = 9;
/// Looks at a run, each at the cost of a checkpoint and a step, which are not counted.
const LOOKS: u32 = 40;

/// How far a run is.
#[derive(Clone, Copy)]
struct Moment {
    seconds: f64,
    loss: f64,
    /// Mean distance from the truth.
    error: f64,
}

/// Mean distance of sources from the truth, in declared units; of fields where there is no source.
fn error(solution: &Solution, truth: &Truth) -> f64 {
    let estimates = solution.evaluate(&truth.points);
    let has_source = estimates.iter().any(|estimate| estimate.source);
    let off = |estimate: &nisp::Estimate| {
        let values = truth.of(estimate.name)?;
        Some(estimate.values.iter().zip(values).map(|(a, b)| (a - b).abs()).sum::<f64>() / values.len() as f64)
    };
    estimates.iter().filter(|estimate| estimate.source == has_source).filter_map(off).sum()
}

/// Runs until `done`, and looks now and then.
fn run(
    problem: &Problem,
    truth: &Truth,
    settings: &Settings,
    done: &(dyn Fn(&Moment) -> bool + Sync),
) -> Result<(Vec<Moment>, Solution), RecoverError> {
    let mut moments: Vec<Moment> = Vec::new();
    let (start, mut looking) = (Instant::now(), Duration::ZERO);
    let solution = recover(problem, settings, &mut |report: Report<'_>| {
        let seconds = (start.elapsed() - looking).as_secs_f64();
        let next = moments.last().map_or(0.0, |last| last.seconds) + SECONDS / f64::from(LOOKS);
        if seconds < next {
            return Flow::Continue;
        }
        let look = Instant::now();
        let here = resume(problem, settings, &(report.checkpoint)(), &mut |_| Flow::Stop);
        let error = here.map_or(f64::NAN, |solution| error(&solution, truth));
        let moment = Moment { seconds, loss: report.loss, error };
        moments.push(moment);
        looking += look.elapsed();
        if done(&moment) { Flow::Stop } else { Flow::Continue }
    })?;
    Ok((moments, solution))
}

/// When a falling quantity reached `goal` first, on straight lines between the looks at its logarithm.
fn reached(moments: &[Moment], goal: f64, of: impl Fn(&Moment) -> f64) -> f64 {
    let Some(at) = moments.iter().position(|moment| of(moment) <= goal) else { return f64::INFINITY };
    let after = moments[at];
    let Some(before) = at.checked_sub(1).map(|at| moments[at]) else { return after.seconds };
    let share = (of(&before) / goal).ln() / (of(&before) / of(&after)).ln();
    before.seconds + share * (after.seconds - before.seconds)
}

/// The time to both the loss and the error that double precision alone has in the end, over its own time to them: the
/// median of some initial weights, for two runs that part early are ahead of each other by luck.
fn ratio(name: &str, optimizer: Optimizer, width: usize) -> Row {
    let entry = catalogue().into_iter().find(|entry| entry.name == name).expect("an entry");
    let request = Request { network: true, ..Request::default() };
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // Without noise, so that accuracy has no bound but the digits.
    let prepared: Prepared = match entry.series() {
        Some(series) => {
            series.copies(&entry, &request, &repository, 0.0, 1, 1).expect("the repository's truths").remove(0)
        }
        None => entry.prepare(&request).expect("the repository's example"),
    };
    let truth = prepared.truth.as_ref().expect("a truth");
    // Adam as in the paper, which sees the plain coordinates.
    let inputs = if optimizer == Optimizer::Adam { Inputs::Coordinates } else { Inputs::Automatic };
    let settings = |precision, seed| Settings {
        optimizer,
        precision,
        seed,
        architecture: Architecture { inputs, ..Architecture::modified(width, 2) },
        budget: None,
        ..Settings::default()
    };
    let what = format!(
        "`{name}`, {optimizer}, width {width}: f32 then f64, time to the accuracy of f64",
        optimizer = optimizer.name()
    );
    let of_seed = |seed| -> Result<f64, RecoverError> {
        let (alone, _) = run(&prepared.problem, truth, &settings(Width::F64, seed), &|m| m.seconds >= SECONDS)?;
        let Some(&goal) = alone.last() else { return Ok(f64::NAN) };
        // Errors do not fall evenly: within a hundredth of where they ended counts.
        let (loss, error) = (goal.loss, 1.01 * goal.error);
        let time = |moments: &[Moment]| reached(moments, loss, |m| m.loss).max(reached(moments, error, |m| m.error));
        let is_there = |m: &Moment| (m.loss <= loss && m.error <= error) || m.seconds >= 1.5 * SECONDS;
        let (both, _) = run(&prepared.problem, truth, &settings(Width::Auto, seed), &is_there)?;
        Ok(time(&both) / time(&alone))
    };
    let mut ratios: Vec<f64> = (0..SEEDS).map(|seed| of_seed(seed).unwrap_or(f64::NAN)).collect();
    ratios.sort_by(f64::total_cmp);
    let samples = format!("{SEEDS} seeds, {:.2} to {:.2}", ratios[0], ratios[ratios.len() - 1]);
    Row::new(what, samples, ratios[ratios.len() / 2], 0.6)
        .timed(
            "a step in f32 takes .48 to .55 of the time of one in f64, and of two runs that part early either may need a tenth \
             more steps",
        )
}

/// Methods that need double precision, of which one is run in single, or not refused in words.
fn methods_of_double() -> Row {
    let entry = catalogue().into_iter().find(|entry| entry.name == "rlc").expect("an entry");
    let problem = entry.prepare(&Request::default()).expect("the repository's example").problem;
    let methods = Optimizer::ALL.into_iter().filter(|optimizer| !optimizer.works_in_single());
    let is_wrong = |&optimizer: &Optimizer| {
        let attempt = |precision| {
            let architecture = Architecture::modified(8, 2);
            let settings = Settings {
                optimizer,
                precision,
                architecture,
                iterations: Some(2),
                budget: None,
                ..Settings::default()
            };
            recover(&problem, &settings, &mut |_| Flow::Continue)
        };
        let refused = matches!(attempt(Width::F32), Err(RecoverError::Precision { .. }));
        let doubled = attempt(Width::Auto).is_ok_and(|solution| solution.precision() == "f64");
        !(refused && doubled)
    };
    let names: Vec<&str> = methods.clone().map(Optimizer::name).collect();
    let what = format!("{} need f64: not refused in f32, or not in f64 by themselves", names.join(", "));
    Row::count(what, names.len(), methods.filter(is_wrong).count())
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = vec![methods_of_double()];
    if extent == Extent::Full {
        for (name, optimizer, width) in [
            ("pendulum", Optimizer::Adam, 128),
            ("pendulum", Optimizer::Adam, 256),
            ("pendulum", Optimizer::Lbfgs, 64),
            ("pendulum", Optimizer::Lbfgs, 128),
            ("pendulum", Optimizer::Lbfgs, 256),
            ("plate", Optimizer::Adam, 128),
            ("plate", Optimizer::Lbfgs, 64),
            ("plate", Optimizer::Lbfgs, 128),
        ] {
            rows.push(ratio(name, optimizer, width));
        }
    }
    rows
}
