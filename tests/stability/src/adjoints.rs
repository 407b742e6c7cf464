//! Adjoints against tangents, gradients against complex steps.

use nisp::network::Architecture;
use num_complex::Complex64;

use crate::row::{Extent, Row};
use nisp_references::adjoint::dot_product_error;
use nisp_references::each_model;
use nisp_references::reference::{Model, Reference, architectures, engine};
use nisp_references::tangents::STEP;

/// Difference of the gradient along a direction and the complex step, over the magnitudes that make it up.
fn complex_step_error<M: Model>(model: &M, architecture: Architecture) -> f64 {
    let reference = Reference::new(model, architecture);
    let theta = reference.theta(7);
    let direction: Vec<f64> = (0..theta.len()).map(|i| (i as f64 * 1.1 + 0.4).sin()).collect();
    let mut gradient = vec![0.0; theta.len()];
    let mut engine = engine::<f64>(&reference.problem, architecture);
    if engine.loss_and_gradient(&theta, &mut gradient).is_err() {
        return f64::NAN;
    }
    let moved: Vec<Complex64> = theta.iter().zip(&direction).map(|(&re, d)| Complex64::new(re, STEP * d)).collect();
    let expected = reference.loss(&moved).im / STEP;
    let products = gradient.iter().zip(&direction).map(|(g, d)| g * d);
    (products.clone().sum::<f64>() - expected).abs() / products.map(f64::abs).sum::<f64>()
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    let networks = match extent {
        Extent::Fast => vec![Architecture::modified(8, 2)],
        Extent::Full => architectures().into_iter().chain([Architecture::modified(64, 3)]).collect(),
    };
    let mut check = |module: &str, dot_product: f64, steps: Vec<f64>| {
        rows.push(Row::new(format!("u.(Jv) = (J'u).v, `{module}`"), "2 networks, each term", dot_product, 1e-13));
        let worst = steps.iter().copied().fold(0.0, f64::max);
        let worst = if steps.iter().any(|x| x.is_nan()) { f64::NAN } else { worst };
        rows.push(Row::new(
            format!("gradient against complex steps, `{module}`"),
            steps.len().to_string(),
            worst,
            1e-12,
        ));
    };
    macro_rules! both {
        ($model:expr) => {{
            let steps = networks.iter().map(|&network| complex_step_error($model, network)).collect();
            check($model.scene().schema.module, dot_product_error($model), steps);
        }};
    }
    each_model!(both!);
    rows
}
