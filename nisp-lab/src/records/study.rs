//! One record: drawn, measured, solved, and compared with its truth.

use std::time::Duration;

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, Settings, recover};
use nisp_cli::interrupt;
use serde_json::{Value, json};

use super::families::Family;
use crate::cases::Cases;
use crate::random::Random;

/// Places at which a source is compared.
const PLACES: usize = 200;
/// Points of the equations.
const POINTS: usize = 300;

/// What carries an answer.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
pub(super) enum Method {
    Auto,
    Splines,
    Network,
}

/// What came of a record.
pub(super) struct Row {
    family: &'static str,
    noise: f64,
    seed: u64,
    rows: usize,
    clustered: bool,
    status: &'static str,
    /// Checks that fail.
    failed: Vec<&'static str>,
    /// Mean error and mean magnitude of the source.
    error: f64,
    size: f64,
    /// Shares of the source beyond two and four deviations, where there are bars.
    beyond: Option<[f64; 2]>,
    steps: u64,
    wall_s: f64,
}

/// Draws a record by its seed and solves it.
pub(super) fn run(
    family: &Family,
    noise: f64,
    seed: u64,
    rows: Option<usize>,
    carrier: Method,
    cases: &Cases,
) -> Result<Row, String> {
    let mut random = Random::new(seed);
    let drawn = (16.0 * 125.0_f64.powf(random.uniform())).round() as usize;
    let clustered = random.uniform() < 0.3 && rows.is_none();
    let rows = rows.unwrap_or(drawn);
    let measured = places(&mut random, family.span, rows, clustered);
    let asked: Vec<f64> = (0..PLACES).map(|i| family.span * i as f64 / (PLACES - 1) as f64).collect();
    let mut all: Vec<f64> = measured.iter().chain(&asked).copied().collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let course = (family.draw)(&mut random, &all);
    let at = |values: &[f64], places: &[f64]| -> Vec<f64> {
        places.iter().map(|place| values[all.partition_point(|at| at < place)]).collect()
    };
    let columns = course.columns.iter().map(|column| {
        let exact = at(column, &measured);
        let sigma = if family.absolute { noise } else { noise * spread(&exact) };
        exact.into_iter().map(|value| value + sigma * random.normal()).collect()
    });
    let columns: Vec<Vec<f64>> = columns.collect();
    let mut problem = Problem::new(family.scene);
    let fault = |error: nisp::BindError| format!("{}: {error}", family.name);
    for (name, value) in &course.told {
        problem.set_parameter(name, *value).map_err(fault)?;
    }
    let law: Vec<f64> = (0..POINTS).map(|i| family.span * i as f64 / (POINTS - 1) as f64).collect();
    problem.set_group(family.law, law.into(), vec![]).map_err(fault)?;
    for (name, share) in family.conditions {
        problem.set_group(name, vec![share * family.span].into(), vec![]).map_err(fault)?;
    }
    problem.set_group(family.samples, measured.into(), columns).map_err(fault)?;
    let settings = Settings {
        carrier: match carrier {
            Method::Auto => Carrier::Auto,
            Method::Splines => Carrier::Splines,
            Method::Network => Carrier::Network,
        },
        seed: cases.seed,
        budget: Some(Duration::from_secs_f64(cases.budget)),
        threads: cases.threads(),
        ..Settings::default()
    };
    let mut watch = |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
    let mut solution = recover(&problem, &settings, &mut watch).map_err(|error| error.to_string())?;
    let estimates = solution.evaluate_with_errors(&asked);
    let found = estimates.into_iter().find(|estimate| estimate.name == family.source).ok_or("no such source")?;
    let truth = at(&course.source, &asked);
    let errors: Vec<f64> = found.values.iter().zip(&truth).map(|(found, truth)| (found - truth).abs()).collect();
    let beyond = found.deviations.map(|bars| {
        [2.0, 4.0].map(|times| {
            let outside = errors.iter().zip(&bars).filter(|(error, bar)| **error > times * **bar);
            outside.count() as f64 / errors.len() as f64
        })
    });
    let status = match solution.status {
        Status::Converged => "converged",
        Status::Budget => "budget",
        Status::NotConverged | Status::Interrupted => "not_converged",
        Status::Inconsistent => "inconsistent",
    };
    Ok(Row {
        family: family.name,
        noise,
        seed,
        rows,
        clustered,
        status,
        failed: solution.verdict.failed().map(|check| check.check).collect(),
        error: mean(&errors),
        size: mean(&truth.iter().map(|truth| truth.abs()).collect::<Vec<f64>>()),
        beyond,
        steps: solution.iterations,
        wall_s: solution.wall_s,
    })
}

/// Rising places over a span, ends included: even, or in clusters.
fn places(random: &mut Random, span: f64, count: usize, clustered: bool) -> Vec<f64> {
    let even = |i: usize| span * i as f64 / (count - 1) as f64;
    if !clustered {
        return (0..count).map(even).collect();
    }
    let centres: Vec<f64> = (0..4).map(|_| span * random.uniform()).collect();
    let mut places: Vec<f64> = (2..count)
        .map(|i| if i % 3 == 0 { span * random.uniform() } else { centres[i % 4] + 0.04 * span * random.normal() })
        .map(|at| at.clamp(1e-3 * span, 0.999 * span))
        .chain([0.0, span])
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    mean(&values.iter().map(|x| (x - middle).powi(2)).collect::<Vec<f64>>()).sqrt()
}

/// The head of the table.
pub(super) const HEAD: &str =
    "family          noise  runs  sound   share  worse  cover  worst  beyond 4 worst  steps       s\n";

/// What rows have in common: the share is the sum of the errors over that of the sources, a run is worse if its error is larger
/// than that of no source, and bars count where they are given.
pub(super) fn line(name: &str, noise: &str, rows: &[Row]) -> String {
    let sum = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>();
    // Families have sources of different sizes.
    let share = sum(&|row| row.error / row.size) / rows.len() as f64;
    let share = if name == "all" { share } else { sum(&|row| row.error) / sum(&|row| row.size) };
    let barred: Vec<[f64; 2]> = rows.iter().filter_map(|row| row.beyond).collect();
    let worse = rows.iter().filter(|row| row.error > row.size && row.beyond.is_some()).count();
    let covers: Vec<f64> = barred.iter().map(|beyond| 1.0 - beyond[0]).collect();
    let worst = covers.iter().copied().fold(1.0, f64::min);
    let four = barred.iter().map(|beyond| beyond[1]).fold(0.0, f64::max);
    let fails = barred.iter().filter(|beyond| beyond[1] > 0.2).count();
    let sound = rows.iter().filter(|row| row.status == "converged").count();
    let (steps, seconds) =
        (sum(&|row| row.steps as f64) / rows.len() as f64, sum(&|row| row.wall_s) / rows.len() as f64);
    let cover = mean(&covers);
    format!(
        "{name:14} {noise:>6} {:>5} {sound:>6} {share:>7.3} {worse:>6} {cover:>6.3} {worst:>6.2} {fails:>4} {four:>10.2} {steps:>6.0} {seconds:>7.3}\n",
        rows.len()
    )
}

impl Row {
    pub(super) fn line(&self) -> String {
        let beyond = self.beyond.map_or("no bars".into(), |[two, four]| format!("{two:.2} {four:.2}"));
        let Self { family, noise, seed, rows, clustered, status, error, size, steps, wall_s, .. } = self;
        let share = error / size;
        format!(
            "  {family} {noise} seed {seed} rows {rows} {clustered} {status} share {share:.3} beyond {beyond} steps {steps} {wall_s:.3} s\n"
        )
    }

    pub(super) fn object(&self) -> Value {
        json!({
            "family": self.family,
            "noise": self.noise,
            "seed": self.seed,
            "rows": self.rows,
            "clustered": self.clustered,
            "status": self.status,
            "failed": self.failed,
            "share": self.error / self.size,
            "beyond_two_deviations": self.beyond.map(|beyond| beyond[0]),
            "beyond_four_deviations": self.beyond.map(|beyond| beyond[1]),
            "steps": self.steps,
            "wall_s": self.wall_s,
        })
    }
}
