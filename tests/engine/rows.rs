//! Rows and their derivatives, as second-order methods use them.

use nisp::network::{Architecture, Fourier, Inputs};
use nisp::solve::objective::LeastSquares;

use nisp_references::each_model;
use nisp_references::reference::{Model, Reference, engine};

fn rows_are_consistent<M: Model>(model: &M) {
    let name = model.scene().schema.module;
    for architecture in [
        Architecture::modified(11, 3),
        Architecture { factorised: true, ..Architecture::plain(8, 2) },
        Architecture::plain(13, 1),
        Architecture {
            inputs: Inputs::Fourier(Fourier { frequencies: 4, deviation: 0.8 }),
            ..Architecture::modified(7, 2)
        },
    ] {
        let reference = Reference::new(model, architecture);
        let theta = reference.theta(17);
        let mut engine = engine::<f64>(&reference.problem, architecture);
        let (rows, len) = (engine.rows(), theta.len());
        let (mut r, mut j, mut gradient) = (vec![0.0; rows], vec![0.0; rows * len], vec![0.0; len]);
        let half_square = engine.jacobian(&theta, &mut r, &mut j).expect("finite");
        let loss = engine.loss_and_gradient(&theta, &mut gradient).expect("finite");
        assert!((half_square - loss).abs() <= 1e-13 * loss, "{name}: {half_square} {loss}");

        // J^T r is the gradient.
        let transposed = |u: &[f64]| -> Vec<(f64, f64)> {
            (0..len)
                .map(|at| {
                    let products = (0..rows).map(|row| u[row] * j[row * len + at]);
                    (products.clone().sum(), products.map(f64::abs).sum())
                })
                .collect()
        };
        // What a row reads at both points of a pair cancels within the row, or only in the sum.
        let rounding = 1e-15 * gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        for (g, (sum, size)) in gradient.iter().zip(transposed(&r)) {
            assert!((g - sum).abs() <= 1e-12 * size + rounding, "{name} {architecture:?}: {g} {sum}");
        }

        // J^T u without forming J.
        let u: Vec<f64> = (0..rows).map(|i| (i as f64 * 0.9).cos()).collect();
        engine.vector_jacobian(&theta, &u, &mut gradient).expect("finite");
        let rounding = 1e-15 * gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        for (g, (sum, size)) in gradient.iter().zip(transposed(&u)) {
            assert!((g - sum).abs() <= 1e-12 * size + rounding, "{name} {architecture:?}: {g} {sum}");
        }

        // J v is what the rows do along v.
        let v: Vec<f64> = (0..len).map(|i| (i as f64 * 1.3).sin()).collect();
        let mut moved = |step: f64| {
            let theta: Vec<f64> = theta.iter().zip(&v).map(|(t, v)| t + step * v).collect();
            let mut rows = vec![0.0; rows];
            engine.residuals(&theta, &mut rows).expect("finite");
            rows
        };
        let h = 1e-4;
        let [near, back, far, far_back] = [h, -h, 2.0 * h, -2.0 * h].map(&mut moved);
        for row in 0..rows {
            let products = (0..len).map(|at| j[row * len + at] * v[at]);
            let (sum, size): (f64, f64) = (products.clone().sum(), products.map(f64::abs).sum());
            let expected = (8.0 * (near[row] - back[row]) - (far[row] - far_back[row])) / (12.0 * h);
            let tolerance = 1e-8 * size + 1e-10 * r[row].abs();
            assert!((sum - expected).abs() <= tolerance, "{name} {architecture:?} row {row}: {sum} {expected}");
        }
    }
}

#[test]
fn jacobian_rows_are_the_derivatives_of_the_rows() {
    each_model!(rows_are_consistent);
}
