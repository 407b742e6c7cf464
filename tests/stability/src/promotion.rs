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

/// Runs until `done`, which sees what was found and the seconds, and looks now and then.
fn run(
    problem: &Problem,
    truth: &Truth,
    settings: &Settings,
    done: &(dyn Fn(&[Moment], f64) -> bool + Sync),
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
        moments.push(Moment { seconds, loss: report.loss, error });
        looking += look.elapsed();
        if done(&moments, seconds) { Flow::Stop } else { Flow::Continue }
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

/// The time to the loss, and that to the error, that double precision alone has in the end, each over its own time to it.
/// Two runs that part early are ahead of each other by luck, so that each is the median of some initial weights; the worse
/// counts. To ask for both of one run would be unfair: of two runs of the same method, one tends to be behind the other in
/// either.
fn ratio(name: &str, optimizer: Optimizer, width: usize, seeds: u64) -> Row {
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
    let of_seed = |seed| -> Result<[f64; 2], RecoverError> {
        let (alone, _) = run(&prepared.problem, truth, &settings(Width::F64, seed), &|_, seconds| seconds >= SECONDS)?;
        let Some(&goal) = alone.last() else { return Ok([f64::NAN; 2]) };
        // Errors do not fall evenly: within a hundredth of where they ended counts.
        let (loss, error) = (goal.loss, 1.01 * goal.error);
        let times = |moments: &[Moment]| [reached(moments, loss, |m| m.loss), reached(moments, error, |m| m.error)];
        let is_there = |moments: &[Moment], seconds| {
            seconds >= 1.5 * SECONDS || times(moments).iter().all(|time| time.is_finite())
        };
        let (both, _) = run(&prepared.problem, truth, &settings(Width::Auto, seed), &is_there)?;
        let (both, alone) = (times(&both), times(&alone));
        Ok([both[0] / alone[0], both[1] / alone[1]])
    };
    let ratios: Vec<[f64; 2]> = (0..seeds).map(|seed| of_seed(seed).unwrap_or([f64::NAN; 2])).collect();
    let median = |of: usize| {
        let mut ratios: Vec<f64> = ratios.iter().map(|ratio| ratio[of]).collect();
        ratios.sort_by(f64::total_cmp);
        ratios[ratios.len() / 2]
    };
    let [by_loss, by_error] = [median(0), median(1)];
    let samples = format!("{seeds} seeds, by loss {by_loss:.2}, by error {by_error:.2}");
    // What is not a number is the worst.
    let worst = if by_loss.total_cmp(&by_error).is_gt() { by_loss } else { by_error };
    Row::new(what, samples, worst, 0.6).timed("a step in f32 takes .50 to .56 of the time of one in f64")
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
        for (name, optimizer, width, seeds) in [
            ("pendulum", Optimizer::Adam, 128, 9),
            ("pendulum", Optimizer::Adam, 256, 9),
            // Small networks take thousands of steps of L-BFGS in the time: luck has more to say.
            ("pendulum", Optimizer::Lbfgs, 64, 27),
            ("pendulum", Optimizer::Lbfgs, 128, 9),
            ("pendulum", Optimizer::Lbfgs, 256, 9),
            ("plate", Optimizer::Adam, 128, 9),
            ("plate", Optimizer::Lbfgs, 64, 9),
            ("plate", Optimizer::Lbfgs, 128, 9),
        ] {
            rows.push(ratio(name, optimizer, width, seeds));
        }
    }
    rows
}
