//! `nisp solve`: from a table or a cloud to a source.

use std::process::ExitCode;
use std::time::Duration;

use crate::score::Found;
use crate::terminal::{NOT_CONVERGED, NOT_WRITTEN, note, print, progress};
use crate::{interrupt, processors};
use nisp::network::{Activation, Architecture};
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Checkpoint, Optimizer, Report, Resampling, Settings, Solution, Width, recover, resume};
use nisp_data::OutDir;
use nisp_equations::{Entry, Prepared, Request, Survey, Truth, Wanted};

use crate::args::Options;
use crate::checkpoint::{self, Keeper};
use crate::inputs::spare;
use crate::options::view;
use crate::program::Program;
use crate::report::{self, Run};
use crate::results;
use crate::rivals::Rivals;

/// Solves, writes the results, and says how well it went.
pub(crate) fn solve(program: &Program, options: &Options) -> Result<ExitCode, String> {
    let entry = program.entry(&options.equation)?;
    let settings = settings(options, entry.usual_budget())?;
    let request = Request {
        scene: options.scene.clone(),
        data: options.data.clone(),
        sample: options.sample.clone(),
        cloud: options.cloud,
        calibration: options.calibration.clone(),
        view: view(options.unit, options.camera.as_deref()).map_err(|error| error.to_string())?,
        wanted: wanted(options),
        truth: options.truth.clone(),
        network: settings.carrier == Carrier::Network,
        columns: options.column.clone(),
        points: options.points.clone(),
        parameters: options.set.clone(),
        ..Request::default()
    };
    let mut prepared = entry.prepare(&request).map_err(|error| error.to_string())?;
    prepared.problem.set_robust(options.robust);
    let settings = prepared.suited(settings);
    let from = options.resume.as_deref().map(checkpoint::read).transpose()?;
    interrupt::listen(program.name)?;
    let names = [results::names(&prepared), vec![checkpoint::NAME]].concat();
    let inputs = options.inputs();
    names.iter().try_for_each(|name| spare(&inputs, &options.out.join(name)))?;
    OutDir::require_free(&options.out, &names).map_err(|error| error.to_string())?;
    let out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    interrupt::clean(out.traces());
    let mut keeper = Keeper::new(&out, options.checkpoint);
    let mut solution = run(&prepared, &settings, from.as_ref(), &mut keeper)?;
    let failure = keeper.failure.take();
    interrupt::keep(out.file(checkpoint::NAME), solution.checkpoint.clone());
    let interrupted = solution.status == Status::Interrupted;
    let mut answer =
        results::answer(&prepared, &mut solution, options.at.as_deref()).map_err(|error| error.to_string())?;
    if options.checkpoint || interrupted {
        answer.files.push((checkpoint::NAME, solution.checkpoint.to_bytes()));
    }
    // Files of these names are an earlier run's where its answer lies beside them, and the user's own elsewhere.
    let has_earlier = out.file(results::SAVED).exists();
    let written = interrupt::placing(|| out.write_somewhere(&answer.files));
    if written.fault.is_none() && has_earlier {
        let is_stale = |name: &&'static str| !answer.files.iter().any(|(own, _)| own == name);
        out.forget(results::names(&prepared).into_iter().filter(is_stale));
    }
    if let Some(folder) = &written.folder {
        interrupt::kept(folder.clone());
    }
    let found = Found::of(&mut solution, &prepared, &answer.estimates);
    let unfinished = matches!(solution.status, Status::NotConverged | Status::Interrupted);
    let failed = unfinished || !solution.verdict.passed();
    let more = failure.into_iter().chain(answer.warnings.iter().cloned());
    let more = more.chain(if failed { questions(&entry, &prepared) } else { Vec::new() });
    let warnings = warnings(&prepared, &solution, &found, more);
    let rivals = options.rivals.then(|| Rivals::of(&prepared));
    let (settings, prepared, answer, written) = (&settings, &prepared, &answer, &written);
    let run = Run { options, settings, prepared, answer, written, warnings, rivals };
    let text =
        if options.json { report::json(&solution, &run, &found) } else { report::table(&solution, &run, &found) };
    if let Err(message) = print(&text) {
        note(&format!("{}: {message}\n", program.name));
        return Ok(ExitCode::from(NOT_WRITTEN));
    }
    Ok(match (failed, &written.fault) {
        (_, Some(_)) => ExitCode::from(NOT_WRITTEN),
        (true, None) => ExitCode::from(NOT_CONVERGED),
        (false, None) => ExitCode::SUCCESS,
    })
}

/// Where the user wants the answer.
fn wanted(options: &Options) -> Option<Wanted> {
    let grid = options.grid.as_ref().map(|grid| Wanted::Grid(grid.0.clone()));
    options.at.clone().map(Wanted::At).or(grid)
}

/// What `nisp check` asks of the places of the data: whether they are in another unit, or swapped.
fn questions(entry: &Entry, prepared: &Prepared) -> Vec<String> {
    let groups = prepared.problem.scene().schema.groups.iter();
    groups.filter_map(|group| Survey::of(entry, prepared, group)).flat_map(|survey| survey.questions()).collect()
}

/// All that the user should know, one line each; `more` is of this run's files.
fn warnings(
    prepared: &Prepared,
    solution: &Solution,
    found: &Found,
    more: impl Iterator<Item = String>,
) -> Vec<String> {
    let mut warnings = prepared.warnings.clone();
    warnings.extend(more);
    warnings.extend(solution.warnings.iter().map(|warning| warning.message.clone()));
    // What the compiler found: one line each, without its advice to whoever writes the equations.
    let open = solution.scene().warnings.iter().filter_map(|message| message.lines().next());
    warnings.extend(open.map(|message| format!("{message}: the problem may be underdetermined")));
    if solution.status == Status::Interrupted {
        let seconds = solution.wall_s;
        warnings.push(format!("interrupted after {seconds:.1} s: this is the best state so far, without error bars"));
    }
    warnings.extend(prepared.truth.iter().flat_map(|truth| unscored(truth, solution)));
    warnings.extend(found.warnings());
    warnings
}

/// What is not scored: rows of the truth, and sources that it has no column for.
fn unscored<'a>(truth: &'a Truth, solution: &'a Solution) -> impl Iterator<Item = String> + 'a {
    let all = truth.points.len() + truth.outside;
    let rows = (truth.outside > 0)
        .then(|| format!("{} of {all} rows of the truth are outside the data's times: not scored", truth.outside));
    let sources = solution.scene().heads.iter().filter(|head| head.source && truth.of(head.name).is_none());
    rows.into_iter().chain(
        sources.map(|head| format!("the truth has no column for the source `{}`: its error is not known", head.name)),
    )
}

fn settings(options: &Options, usual: Duration) -> Result<Settings, String> {
    let threads = options.threads.unwrap_or_else(processors);
    if threads > MOST_THREADS {
        return Err(format!("--threads {threads}: at most {MOST_THREADS}; leave it out for one per processor"));
    }
    let optimizer = Optimizer::from_name(&options.optimizer).unwrap_or(Optimizer::Auto);
    let activation = options.activation.as_deref().and_then(Activation::from_name);
    let trained = [(optimizer != Optimizer::Auto, "optimizer"), (activation.is_some(), "activation")];
    if let Some((_, option)) = trained.iter().find(|(given, _)| *given && options.carrier == "splines") {
        return Err(format!("--carrier splines takes no --{option}, which is of networks; leave one of the two out"));
    }
    let carrier = match options.carrier.as_str() {
        "network" => Carrier::Network,
        "splines" => Carrier::Splines,
        // Only networks are trained by methods, and have activations.
        _ if optimizer != Optimizer::Auto || activation.is_some() => Carrier::Network,
        _ => Carrier::Auto,
    };
    let architecture = Architecture {
        width: options.width,
        layers: options.layers,
        activation: activation.unwrap_or_default(),
        ..Settings::default().architecture
    };
    Ok(Settings {
        carrier,
        precision: Width::from_name(&options.precision).unwrap_or(Width::Auto),
        optimizer,
        architecture,
        resampling: options.resample.map(|every| Resampling { every: every as u64, ..Resampling::default() }),
        seed: options.seed,
        budget: Some(options.budget.map_or(usual, Duration::from_secs_f64)),
        iterations: options.iterations.map(|count| count as u64),
        threads,
        ..Settings::default()
    })
}

/// No machine has more, and asking the system for them would end badly.
const MOST_THREADS: usize = 1024;

/// Runs the solver, with a line of progress on a terminal.
fn run(
    prepared: &Prepared,
    settings: &Settings,
    from: Option<&Checkpoint>,
    keeper: &mut Keeper<'_>,
) -> Result<Solution, String> {
    let budget = settings.budget.unwrap_or_default().as_secs_f64();
    let mut shown = 0.0;
    let mut monitor = |report: Report<'_>| {
        keeper.see(&report);
        if report.elapsed_s >= shown {
            shown = report.elapsed_s + 0.1;
            let (now, step, loss) = (report.elapsed_s, report.iteration, report.loss);
            progress(&format!("{now:6.1} of {budget} s  step {step}  loss {loss:.3e}"));
        }
        if interrupt::asked() { Flow::Stop } else { Flow::Continue }
    };
    let result = match from {
        None => recover(&prepared.problem, settings, &mut monitor),
        Some(checkpoint) => resume(&prepared.problem, settings, checkpoint, &mut monitor),
    };
    progress("");
    result.map_err(|error| error.to_string())
}
