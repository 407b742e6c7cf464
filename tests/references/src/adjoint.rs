//! The adjoint is the transpose of the derivative: `u . (J v) = (J^T u) . v`.

use nisp::network::Architecture;
use nisp::schema::TermKind;
use nisp::solve::objective::LeastSquares;

use crate::number::Dual;
use crate::reference::{Model, Reference, engine};

/// The largest difference of the two sides, over the magnitudes that make them up.
pub fn dot_product_error<M: Model>(model: &M) -> f64 {
    let mut worst = 0.0_f64;
    for architecture in [Architecture::modified(10, 4), Architecture::plain(12, 2)] {
        let reference = Reference::new(model, architecture);
        let theta = reference.theta(19);
        let mut engine = engine::<f64>(&reference.problem, architecture);
        // One group and one row at a time: rows before weighting are the reference's, those of square loss.
        let v: Vec<f64> = (0..theta.len()).map(|i| (i as f64 * 0.77).cos()).collect();
        let moving: Vec<Dual> = theta.iter().zip(&v).map(|(&value, &slope)| Dual { value, slope }).collect();
        let schema = model.scene().schema;
        let mut first = 0;
        let mut block = 0;
        for (data, group) in model.groups().iter().zip(schema.groups) {
            let tangents = reference.rows(&moving, data);
            for term in group.terms {
                let (size, points) = (reference.size(block, &moving), tangents.len());
                block += 1;
                match term.kind {
                    TermKind::Integral => {
                        first += term.rows;
                        continue;
                    }
                    // Its rows mix coordinates; `rows` checks them.
                    TermKind::Chamfer { .. } => {
                        first += term.rows * points + 1;
                        continue;
                    }
                    TermKind::Residual | TermKind::Observation => {}
                }
                let count = term.rows * points;
                if term.loss == nisp::schema::Loss::Square {
                    let mut u = vec![0.0; engine.rows()];
                    u[first..first + count].iter_mut().enumerate().for_each(|(i, u)| *u = (i as f64 * 0.31).sin());
                    let scale = (term.weight / points as f64).sqrt();
                    let tangent = |i: usize| (tangents[i % points][term.first + i / points] / size).slope;
                    let products = (0..count).map(|i| u[first + i] * scale * tangent(i));
                    let (forward, size): (f64, f64) = (products.clone().sum(), products.map(f64::abs).sum());
                    let mut transposed = vec![0.0; theta.len()];
                    engine.vector_jacobian(&theta, &u, &mut transposed).expect("finite");
                    let backward: f64 = transposed.iter().zip(&v).map(|(a, b)| a * b).sum();
                    let size = transposed.iter().zip(&v).map(|(a, b)| (a * b).abs()).sum::<f64>().max(size);
                    worst = worst.max((forward - backward).abs() / size);
                }
                first += count;
            }
        }
    }
    worst
}
