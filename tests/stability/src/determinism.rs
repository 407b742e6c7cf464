//! The same bits on any number of threads and after any stop (see `stopping`); the same numbers to rounding on any instruction
//! set.

use nisp::network::Architecture;
use nisp::simd::Isa;
use nisp::{Precision, Problem};

use crate::row::{Extent, Row};
use crate::stopping;
use nisp_references::each_model;
use nisp_references::reference::{Model, Reference};

/// Loss, then gradient.
fn evaluate<E: Precision>(
    problem: &Problem,
    network: Architecture,
    isa: Isa,
    threads: usize,
    theta: &[f64],
) -> Vec<f64> {
    let theta: Vec<E> = theta.iter().map(|&x| E::from_f64(x)).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut engine = problem.engine::<E>(isa, network).expect("a bound problem");
        let mut gradient = vec![E::ZERO; theta.len()];
        let loss = engine.loss_and_gradient(&theta, &mut gradient).unwrap_or(f64::NAN);
        std::iter::once(loss).chain(gradient.iter().map(|g| g.to_f64())).collect()
    })
}

fn differing(a: &[f64], b: &[f64]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
}

/// Numbers that are not the same on 2, 3 and 8 threads as on one, and of how many.
fn by_threads<E: Precision, M: Model>(model: &M, network: Architecture) -> (usize, usize) {
    let reference = Reference::new(model, network);
    let theta = reference.theta(23);
    let on = |threads| evaluate::<E>(&reference.problem, network, Isa::detect(), threads, &theta);
    let one = on(1);
    (3 * one.len(), [2, 3, 8].into_iter().map(|threads| differing(&one, &on(threads))).sum())
}

/// Distance of the gradient on an instruction set from that on another, over its length, and how many numbers differ.
fn by_isa<E: Precision, M: Model>(model: &M, network: Architecture, isas: [Isa; 2]) -> (f64, usize) {
    let reference = Reference::new(model, network);
    let theta = reference.theta(29);
    let [a, b] = isas.map(|isa| evaluate::<E>(&reference.problem, network, isa, 2, &theta));
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let apart = norm(&mut a[1..].iter().zip(&b[1..]).map(|(a, b)| a - b));
    (apart / norm(&mut a[1..].iter().copied()), differing(&a, &b))
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let networks = extent.pick(
        vec![Architecture::modified(12, 2)],
        vec![Architecture { factorised: true, ..Architecture::modified(24, 3) }, Architecture::plain(70, 4)],
    );
    let mut rows = Vec::new();
    let (mut all, mut wrong) = (0, 0);
    for &network in &networks {
        macro_rules! one {
            ($model:expr) => {
                for (count, bad) in [by_threads::<f64, _>($model, network), by_threads::<f32, _>($model, network)] {
                    all += count;
                    wrong += bad;
                }
            };
        }
        each_model!(one!);
    }
    rows.push(Row::count("1, 2, 3, 8 threads, f64 and f32: numbers of loss and gradient that differ", all, wrong));
    let best = Isa::detect();
    for isa in Isa::available().filter(|&isa| isa != best) {
        let (mut f64_worst, mut f32_worst, mut bits) = (0.0_f64, 0.0_f64, 0);
        for &network in &networks {
            macro_rules! one {
                ($model:expr) => {{
                    let (apart, differing) = by_isa::<f64, _>($model, network, [best, isa]);
                    f64_worst = f64_worst.max(apart);
                    bits += differing;
                    f32_worst = f32_worst.max(by_isa::<f32, _>($model, network, [best, isa]).0);
                }};
            }
            each_model!(one!);
        }
        let pair = format!("{} and {}", best.name(), isa.name());
        let samples = format!("{} models, {bits} numbers in f64 not the same bits", 9 * networks.len());
        rows.push(Row::new(format!("gradients on {pair}, f64"), &samples, f64_worst, 1e-12));
        rows.push(Row::new(format!("gradients on {pair}, f32"), &samples, f32_worst, 1e-5));
    }
    rows.extend(stopping::rows(extent));
    rows
}
