//! Gradients of the loss, against dual numbers through the reference and against differences of the engine itself.

use nisp::network::Architecture;

use crate::values::in_single_precision;
use nisp_references::each_model;
use nisp_references::number::Dual;
use nisp_references::reference::{Model, Reference, architectures, engine};

fn direction(len: usize, seed: usize) -> Vec<f64> {
    (0..len).map(|i| ((i * (seed + 3)) as f64 * 0.37 + seed as f64).sin()).collect()
}

/// The gradient along a direction, and the sum of the magnitudes that make it up.
fn along(gradient: &[f64], direction: &[f64]) -> (f64, f64) {
    let products = gradient.iter().zip(direction).map(|(g, d)| g * d);
    (products.clone().sum(), products.map(f64::abs).sum())
}

fn gradient_agrees<M: Model>(model: &M) {
    for architecture in architectures() {
        let reference = Reference::new(model, architecture);
        let theta = reference.theta(7);
        let mut gradient = vec![0.0; theta.len()];
        engine::<f64>(&reference.problem, architecture).loss_and_gradient(&theta, &mut gradient).expect("finite");
        for seed in 0..2 {
            let direction = direction(theta.len(), seed);
            let moving: Vec<Dual> =
                theta.iter().zip(&direction).map(|(&value, &slope)| Dual { value, slope }).collect();
            let expected = reference.loss(&moving).slope;
            let (found, size) = along(&gradient, &direction);
            let error = (found - expected).abs() / size;
            assert!(error <= 1e-12, "{} {architecture:?}: {error:e}", model.scene().schema.module);
        }
    }
}

#[test]
fn gradients_are_those_of_dual_numbers() {
    each_model!(gradient_agrees);
}

fn gradient_is_the_difference_quotient<M: Model>(model: &M) {
    let architecture = Architecture { factorised: true, ..Architecture::modified(12, 3) };
    let reference = Reference::new(model, architecture);
    let theta = reference.theta(11);
    let mut engine = engine::<f64>(&reference.problem, architecture);
    let mut gradient = vec![0.0; theta.len()];
    engine.loss_and_gradient(&theta, &mut gradient).expect("finite");
    let direction = direction(theta.len(), 4);
    let mut moved = |step: f64| {
        let theta: Vec<f64> = theta.iter().zip(&direction).map(|(t, d)| t + step * d).collect();
        engine.loss(&theta).expect("finite")
    };
    // Richardson's extrapolation of two central differences: the error is of fourth order.
    let mut quotient = |h: f64| (moved(h) - moved(-h)) / (2.0 * h);
    let expected = (4.0 * quotient(1e-4) - quotient(2e-4)) / 3.0;
    let (found, size) = along(&gradient, &direction);
    assert!((found - expected).abs() <= 1e-9 * size, "{}: {found} {expected}", model.scene().schema.module);
}

#[test]
fn gradients_are_difference_quotients() {
    each_model!(gradient_is_the_difference_quotient);
}

fn single_is_close_to_double<M: Model>(model: &M) {
    for architecture in architectures() {
        let reference = Reference::new(model, architecture);
        let theta = reference.theta(13);
        let rounded: Vec<f32> = theta.iter().map(|&x| x as f32).collect();
        let theta: Vec<f64> = rounded.iter().map(|&x| f64::from(x)).collect();
        let mut double = vec![0.0; theta.len()];
        let mut single = vec![0.0_f32; theta.len()];
        engine::<f64>(&reference.problem, architecture).loss_and_gradient(&theta, &mut double).expect("finite");
        engine::<f32>(&reference.problem, architecture).loss_and_gradient(&rounded, &mut single).expect("finite");
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let difference: Vec<f64> = double.iter().zip(&single).map(|(a, &b)| a - f64::from(b)).collect();
        let error = norm(&difference) / norm(&double);
        assert!(
            error <= in_single_precision(architecture, 5e-6),
            "{} {architecture:?}: {error:e}",
            model.scene().schema.module
        );
    }
}

#[test]
fn single_precision_gradients_are_close_to_double() {
    each_model!(single_is_close_to_double);
}
