//! `nisp solve`: from a table or a cloud to a source.

use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Duration;

use nisp::network::Architecture;
use nisp::solve::driver::{Flow, Status};
use nisp::{Checkpoint, Optimizer, Report, Resampling, Settings, Solution, Width, recover, resume};
use nisp_data::OutDir;
use nisp_equations::{Prepared, Request, Truth};

use crate::args::Options;
use crate::checkpoint::{self, Keeper};
use crate::score::Found;
use crate::{interrupt, report, results};

/// Not converged.
const NOT_CONVERGED: u8 = 3;

/// Solves, writes the results, and says how well it went.
pub(crate) fn solve(options: &Options) -> Result<ExitCode, String> {
    let entry = crate::entry(&options.equation)?;
    let settings = settings(options)?;
    let request = Request {
        scene: options.scene.clone(),
        data: options.data.clone(),
        sample: options.sample.clone(),
        cloud: options.cloud,
        unit: options.unit,
        truth: options.truth.clone(),
        // Whoever names a method means one of those that train networks.
        network: options.network || settings.optimizer != Optimizer::Auto,
        columns: options.column.clone(),
        parameters: options.set.clone(),
    };
    let prepared = entry.prepare(&request).map_err(|error| error.to_string())?;
    let settings = prepared.suited(settings);
    let from = options.resume.as_deref().map(checkpoint::read).transpose()?;
    let mut out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    interrupt::listen()?;
    let mut keeper = options.checkpoint.then(|| Keeper::new(&mut out));
    let mut solution = run(&prepared, &settings, from.as_ref(), keeper.as_mut())?;
    let mut warnings = prepared.warnings.clone();
    warnings.extend(keeper.and_then(|keeper| keeper.failure));
    warnings.extend(solution.warnings.iter().map(|warning| warning.message.clone()));
    // What the compiler found: one line each, without its advice to whoever writes the equations.
    let open = solution.scene().warnings.iter().filter_map(|message| message.lines().next());
    warnings.extend(open.map(|message| format!("{message}: the problem may be underdetermined")));
    if solution.status == Status::Interrupted {
        warnings.push(format!("interrupted after {:.1} s: this is the best state so far", solution.wall_s));
    }
    warnings.extend(prepared.truth.as_ref().and_then(unscored));
    let (mut files, estimates) = results::files(&prepared, &mut solution).map_err(|error| error.to_string())?;
    let found = Found::of(&mut solution, &prepared, &estimates);
    warnings.extend(found.warnings());
    if options.checkpoint || solution.status == Status::Interrupted {
        files.push((checkpoint::NAME, solution.checkpoint.to_bytes()));
    }
    out.write(&files).map_err(|error| error.to_string())?;
    let written = report::written(&files, &out);
    let text = if options.json {
        report::json(&solution, options, &settings, &found, &warnings)
    } else {
        report::table(&solution, &prepared, &found.with_rival(&prepared), &warnings, &written)
    };
    crate::print(&text)?;
    let failed = matches!(solution.status, Status::NotConverged | Status::Interrupted);
    Ok(if failed { ExitCode::from(NOT_CONVERGED) } else { ExitCode::SUCCESS })
}

/// What of the truth is not scored.
fn unscored(truth: &Truth) -> Option<String> {
    let all = truth.points.len() + truth.outside;
    (truth.outside > 0)
        .then(|| format!("{} of {all} rows of the truth are outside the data's times: not scored", truth.outside))
}

fn settings(options: &Options) -> Result<Settings, String> {
    let threads = options.threads.unwrap_or_else(processors);
    if threads > MOST_THREADS {
        return Err(format!("--threads {threads}: at most {MOST_THREADS}; leave it out for one per processor"));
    }
    Ok(Settings {
        precision: Width::from_name(&options.precision).unwrap_or(Width::Auto),
        optimizer: Optimizer::from_name(&options.optimizer).unwrap_or(Optimizer::Auto),
        architecture: Architecture { width: options.width, layers: options.layers, ..Settings::default().architecture },
        resampling: options.resample.map(|every| Resampling { every: every as u64, ..Resampling::default() }),
        seed: options.seed,
        budget: Some(Duration::from_secs_f64(options.budget)),
        iterations: options.iterations.map(|count| count as u64),
        threads,
        ..Settings::default()
    })
}

/// As many threads as the machine runs at once.
pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// No machine has more, and asking the system for them would end badly.
const MOST_THREADS: usize = 1024;

/// Runs the solver, with a line of progress on a terminal.
fn run(
    prepared: &Prepared,
    settings: &Settings,
    from: Option<&Checkpoint>,
    mut keeper: Option<&mut Keeper<'_>>,
) -> Result<Solution, String> {
    let terminal = std::io::stderr().is_terminal();
    let budget = settings.budget.unwrap_or_default().as_secs_f64();
    let mut shown = 0.0;
    let mut monitor = |report: Report<'_>| {
        if let Some(keeper) = &mut keeper {
            keeper.see(&report);
        }
        if terminal && report.elapsed_s >= shown {
            shown = report.elapsed_s + 0.1;
            let (now, step, loss) = (report.elapsed_s, report.iteration, report.loss);
            eprint!("\r{now:6.1} of {budget} s  step {step}  loss {loss:.3e}\x1b[K");
        }
        if interrupt::asked() { Flow::Stop } else { Flow::Continue }
    };
    let result = match from {
        None => recover(&prepared.problem, settings, &mut monitor),
        Some(checkpoint) => resume(&prepared.problem, settings, checkpoint, &mut monitor),
    };
    if terminal {
        eprint!("\r\x1b[K");
    }
    result.map_err(|error| error.to_string())
}
