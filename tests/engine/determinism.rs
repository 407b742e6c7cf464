//! The same bits on any number of threads; the same numbers to rounding on any instruction set.

use nisp::network::Architecture;
use nisp::simd::Isa;
use nisp::{Precision, Problem};

use nisp_references::each_model;
use nisp_references::models::{Heat, Karman, Sponge, Triharmonic};
use nisp_references::reference::{Model, Reference};

/// Loss and gradient on `threads` threads.
fn evaluate<E: Precision>(
    problem: &Problem,
    architecture: Architecture,
    isa: Isa,
    threads: usize,
    theta: &[f64],
) -> (f64, Vec<E>) {
    let theta: Vec<E> = theta.iter().map(|&x| E::from_f64(x)).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut engine = problem.engine::<E>(isa, architecture).expect("a bound problem");
        let mut gradient = vec![E::ZERO; theta.len()];
        let loss = engine.loss_and_gradient(&theta, &mut gradient).expect("finite");
        (loss, gradient)
    })
}

fn bits_are_equal<E: Precision, M: Model>(model: &M) {
    let architecture = Architecture { factorised: true, ..Architecture::modified(24, 3) };
    let reference = Reference::new(model, architecture);
    let theta = reference.theta(23);
    let isa = Isa::detect();
    let bits = |threads| {
        let (loss, gradient) = evaluate::<E>(&reference.problem, architecture, isa, threads, &theta);
        // Widening keeps every bit.
        (loss.to_bits(), gradient.into_iter().map(|g| g.to_f64().to_bits()).collect::<Vec<u64>>())
    };
    let one = bits(1);
    for threads in [2, 3, 8] {
        assert!(bits(threads) == one, "{} differs on {threads} threads", model.scene().schema.module);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    bits_are_equal::<f64, _>(&Karman);
    bits_are_equal::<f64, _>(&Sponge);
    bits_are_equal::<f64, _>(&Heat);
    bits_are_equal::<f32, _>(&Karman);
    bits_are_equal::<f32, _>(&Sponge);
    bits_are_equal::<f32, _>(&Heat);
    bits_are_equal::<f32, _>(&Triharmonic);
}

fn instruction_sets_agree<M: Model>(model: &M) {
    let architecture = Architecture::modified(20, 3);
    let reference = Reference::new(model, architecture);
    let theta = reference.theta(29);
    let evaluate_on = |isa| {
        let double = evaluate::<f64>(&reference.problem, architecture, isa, 2, &theta).1;
        let single = evaluate::<f32>(&reference.problem, architecture, isa, 2, &theta).1;
        [double, single.into_iter().map(f64::from).collect()]
    };
    let scalar = evaluate_on(Isa::SCALAR);
    for isa in Isa::available() {
        let here = evaluate_on(isa);
        for (precision, tolerance) in [(0, 1e-12), (1, 1e-5)] {
            let size = scalar[precision].iter().map(|g| g * g).sum::<f64>().sqrt();
            let differences = scalar[precision].iter().zip(&here[precision]).map(|(a, b)| (a - b) * (a - b));
            let error = differences.sum::<f64>().sqrt() / size;
            assert!(error <= tolerance, "{} {}: {error:e}", model.scene().schema.module, isa.name());
        }
    }
}

#[test]
fn every_instruction_set_gives_the_same_gradient_to_rounding() {
    each_model!(instruction_sets_agree);
}
