//! How far the error bars are to be trusted, on simulated motions and voltages that are nowhere in the repository:
//! `cargo run --release -p nisp-equations --example calibrate -- SEED SECONDS RUNS`.
//!
//! The prior's part of a bar is multiplied by what depends on how noisy the data are (`nisp-runtime/src/recover/bars.rs`), so
//! that two standard deviations hold 90 to 98 per cent of the truth over the noise ladder. This prints the cover for multiples
//! of that factor: x0 is what noise alone explains, x1 are the bars as they are given.

use std::error::Error;
use std::time::Duration;

use nisp::solve::driver::Flow;
use nisp::{Settings, recover};
use nisp_data::Table;
use nisp_equations::{Entry, Request, catalogue, noisy_copy};
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// Noise on every measured quantity, in its declared unit.
const LADDER: [f64; 5] = [0.001, 0.003, 0.01, 0.03, 0.1];
/// What the prior's part is multiplied by.
const FACTORS: [f64; 6] = [0.0, 0.5, 0.75, 1.0, 1.5, 2.0];

/// A name, the scene that solves it, and rows of t, states and source, drawn anew for every seed.
type Population = (&'static str, &'static str, fn(&mut StdRng) -> Vec<Vec<f64>>);

const POPULATIONS: [Population; 3] = [
    ("pendulum under its regulator", "pendulum", |random| pendulum(random, 0.0)),
    ("circuit", "rlc", rlc),
    ("pendulum with a sine on its force besides", "pendulum", |random| pendulum(random, 3e-3)),
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [seed, seconds, runs] = arguments.as_slice() else { return Err("give SEED SECONDS RUNS".into()) };
    let (seed, runs): (u64, u64) = (seed.parse()?, runs.parse()?);
    let settings = Settings { budget: Some(Duration::from_secs_f64(seconds.parse()?)), ..Settings::default() };
    println!("share of the truth within two standard deviations, by the factor on the prior's part of the bar");
    println!("truth, noise, quantity: {}", FACTORS.map(|factor| format!("x{factor}")).join(" "));
    for (label, scene, simulate) in POPULATIONS {
        let entry = catalogue().into_iter().find(|entry| entry.name == scene).ok_or("no such scene")?;
        for noise in LADDER {
            let mut cover: Vec<(&'static str, [f64; 6])> = Vec::new();
            for run in seed..seed + runs {
                let rows = simulate(&mut StdRng::seed_from_u64(run));
                add_cover(&entry, &rows, noise, run, &settings, &mut cover)?;
            }
            for (name, sums) in cover {
                let means = sums.map(|sum| format!("{:.3}", sum / runs as f64));
                println!("{label}, {noise}, {name}: {}", means.join(" "));
            }
        }
    }
    Ok(())
}

/// Solves one noisy copy of a simulated truth and adds the shares of it that lie within the bars.
fn add_cover(
    entry: &Entry,
    rows: &[Vec<f64>],
    noise: f64,
    seed: u64,
    settings: &Settings,
    cover: &mut Vec<(&'static str, [f64; 6])>,
) -> Result<(), Box<dyn Error>> {
    let series = entry.series().ok_or("not a scene over time")?;
    let schema = entry.scene(None)?.schema;
    let mut truth = Table::empty();
    let column = |at: usize| rows.iter().map(|row| row[at]).collect::<Vec<f64>>();
    truth.push("t", "s", &column(0))?;
    for (at, head) in schema.heads.iter().enumerate() {
        truth.push(head.name, head.unit.text, &column(1 + at))?;
    }
    let mut request = Request::default();
    if entry.name == "rlc" {
        request.parameters.push(("f0".into(), rows[0][2]));
    }
    let copy = noisy_copy(&truth, schema, 4, noise, seed)?;
    let sample = series.bind(entry, &request, &copy, Some(&truth))?;
    let mut solution = recover(&sample.problem, &sample.suited(settings.clone()), &mut |_| Flow::Continue)?;
    let truth = sample.truth.as_ref().ok_or("no truth")?;
    for estimate in solution.evaluate_with_errors(&truth.points) {
        let (Some(real), Some(bars), Some(by_prior)) =
            (truth.of(estimate.name), &estimate.deviations, &estimate.by_prior)
        else {
            continue;
        };
        let share = |factor: f64| {
            let within = |i: &usize| {
                let others = bars[*i].powi(2) - by_prior[*i].powi(2);
                let bar = (others + (factor * by_prior[*i]).powi(2)).sqrt();
                (estimate.values[*i] - real[*i]).abs() <= 2.0 * bar
            };
            (0..real.len()).filter(within).count() as f64 / real.len() as f64
        };
        let shares = FACTORS.map(share);
        match cover.iter_mut().find(|(name, _)| *name == estimate.name) {
            Some((_, sums)) => sums.iter_mut().zip(shares).for_each(|(sum, share)| *sum += share),
            None => cover.push((estimate.name, shares)),
        }
    }
    Ok(())
}

/// Classical Runge-Kutta: `steps` of length `h`, with the state written before each.
fn integrate(
    mut state: Vec<f64>,
    h: f64,
    steps: usize,
    rate: impl Fn(f64, &[f64]) -> Vec<f64>,
) -> Vec<(f64, Vec<f64>)> {
    let moved = |state: &[f64], by: f64, rate: &[f64]| -> Vec<f64> {
        state.iter().zip(rate).map(|(x, dx)| x + by * dx).collect()
    };
    let mut course = Vec::with_capacity(steps);
    for step in 0..steps {
        let t = step as f64 * h;
        course.push((t, state.clone()));
        let first = rate(t, &state);
        let second = rate(t + 0.5 * h, &moved(&state, 0.5 * h, &first));
        let third = rate(t + 0.5 * h, &moved(&state, 0.5 * h, &second));
        let fourth = rate(t + h, &moved(&state, h, &third));
        for (i, x) in state.iter_mut().enumerate() {
            *x += h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }
    course
}

/// Any number between two.
fn between(random: &mut StdRng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// The double pendulum balanced by the regulator of `data/pendulum/pendulum.toml` from anywhere near upright, with a sine of
/// up to `disturbance` (N) on its force: rows of t, q, psi, phi and f at 200 Hz.
fn pendulum(random: &mut StdRng, disturbance: f64) -> Vec<Vec<f64>> {
    const GAIN: [f64; 6] =
        [0.0816496580928, 2.48160443754, -3.5552099403, 0.164279087644, 0.0625859883633, -0.603640337824];
    let start: Vec<f64> = [0.0, 0.03, 0.03, 0.0, 0.03, 0.03].iter().map(|size| between(random, -size, *size)).collect();
    let amplitude = between(random, 0.0, disturbance);
    let (frequency, phase) = (between(random, 0.3, 2.0), between(random, 0.0, std::f64::consts::TAU));
    let force = |t: f64, x: &[f64]| {
        let regulator: f64 = GAIN.iter().zip(x).map(|(gain, x)| gain * x).sum();
        amplitude * (std::f64::consts::TAU * frequency * t + phase).sin() - regulator
    };
    let rate = |t: f64, x: &[f64]| {
        let (m, l, g) = (0.005, 0.5, 9.81);
        let [psi, phi, dpsi, dphi] = [x[1], x[2], x[4], x[5]];
        // The equations of motion over m l^2, with s = q'' / l.
        let across = (psi - phi).cos();
        let right = nalgebra::Vector3::new(
            force(t, x) / (m * l) - 2.0 * dpsi * dpsi * psi.sin() - dphi * dphi * phi.sin(),
            2.0 * g / l * psi.sin() - dphi * dphi * (psi - phi).sin(),
            g / l * phi.sin() + dpsi * dpsi * (psi - phi).sin(),
        );
        #[rustfmt::skip]
        let mass = nalgebra::Matrix3::new(
            3.0, -2.0 * psi.cos(), -phi.cos(),
            -2.0 * psi.cos(), 2.0, across,
            -phi.cos(), across, 1.0,
        );
        let found = mass.lu().solve(&right).unwrap_or_default();
        vec![x[3], dpsi, dphi, l * found[0], found[1], found[2]]
    };
    let course = integrate(start, 1e-3, 4001, rate);
    course.into_iter().step_by(5).map(|(t, x)| vec![t, x[0], x[1], x[2], force(t, &x)]).collect()
}

/// The circuit driven by a decay and a sine: rows of t, v and f.
fn rlc(random: &mut StdRng) -> Vec<Vec<f64>> {
    let (size, decay) = (between(random, -6.0, 6.0), between(random, 1.0, 5.0));
    let (amplitude, pace) = (between(random, 0.0, 2.0), between(random, 2.0, 9.0));
    let phase = between(random, 0.0, std::f64::consts::TAU);
    let drive = |t: f64| size * (-decay * t).exp() + amplitude * (pace * t + phase).sin();
    let slope = |t: f64| amplitude * pace * (pace * t + phase).cos() - decay * size * (-decay * t).exp();
    let start = vec![between(random, -5.0, 5.0), between(random, -5.0, 5.0)];
    let rate = |t: f64, x: &[f64]| vec![x[1], slope(t) + 6.0 * drive(t) - 7.0 * x[1] - 10.0 * x[0]];
    let course = integrate(start, 1e-3, 2001, rate);
    course.into_iter().step_by(2).map(|(t, x)| vec![t, x[0], drive(t)]).collect()
}
