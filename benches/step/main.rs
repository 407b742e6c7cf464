//! Whole Adam steps of the paper's scenes at the paper's sizes and their share of the machine's peak, iterations of
//! Levenberg-Marquardt, and cost and memory against the number of points.
//!
//! `cargo bench --bench step`

mod scenes;
#[path = "../support/mod.rs"]
mod support;

use std::time::{Duration, Instant};

use criterion::Criterion;
use nisp::network::{Architecture, initialise};
use nisp::peak::fma_peak;
use nisp::simd::Isa;
use nisp::solve::adam::{Adam, AdamSettings};
use nisp::solve::marquardt::Marquardt;
use nisp::solve::method::Method;
use nisp::solve::prior::WeightPrior;
use nisp::{Precision, Problem};
use support::best;

/// A scene at the paper's size.
struct Scene {
    name: &'static str,
    problem: Problem,
    layers: usize,
    /// Points of every group.
    points: &'static [usize],
}

fn scenes() -> [Scene; 4] {
    [
        Scene { name: "pendulum", problem: scenes::pendulum(), layers: 3, points: &[800, 1000] },
        Scene { name: "membrane", problem: scenes::membrane(3000), layers: 4, points: &[3000, 200] },
        Scene { name: "softbody", problem: scenes::sponge(), layers: 4, points: &[5000, 1500, 1] },
        Scene { name: "plate", problem: scenes::plate(), layers: 4, points: &[10_000, 1000] },
    ]
}

/// An Adam step on a problem, warm.
fn adam<E: Precision>(problem: &Problem, isa: Isa, architecture: Architecture) -> impl FnMut() {
    let mut engine = problem.engine::<E>(isa, architecture).expect("a bound problem");
    let theta = initialise(engine.layout(), 1).into_iter().map(E::from_f64).collect();
    let mut method = Adam::new(theta, AdamSettings::default());
    let mut step = move || {
        method.step(&mut engine).expect("a finite step");
    };
    step();
    step
}

/// Operations of the matrix products of a step: forward, adjoint and gradient of every hidden layer, over all channels.
fn product_operations(problem: &Problem, points: &[usize], architecture: Architecture) -> f64 {
    let schema = problem.scene().schema;
    let rows: usize = schema.groups.iter().zip(points).map(|(group, points)| points * group.channels.len()).sum();
    (6 * rows * architecture.width.pow(2) * (architecture.layers - 1)) as f64
}

/// Milliseconds of a step, and the share of the peak that its matrix products are.
fn row<E: Precision>(scene: &Scene, isa: Isa, width: usize, threads: usize) {
    let architecture = Architecture::modified(width, scene.layers);
    let peak = fma_peak::<E>(isa, threads);
    let seconds = best(Duration::from_secs(2), adam::<E>(&scene.problem, isa, architecture));
    let operations = product_operations(&scene.problem, scene.points, architecture);
    let share = operations / seconds / peak;
    let (name, isa, ms) = (scene.name, isa.name(), seconds * 1e3);
    println!("| {name} | {width} | {} | {isa} | {ms:.2} | {:.0} | {share:.2} |", E::NAME, peak / 1e9);
}

fn table(threads: usize) {
    println!("\n| scene | width | precision | vectors | ms a step (best) | peak, GF/s | share of peak |");
    println!("|---|---|---|---|---|---|---|");
    for scene in scenes() {
        for isa in Isa::available().filter(|&isa| isa != Isa::SCALAR) {
            for width in [256, 128, 64] {
                row::<f32>(&scene, isa, width, threads);
                row::<f64>(&scene, isa, width, threads);
            }
        }
    }
}

/// Iterations of Levenberg-Marquardt on the membrane with 1500 points, width 32, four layers.
fn marquardt() {
    let problem = scenes::membrane(1300);
    let mut engine = problem.engine::<f64>(Isa::detect(), Architecture::modified(32, 4)).expect("a bound problem");
    let theta = initialise(engine.layout(), 1);
    let parameters = theta.len();
    let mut method = Marquardt::new(theta, WeightPrior::uniform(1e-3, parameters));
    let seconds: Vec<f64> = (0..6)
        .map(|_| {
            let start = Instant::now();
            method.step(&mut engine).expect("a finite step");
            start.elapsed().as_secs_f64()
        })
        .collect();
    // The first step warms up; refused steps after it reuse the normal matrix.
    let accepted = seconds[1..4].iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "\nLevenberg-Marquardt, membrane, 1500 points, {parameters} parameters: {accepted:.3} s an iteration (best)"
    );
}

/// Resident memory in MB.
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1e3)
}

/// Cost per point and memory of a membrane step, from a thousand points to a million.
fn scale() {
    println!(
        "\n| points | microseconds a point (best) | engine and optimizer, MB | points in them, MB |\n|---|---|---|---|"
    );
    for points in [1_000, 10_000, 100_000, 1_000_000] {
        let problem = scenes::membrane(points);
        let before = resident();
        let mut step = adam::<f32>(&problem, Isa::detect(), Architecture::modified(64, 4));
        let seconds = best(Duration::from_secs(2), &mut step);
        let memory = resident() - before;
        // Network coordinates and coordinates, both in single precision.
        let own = (points * 2 * 2 * size_of::<f32>()) as f64 / 1e6;
        println!("| {points} | {:.3} | {memory:.1} | {own:.1} |", seconds * 1e6 / points as f64);
    }
}

fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut criterion = Criterion::default().sample_size(20).configure_from_args();
        for scene in scenes() {
            let architecture = Architecture::modified(256, scene.layers);
            let mut group = criterion.benchmark_group(format!("step/{}", scene.name));
            let mut step = adam::<f32>(&scene.problem, Isa::detect(), architecture);
            group.bench_function("f32", |bencher| bencher.iter(&mut step));
            let mut step = adam::<f64>(&scene.problem, Isa::detect(), architecture);
            group.bench_function("f64", |bencher| bencher.iter(&mut step));
            group.finish();
        }
        criterion.final_summary();
        table(threads);
        marquardt();
        scale();
    });
}
