//! Error of the source and honesty of its error bars under noise, by what the solver is made of:
//! `cargo run --release -p nisp-equations --example noise -- SEED SECONDS RUNS [VARIANTS BEGIN WITH]`.
//!
//! Every figure is a mean over fresh noisy copies of the repository's truths, drawn with SEED and not seen when settings
//! were chosen. `cover` is the share of places where the truth lies within two standard deviations of the answer: .954
//! for bars that are right.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::{Flow, Status};
use nisp::{Optimizer, Settings, recover};
use nisp_equations::rivals::mean_abs_error;
use nisp_equations::{Prepared, Request, catalogue, yardsticks};

/// Noise on every measured quantity, in its declared unit.
const LADDER: [f64; 5] = [0.001, 0.003, 0.01, 0.03, 0.1];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (seed, seconds, runs, wanted) = match arguments.as_slice() {
        [seed, seconds, runs] => (seed, seconds, runs, ""),
        [seed, seconds, runs, wanted] => (seed, seconds, runs, wanted.as_str()),
        _ => return Err("give SEED SECONDS RUNS [VARIANTS BEGIN WITH]".into()),
    };
    let (seed, runs): (u64, usize) = (seed.parse()?, runs.parse()?);
    let budget = Duration::from_secs_f64(seconds.parse()?);
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for entry in catalogue() {
        let Some(series) = entry.series() else { continue };
        for noise in LADDER {
            let samples = series.copies(&entry, &Request::default(), &repository, noise, seed, runs)?;
            println!("\n{}, noise {noise}, copies: {}", entry.name, samples.len());
            for (name, settings, seeds) in variants(budget).into_iter().filter(|(name, ..)| name.starts_with(wanted)) {
                println!("  {name:26} {}", judge(&samples, &settings, seeds)?);
            }
            for yardstick in yardsticks(&samples) {
                println!("  {:26} error {:.2e}", yardstick.name, yardstick.error);
            }
        }
    }
    Ok(())
}

/// The default, and what becomes of it without one of its parts, or of the mean over so many seeds of initial weights.
fn variants(budget: Duration) -> Vec<(&'static str, Settings, u64)> {
    let whole = Settings { budget: Some(budget), ..Settings::default() };
    let inputs = |inputs| Architecture { inputs, ..whole.architecture };
    let size =
        |width, layers| Architecture { inputs: whole.architecture.inputs, ..Architecture::modified(width, layers) };
    vec![
        ("as it is", whole.clone(), 1),
        ("without logarithm of time", Settings { architecture: inputs(Inputs::Coordinates), ..whole.clone() }, 1),
        ("without evidence", Settings { optimizer: Optimizer::Marquardt, ..whole.clone() }, 1),
        ("half as wide", Settings { architecture: size(8, 2), ..whole.clone() }, 1),
        ("half again as wide", Settings { architecture: size(24, 2), ..whole.clone() }, 1),
        ("mean of three seeds", whole, 3),
    ]
}

/// Means over samples, as a line.
fn judge(samples: &[Prepared], settings: &Settings, seeds: u64) -> Result<String, Box<dyn Error>> {
    let (mut error, mut seconds, mut converged) = (0.0, 0.0, 0);
    let mut cover: Vec<(&'static str, f64)> = Vec::new();
    for sample in samples {
        let Some(truth) = &sample.truth else { continue };
        let mut members = Vec::new();
        for seed in 0..seeds {
            let settings = sample.suited(Settings { seed, ..settings.clone() });
            let mut solution = recover(&sample.problem, &settings, &mut |_| Flow::Continue)?;
            seconds += solution.wall_s;
            converged += usize::from(solution.status == Status::Converged);
            members.push(solution.evaluate_with_errors(&truth.points));
        }
        for (at, head) in members[0].iter().enumerate() {
            let Some(real) = truth.of(head.name) else { continue };
            let values = mean(members.iter().map(|member| &member[at].values));
            if head.source {
                error += mean_abs_error(&values, real);
            }
            let deviations = mean(members.iter().filter_map(|member| member[at].deviations.as_ref()));
            let pairs = values.iter().zip(real).zip(&deviations);
            let within = pairs.filter(|((x, real), deviation)| (*x - *real).abs() <= 2.0 * **deviation).count();
            let share = within as f64 / real.len() as f64;
            match cover.iter_mut().find(|(name, _)| *name == head.name) {
                Some((_, sum)) => *sum += share,
                None => cover.push((head.name, share)),
            }
        }
    }
    let count = samples.len() as f64;
    let cover: Vec<String> = cover.iter().map(|(name, sum)| format!("{name} {:.3}", sum / count)).collect();
    let (error, seconds) = (error / count, seconds / count);
    let all = samples.len() * seeds as usize;
    Ok(format!("error {error:.2e}  cover {}  {seconds:.1} s, {converged} of {all} converged", cover.join(", ")))
}

/// Point by point; nothing of nothing.
fn mean<'a>(members: impl Iterator<Item = &'a Vec<f64>> + Clone) -> Vec<f64> {
    let count = members.clone().count() as f64;
    let points = members.clone().map(Vec::len).min().unwrap_or(0);
    (0..points).map(|at| members.clone().map(|values| values[at]).sum::<f64>() / count).collect()
}
