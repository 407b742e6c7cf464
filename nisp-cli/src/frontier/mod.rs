//! `nisp frontier`: error of the source against time, by method, width and precision, beside the classical rivals.
//!
//! Every figure is a mean over fresh noisy copies of the repository's truths, so that settings chosen on the copies in
//! the repository are not judged on them.

mod report;
mod trial;

use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;

use nisp::{Optimizer, Width};
use nisp_data::OutDir;
use nisp_equations::{Entry, PrepareError, Prepared, Request, yardsticks};

use crate::args::{count, number, optimizers, seconds, size};
use crate::interrupt;
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
    /// Standard deviation of the noise on every measured quantity, in its declared unit.
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, value_parser = number, allow_negative_numbers = true)]
    noise: f64,
    /// Methods, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = optimizers(),
          default_value = "adam,lbfgs,broyden,lm,evidence")]
    optimizers: Vec<String>,
    /// Widths of the network, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "8,16,32", value_parser = size)]
    widths: Vec<usize>,
    /// Element types, separated by commas; a method that needs f64 is tried in it only.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "f32,f64", value_parser = ["f32", "f64"])]
    precisions: Vec<String>,
    /// Budgets in seconds, separated by commas; each is a run of its own.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "0.3,1,3", value_parser = seconds)]
    budgets: Vec<f64>,
    /// How many of the repository's truths, from the first on.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = count)]
    runs: usize,
    /// Seed of the noise (one more for each truth) and of the initial weights.
    #[arg(long, value_name = "N", default_value_t = 2026)]
    seed: u64,
    /// Threads [default: one per processor].
    #[arg(long, value_name = "N", value_parser = count)]
    threads: Option<usize>,
    /// The repository, whose truths are read.
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
    /// Folder for frontier.csv and frontier.svg.
    #[arg(long, value_name = "DIR", default_value = "nisp-out")]
    out: PathBuf,
}

/// Tries everything, prints a table, writes it and a plot.
pub(crate) fn frontier(options: &Options) -> Result<ExitCode, String> {
    let entry = crate::entry(&options.equation)?;
    let samples = samples(&entry, options)?;
    let trials = trials(options);
    let out = OutDir::create(&options.out).map_err(|error| error.to_string())?;
    interrupt::listen()?;
    let total: f64 = options.budgets.iter().sum::<f64>() * (trials.len() * samples.len()) as f64;
    if std::io::stderr().is_terminal() {
        eprintln!("{} runs, {total:.0} s at most", trials.len() * samples.len() * options.budgets.len());
    }
    let mut points = Vec::new();
    for trial in trials {
        for &budget in &options.budgets {
            if interrupt::asked() {
                return Err("interrupted; nothing was written".into());
            }
            let (error, seconds) = trial.over(&samples, budget)?;
            points.push(Point { trial: trial.clone(), budget, error, seconds });
        }
    }
    let figures = Figures { points, rivals: yardsticks(&samples), samples: samples.len(), noise: options.noise };
    let title = format!("{}: error of the source against wall time", entry.name);
    let subtitle = figures.about(options.seed);
    let head = samples[0].problem.scene().schema.heads.iter().find(|head| head.source);
    let (name, unit) = head.map_or(("source", ""), |head| (head.name, head.unit.text));
    let plot = report::plot(&figures, title, subtitle.clone(), name, unit).map_err(|error| error.to_string())?;
    let files = [("frontier.csv", report::csv(&figures, unit).into()), ("frontier.svg", plot.svg().into())];
    out.write(&files).map_err(|error| error.to_string())?;
    crate::print(&report::table(&figures, &subtitle, name, unit, &options.budgets))?;
    Ok(ExitCode::SUCCESS)
}

/// Everything to be tried, in the order of the table.
fn trials(options: &Options) -> Vec<Trial> {
    let mut trials = Vec::new();
    for optimizer in options.optimizers.iter().filter_map(|name| Optimizer::from_name(name)) {
        for precision in &options.precisions {
            let precision = if precision == "f32" { Width::F32 } else { Width::F64 };
            for &width in &options.widths {
                let threads = options.threads.unwrap_or_else(crate::solve::processors);
                trials.push(Trial { optimizer, precision, width, threads, seed: options.seed });
            }
        }
    }
    let single = |trial: &Trial| matches!(trial.optimizer, Optimizer::Auto | Optimizer::Adam | Optimizer::Lbfgs);
    trials.retain(|trial| trial.precision == Width::F64 || single(trial));
    trials
}

/// Fresh copies of the truths, bound to the scene.
fn samples(entry: &Entry, options: &Options) -> Result<Vec<Prepared>, String> {
    let request = Request { scene: options.scene.clone(), ..Request::default() };
    let series = entry
        .series()
        .ok_or_else(|| format!("`{}` has no measurements over time to make noisy copies of", entry.name))?;
    let copies = series.copies(entry, &request, &options.repository, options.noise, options.seed, options.runs);
    copies.map_err(|error| match error {
        PrepareError::Data(error) => {
            format!("{error}; the frontier needs the repository's data: name its folder with --repository")
        }
        error => error.to_string(),
    })
}
