//! Whole Adam steps of the paper's scenes at the paper's sizes and their share of the machine's peak, iterations of
//! Levenberg-Marquardt, and cost and memory against the number of points.
//!
//! `cargo bench --bench step`, or parts of it: `cargo bench --bench step -- table`, `... marquardt`, `... scale`. Words after
//! `table` pick its rows: `... table membrane f32 avx512`

mod allocated;
mod scenes;
#[path = "../support/mod.rs"]
mod support;

use std::time::{Duration, Instant};

use allocated::{allocated, peak_since};
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

fn scenes() -> [Scene; 5] {
    [
        Scene { name: "pendulum", problem: scenes::pendulum(), layers: 3, points: &[800, 1000] },
        Scene { name: "membrane", problem: scenes::membrane(), layers: 4, points: &[3000, 200] },
        Scene {
            name: "membrane without its cloud",
            problem: scenes::membrane_equations(3000),
            layers: 4,
            points: &[3000, 200],
        },
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

/// Seconds of processor time that this process has used, or NaN where the system does not say.
fn processor_seconds() -> f64 {
    /// Linux counts in hundredths of a second, whatever the kernel's own clock.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The fields after the name of the command: user and system time are the 12th and 13th.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11);
    let ticks: Vec<f64> = fields.take(2).filter_map(|field| field.parse().ok()).collect();
    if ticks.len() == 2 { (ticks[0] + ticks[1]) / TICKS } else { f64::NAN }
}

/// Seconds of a call over about two seconds: the shortest by the clock, and the mean of processor time.
fn timed(mut work: impl FnMut()) -> [f64; 2] {
    let (begin, mut calls) = (processor_seconds(), 0);
    let wall = best(Duration::from_secs(2), || {
        work();
        calls += 1;
    });
    [wall, (processor_seconds() - begin) / f64::from(calls)]
}

/// Milliseconds of a step and the share of the peak that its matrix products are, by the clock and by processor time.
/// The second is what a machine would show that runs nothing else.
fn row<E: Precision>(scene: &Scene, isa: Isa, width: usize, threads: usize) {
    let entries = [scene.name, &width.to_string(), E::NAME, isa.name()];
    let mut words = std::env::args().skip_while(|word| word != "table").skip(1).filter(|word| !word.starts_with('-'));
    if words.any(|word| !entries.contains(&word.as_str())) {
        return;
    }
    let architecture = Architecture::modified(width, scene.layers);
    let [wall, processor] = timed(adam::<E>(&scene.problem, isa, architecture));
    let processor = processor / threads as f64;
    let peak = fma_peak::<E>(isa, threads);
    let operations = product_operations(&scene.problem, scene.points, architecture);
    let share = |seconds: f64| operations / seconds / peak;
    let (name, precision, isa) = (scene.name, E::NAME, isa.name());
    let (wall_ms, wall_share, ms, share) = (wall * 1e3, share(wall), processor * 1e3, share(processor));
    println!("| {name} | {width} | {precision} | {isa} | {wall_ms:.2} | {wall_share:.2} | {ms:.2} | {share:.2} |");
}

fn table(threads: usize) {
    println!("\n| scene | width | precision | vectors | ms a step (best) | share | processor ms / {threads} | share |");
    println!("|---|---|---|---|---|---|---|---|");
    for scene in scenes() {
        for (at, isa) in Isa::available().filter(|&isa| isa != Isa::SCALAR).enumerate() {
            let widths: &[usize] = if at == 0 { &[256, 128, 64] } else { &[256] };
            for &width in widths {
                row::<f32>(&scene, isa, width, threads);
                row::<f64>(&scene, isa, width, threads);
            }
        }
    }
}

/// Iterations of Levenberg-Marquardt on the membrane with 1500 points, three equations and four conditions, width 32, four
/// layers.
fn marquardt() {
    let problem = scenes::membrane_equations(1300);
    let mut engine = problem.engine::<f64>(Isa::detect(), Architecture::modified(32, 4)).expect("a bound problem");
    let theta = initialise(engine.layout(), 1);
    let parameters = theta.len();
    let mut method = Marquardt::new(theta, WeightPrior::uniform(1e-3, parameters));
    method.step(&mut engine).expect("a finite step");
    let (mut wall, mut processor) = (f64::INFINITY, f64::INFINITY);
    // Later steps may be refused, and then reuse the normal matrix.
    for _ in 0..3 {
        let (start, begin) = (Instant::now(), processor_seconds());
        method.step(&mut engine).expect("a finite step");
        wall = wall.min(start.elapsed().as_secs_f64());
        processor = processor.min(processor_seconds() - begin);
    }
    println!("\nLevenberg-Marquardt, membrane, 1500 points, {parameters} parameters, an iteration (best of 3):");
    println!("{wall:.2} s by the clock, {processor:.2} s of processor time on all threads together");
}

/// Cost per point and memory of a membrane step, from a thousand points to a million.
fn scale() {
    println!(
        "\n| points | microseconds a point (best) | of processor time | at work at most, MB | while it is bound, MB | points \
         in them, MB |"
    );
    println!("|---|---|---|---|---|---|");
    for points in [1_000, 10_000, 100_000, 1_000_000] {
        let problem = scenes::membrane_equations(points);
        let before = allocated();
        let (mut step, binding) =
            peak_since(before, || adam::<f32>(&problem, Isa::detect(), Architecture::modified(64, 4)));
        let (seconds, working) = peak_since(before, || timed(&mut step));
        let seconds = seconds.map(|seconds| seconds * 1e6 / points as f64);
        // Network coordinates and coordinates, both in single precision.
        let own = (points * 2 * 2 * size_of::<f32>()) as f64 / 1e6;
        println!("| {points} | {:.2} | {:.2} | {working:.1} | {binding:.1} | {own:.1} |", seconds[0], seconds[1]);
    }
}

fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let part = std::env::args().find(|argument| ["table", "marquardt", "scale"].contains(&argument.as_str()));
    pool.install(|| match part.as_deref() {
        Some("table") => table(threads),
        Some("marquardt") => marquardt(),
        Some(_) => scale(),
        None => everything(threads),
    });
}

fn everything(threads: usize) {
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
}
