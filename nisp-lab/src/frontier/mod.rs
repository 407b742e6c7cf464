//! `nisp-lab frontier`: error of the source against time, by method, width and precision, beside the classical rivals.
//!
//! Every figure of a scene over time is a mean over fresh noisy copies of the repository's truths, so that settings chosen
//! on the copies in the repository are not judged on them. Other scenes are solved from a sample with a truth.

mod report;
mod trial;

use std::path::PathBuf;
use std::process::ExitCode;

use nisp::{Optimizer, Width};
use nisp_data::OutDir;
use nisp_equations::{Entry, PrepareError, Prepared, Request, yardsticks};

use crate::measure::Measure;
use nisp_cli::interrupt;
use nisp_cli::options::{count, number, optimizers, precisions, seconds, seed, size};
use nisp_cli::terminal::progress;
use report::{Figures, Point};
use trial::Trial;

/// What to try.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Equation (see `nisp list`).
    #[arg(value_name = "SCENE")]
    equation: String,
    /// One of the equation's scenes [default: its first].
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Standard deviation of the noise on every measured quantity of a scene over time, in its declared unit [default: 0].
    #[arg(long, value_name = "SIGMA", value_parser = number, allow_negative_numbers = true)]
    noise: Option<f64>,
    /// TOML file of a sample whose contact was seen as clouds [default: the equation's example].
    #[arg(long, value_name = "FILE", requires = "truth")]
    sample: Option<PathBuf>,
    /// CSV of that sample's truth.
    #[arg(long, value_name = "FILE", requires = "sample")]
    truth: Option<PathBuf>,
    /// Which of the sample's clouds, counted from 0.
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    cloud: Option<usize>,
    /// Methods, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = optimizers(),
          default_value = "adam,lbfgs,broyden,gauss-newton,lm,varpro,evidence")]
    optimizers: Vec<String>,
    /// Widths of the network, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "8,16,32", value_parser = size)]
    widths: Vec<usize>,
    /// Its layers.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = size)]
    layers: usize,
    /// Element types, separated by commas; a method that needs f64 is tried in it only.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "f32,auto,f64", value_parser = precisions())]
    precisions: Vec<String>,
    /// Budgets in seconds, separated by commas; each is a run of its own.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "0.3,1,3", value_parser = seconds)]
    budgets: Vec<f64>,
    /// How many copies of the repository's truths, from the first on; of exact ones, one each at most.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = count)]
    runs: usize,
    /// Seed of the noise (one more for each truth) and of the initial weights.
    #[arg(long, value_name = "N", default_value_t = 2026, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Threads [default: one per processor].
    #[arg(long, value_name = "N", value_parser = count)]
    threads: Option<usize>,
    /// The repository, whose truths are read.
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
    /// Folder for frontier.csv and frontier.svg, and of a contact frontier_patch.svg.
    #[arg(long, value_name = "DIR", default_value = "nisp-out")]
    out: PathBuf,
}

/// Tries everything, prints a table, writes it and a plot.
pub(crate) fn frontier(options: &Options) -> Result<ExitCode, String> {
    let entry = crate::entry(&options.equation)?;
    let samples = samples(&entry, options, true)?;
    let local = samples_for_local_functions(&entry, options)?;
    let measures = measures(&samples[0])?;
    let trials = trials(options, !local.is_empty());
    let out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    interrupt::listen(crate::NAME)?;
    let total: f64 = options.budgets.iter().sum::<f64>() * (trials.len() * samples.len()) as f64;
    progress(&format!("{} runs, {total:.0} s at most\n", trials.len() * samples.len() * options.budgets.len()));
    let mut points = Vec::new();
    for trial in trials {
        for &budget in &options.budgets {
            progress(&format!("{} {}, {budget} s", trial.name(), trial.width()));
            let outcome = trial.over(if trial.local { &local } else { &samples }, &measures, budget)?;
            points.push(Point { trial: trial.clone(), budget, outcome });
        }
    }
    progress("");
    let figures = Figures {
        about: about(&entry, &samples, options),
        measures,
        budgets: options.budgets.clone(),
        widths: options.widths.clone(),
        points,
        rivals: yardsticks(&samples),
    };
    let mut files = vec![("frontier.csv", report::csv(&figures).into())];
    for (file, measure) in [("frontier.svg", figures.measures[0]), ("frontier_patch.svg", Measure::Distance)] {
        let title = format!("{}: {} against wall time", entry.name, measure.quantity().0);
        let plot = report::plot(&figures, measure, title).map_err(|error| error.to_string())?;
        files.extend(plot.map(|plot| (file, plot.svg().into())));
    }
    out.write(&files).map_err(|error| error.to_string())?;
    nisp_cli::terminal::print(&report::tables(&figures))?;
    Ok(ExitCode::SUCCESS)
}

/// On what it is measured.
fn about(entry: &Entry, samples: &[Prepared], options: &Options) -> String {
    let runs = if samples.len() == 1 { "1 run".into() } else { format!("{} runs", samples.len()) };
    let data = match (entry.series(), options.noise.unwrap_or(0.0)) {
        (None, _) => samples[0].source.clone(),
        (_, 0.0) => format!("{runs}, exact measurements"),
        (_, noise) => format!("{runs}, noise {noise}, seeds from {}", options.seed),
    };
    match &options.widths[..] {
        [width] => format!("{data}; networks of {} x {width}", options.layers),
        _ => format!("{data}; networks of {} layers", options.layers),
    }
}

/// What a scene is judged by: the error of its source, and of a contact the patch as well.
fn measures(sample: &Prepared) -> Result<Vec<Measure>, String> {
    let heads = sample.problem.scene().schema.heads;
    // A forward problem has no source: what it is judged by is its field.
    let head = heads.iter().find(|head| head.source).unwrap_or(&heads[0]);
    if sample.truth.as_ref().and_then(|truth| truth.of(head.name)).is_none() {
        return Err(format!("the truth has no `{}`, so there is no error of it", head.name));
    }
    let mut measures = vec![Measure::Error(head.name, head.unit.text)];
    if sample.contact.as_ref().is_some_and(|contact| contact.truth.is_some()) {
        measures.extend([Measure::Overlap, Measure::Distance]);
    }
    Ok(measures)
}

/// Everything to be tried, in the order of the table.
fn trials(options: &Options, local: bool) -> Vec<Trial> {
    let threads = options.threads.unwrap_or_else(nisp_cli::processors);
    let (layers, seed) = (options.layers, options.seed);
    let network =
        |optimizer, precision, width| Trial { local: false, optimizer, precision, width, layers, threads, seed };
    let mut trials = Vec::new();
    if local {
        trials.push(Trial { local: true, ..network(Optimizer::Auto, Width::F64, 0) });
    }
    for optimizer in options.optimizers.iter().filter_map(|name| Optimizer::from_name(name)) {
        for precision in options.precisions.iter().filter_map(|name| Width::from_name(name)) {
            trials.extend(options.widths.iter().map(|&width| network(optimizer, precision, width)));
        }
    }
    trials.retain(|trial| trial.precision == Width::F64 || trial.optimizer.works_in_single());
    trials
}

/// Fresh copies of the truths of a scene over time, or a sample of another, bound to the scene.
fn samples(entry: &Entry, options: &Options, network: bool) -> Result<Vec<Prepared>, String> {
    let request = Request {
        scene: options.scene.clone(),
        sample: options.sample.clone(),
        truth: options.truth.clone(),
        cloud: options.cloud,
        network,
        ..Request::default()
    };
    let Some(series) = entry.series() else {
        if options.noise.is_some() {
            return Err(format!("`{}` has no measurements over time to add noise to; leave --noise out", entry.name));
        }
        return Ok(vec![entry.prepare(&request).map_err(|error| error.to_string())?]);
    };
    if options.cloud.is_some() || options.sample.is_some() {
        return Err(format!("`{}` has no clouds; leave --sample and --cloud out", entry.name));
    }
    let noise = options.noise.unwrap_or(0.0);
    series.copies(entry, &request, &options.repository, noise, options.seed, options.runs).map_err(
        |error| match error {
            PrepareError::Data(error) => {
                format!("{error}; the frontier needs the repository's data: name its folder with --repository")
            }
            error => error.to_string(),
        },
    )
}

/// The same, where local functions suit the scene.
fn samples_for_local_functions(entry: &Entry, options: &Options) -> Result<Vec<Prepared>, String> {
    let samples = if entry.series().is_some() { Vec::new() } else { samples(entry, options, false)? };
    Ok(samples.into_iter().filter(|sample| sample.local.is_some()).collect())
}
