//! Generated rules against a generic dense jet in the same engine, and against nested dual numbers.
//!
//! `cargo bench --bench generic`

mod dense;
mod nested;
mod operators;
#[path = "../support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::Duration;

use criterion::Criterion;
use nisp::Problem;
use nisp::engine::Engine;
use nisp::network::{Architecture, initialise};
use nisp::simd::Isa;
use operators::{Operator, operators};
use support::best;

const LAYERS: usize = 3;
const BUDGET: Duration = Duration::from_millis(400);

/// An engine in double precision, and its weights.
fn warm(problem: &Problem, width: usize) -> (Engine<f64>, Vec<f64>) {
    let engine = problem.engine(Isa::detect(), Architecture::modified(width, LAYERS)).expect("a bound problem");
    let theta = initialise(engine.layout(), 1);
    (engine, theta)
}

/// Seconds of the loss, and of the loss with its gradient.
fn seconds(problem: &Problem, width: usize) -> [f64; 2] {
    let (mut engine, theta) = warm(problem, width);
    let mut gradient = vec![0.0; theta.len()];
    let forward = best(BUDGET, || {
        black_box(engine.loss(&theta).expect("finite"));
    });
    let both = best(BUDGET, || {
        black_box(engine.loss_and_gradient(&theta, &mut gradient).expect("finite"));
    });
    [forward, both]
}

/// Seconds of the operator at one point by nested duals, on one thread.
fn nested_seconds(operator: &Operator, width: usize) -> f64 {
    let (engine, theta) = warm(&operator.generated, width);
    let x = [0.1, 0.2, 0.3];
    best(BUDGET, || {
        for pairs in operator.passes {
            black_box(nested::pass(engine.layout(), &theta, &x[..operator.coordinates], pairs));
        }
    })
}

fn table(points: usize, threads: usize) {
    println!(
        "\n| operator | width | channels, generated / dense | bytes a point and layer | gradient, points/s, generated | dense jet | ratio | forward, points/s, generated | dense jet | nested duals | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for operator in operators(points) {
        let channels = |problem: &Problem| problem.scene().schema.groups[0].channels.len();
        let (own, dense) = (channels(&operator.generated), channels(&operator.dense));
        for width in [32, 64, 256] {
            let rate = |seconds: f64| points as f64 / seconds;
            let [forward, gradient] = seconds(&operator.generated, width).map(rate);
            let [dense_forward, dense_gradient] = seconds(&operator.dense, width).map(rate);
            let duals = threads as f64 / nested_seconds(&operator, width);
            println!(
                "| {} | {width} | {own} / {dense} | {} / {} | {gradient:.3e} | {dense_gradient:.3e} | {:.2} | {forward:.3e} | {dense_forward:.3e} | {duals:.3e} | {:.0} |",
                operator.name,
                own * width * 8,
                dense * width * 8,
                gradient / dense_gradient,
                forward / duals,
            );
        }
    }
}

fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let points = 512;
    pool.install(|| {
        let mut criterion = Criterion::default().sample_size(20).configure_from_args();
        for operator in operators(points) {
            let mut group = criterion.benchmark_group(format!("generic/{}", operator.name));
            for (form, problem) in [("generated", &operator.generated), ("dense jet", &operator.dense)] {
                let (mut engine, theta) = warm(problem, 64);
                let mut gradient = vec![0.0; theta.len()];
                group.bench_function(form, |bencher| {
                    bencher.iter(|| black_box(engine.loss_and_gradient(&theta, &mut gradient).expect("finite")));
                });
            }
            group.finish();
        }
        criterion.final_summary();
        table(points, threads);
    });
}
