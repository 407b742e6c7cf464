//! `nisp-lab ablate`: what each part of the method is worth, beside what the paper says of its own.
//!
//! A study compares variations of one setting on the same samples; everything else stays as it is. Figures are means over
//! the samples, which are the repository's.

mod study;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use nisp::network::Architecture;
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Settings, Width, recover};
use nisp_equations::{Prepared, Request};

use crate::measure::Means;
use nisp_cli::interrupt;
use nisp_cli::options::{count, seconds, size};
use nisp_cli::terminal::progress;
use study::{Data, Study, Variation, studies};

/// What to compare, and how long.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Studies, separated by commas [default: all].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = study::names())]
    studies: Vec<String>,
    /// Samples of each study at most.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = count)]
    samples: usize,
    /// Wall time of a run with local functions, or with a network over time.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = seconds)]
    budget: f64,
    /// Wall time of a run that trains a network on a cloud, by Adam.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    network_budget: f64,
    /// Hidden units of a layer of such a network.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = size)]
    width: usize,
    /// Threads [default: one per processor].
    #[arg(long, value_name = "N", value_parser = count)]
    threads: Option<usize>,
    /// The repository, whose samples are read.
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
}

/// Runs the studies and prints a Markdown table of each as soon as it is done.
pub(crate) fn ablate(options: &Options) -> Result<ExitCode, String> {
    interrupt::listen(crate::NAME)?;
    for study in studies() {
        if options.studies.is_empty() || options.studies.iter().any(|name| name == study.name) {
            nisp_cli::terminal::print(&table(&study, options)?)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// A study's table: a row for each variation, a column for each measure, and what the paper has.
fn table(study: &Study, options: &Options) -> Result<String, String> {
    let mut text = format!("### {}\n\n", study.title);
    // Writing into a string cannot fail.
    let _ = write!(text, "{}", study.about(options.samples, options.budget, options.network_budget, options.width));
    let _ = write!(text, "\n\n| |");
    for measure in study.measures {
        let _ = write!(text, " {} |", measure.title());
    }
    let _ = writeln!(text, " seconds | paper |\n|---|---|---|{}", "---|".repeat(study.measures.len()));
    for variation in &study.variations {
        let means = means(study, variation, options)?;
        let _ = write!(text, "| {} |", variation.name);
        for (measure, mean) in study.measures.iter().zip(means.values()) {
            let _ = write!(text, " {} |", measure.shown(mean));
        }
        let _ = writeln!(text, " {:.1} | {} |", means.seconds(), variation.paper);
    }
    text.push('\n');
    Ok(text)
}

/// What a variation reaches over the samples.
fn means<'a>(study: &'a Study, variation: &Variation, options: &Options) -> Result<Means<'a>, String> {
    let samples = samples(study, variation, options)?;
    let mut means = Means::new(study.measures);
    for (at, prepared) in samples.iter().enumerate() {
        progress(&format!("{}: {}, sample {} of {}", study.name, variation.name, at + 1, samples.len()));
        let settings = settings(study, variation, prepared, options);
        let go_on = &mut |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
        let mut solution = recover(&prepared.problem, &settings, go_on).map_err(|error| error.to_string())?;
        interrupt::check()?;
        means.add(&mut solution, prepared);
    }
    Ok(means)
}

/// Settings of a variation for a sample.
fn settings(study: &Study, variation: &Variation, prepared: &Prepared, options: &Options) -> Settings {
    let settings = Settings {
        threads: options.threads.unwrap_or_else(nisp_cli::processors),
        budget: Some(Duration::from_secs_f64(options.budget)),
        ..Settings::default()
    };
    let mut settings = prepared.suited(settings);
    if study.network {
        settings.budget = Some(Duration::from_secs_f64(options.network_budget));
        settings.optimizer = Optimizer::Adam;
        settings.precision = Width::F32;
        settings.architecture = Architecture::modified(options.width, 4);
    }
    (variation.change)(&mut settings);
    settings
}

/// The samples of a study, bound as a variation wants them.
fn samples(study: &Study, variation: &Variation, options: &Options) -> Result<Vec<Prepared>, String> {
    let entry = crate::entry(study.equation)?;
    let request = Request {
        scene: variation.scene.map(Into::into),
        cloud: variation.cloud,
        network: study.network,
        parameters: study.parameters.iter().map(|&(name, value)| (name.into(), value)).collect(),
        ..Request::default()
    };
    let prepared = match &study.data {
        Data::Example => entry.prepare(&request).map(|prepared| vec![prepared]),
        Data::Copies { noise, seed } => {
            let Some(series) = entry.series() else { return Err(format!("`{}` has no tables over time", entry.name)) };
            series.copies(&entry, &request, &options.repository, *noise, *seed, options.samples)
        }
        Data::Samples { folder, names, truth } => {
            let prepare = |name: &&str| {
                let file = |ending: &str| options.repository.join(Path::new(folder)).join(format!("{name}{ending}"));
                let own = Request { sample: Some(file(".toml")), truth: Some(file(truth)), ..request.clone() };
                entry.prepare(&own)
            };
            names.iter().take(options.samples).map(prepare).collect()
        }
    };
    prepared.map_err(|error| format!("{error}; the samples are the repository's: name its folder with --repository"))
}
