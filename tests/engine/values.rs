//! Rows and losses against the reference.

use nisp::Precision;
use nisp::network::{Activation, Architecture};

use nisp_references::each_model;
use nisp_references::models::{Heat, Karman, Triharmonic};
use nisp_references::reference::{Model, Reference, architectures, engine};

/// What rounding to single precision may come to in this network, given what it may in one of tanh: sines hand it on at full
/// slope, layer after layer.
pub(crate) fn in_single_precision(architecture: Architecture, tanh: f64) -> f64 {
    match architecture.activation {
        Activation::Tanh => tanh,
        Activation::Sine => 4.0 * tanh,
    }
}

/// Largest distance of the engine's rows from the reference, over the largest row of their kind.
fn distance<E: Precision, M: Model>(model: &M, architecture: Architecture) -> f64 {
    let reference = Reference::new(model, architecture);
    far::<E, M>(model, architecture, &reference, &reference.theta(3))
}

/// The same at these parameters.
fn far<E: Precision, M: Model>(
    model: &M,
    architecture: Architecture,
    reference: &Reference<'_, M>,
    theta: &[f64],
) -> f64 {
    let rounded: Vec<E> = theta.iter().map(|&x| E::from_f64(x)).collect();
    let mut engine = engine::<E>(&reference.problem, architecture);
    let mut worst = 0.0_f64;
    for (at, data) in model.groups().iter().enumerate() {
        let expected = reference.rows(theta, data);
        let found = engine.raw_rows(at, &rounded);
        for row in 0..expected[0].len() {
            let largest = expected.iter().map(|rows| rows[row].abs()).fold(0.0, f64::max);
            for (p, rows) in expected.iter().enumerate() {
                worst = worst.max((rows[row] - found[row * expected.len() + p]).abs() / largest);
            }
        }
    }
    worst
}

fn rows_agree<M: Model>(model: &M) {
    for architecture in architectures() {
        let error = distance::<f64, M>(model, architecture);
        assert!(error <= 1e-12, "{} {architecture:?}: {error:e}", model.scene().schema.module);
    }
}

#[test]
fn rows_are_those_of_dense_jets() {
    each_model!(rows_agree);
}

#[test]
fn single_precision_rows_are_those_of_dense_jets() {
    for architecture in architectures().into_iter().filter(|a| a.layers >= 2) {
        let errors = [distance::<f32, _>(&Karman, architecture), distance::<f32, _>(&Heat, architecture)];
        assert!(
            errors.iter().all(|&error| error <= in_single_precision(architecture, 2e-6)),
            "{architecture:?}: {errors:?}"
        );
        let error = distance::<f32, _>(&Triharmonic, architecture);
        assert!(error <= in_single_precision(architecture, 1e-5), "{architecture:?}: {error:e}");
    }
}

fn saturates(a: &Architecture) -> bool {
    a.layers >= 4 && !a.factorised && a.activation == Activation::Tanh
}

/// Saturated layers multiply what their values lose to rounding: with values in single precision these networks are off by
/// 7e-5 to 1.4e-4.
#[test]
fn sixth_derivatives_in_single_precision_survive_saturated_layers() {
    for architecture in architectures().into_iter().filter(saturates) {
        let reference = Reference::new(&Triharmonic, architecture);
        let mut theta = reference.theta(3);
        for m in reference.layout.matrices() {
            theta[m.weights..m.weights + m.rows * m.columns].iter_mut().for_each(|w| *w *= 8.0);
        }
        let rounded: Vec<f32> = theta.iter().map(|&x| x as f32).collect();
        let theta: Vec<f64> = rounded.iter().map(|&x| x.into()).collect();
        let error = far::<f32, _>(&Triharmonic, architecture, &reference, &theta);
        assert!(error <= 3e-5, "{architecture:?}: {error:e}");
    }
}

fn loss_agrees<M: Model>(model: &M) {
    for architecture in architectures() {
        let reference = Reference::new(model, architecture);
        let theta = reference.theta(5);
        let expected = reference.loss(&theta);
        let found = engine::<f64>(&reference.problem, architecture).loss(&theta).expect("a finite loss");
        let error = (found - expected).abs() / expected;
        assert!(error <= 1e-12, "{} {architecture:?}: {error:e}", model.scene().schema.module);
    }
}

#[test]
fn losses_are_those_of_their_definition() {
    each_model!(loss_agrees);
}
