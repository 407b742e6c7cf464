//! Networks whose units are saturated still give finite rows, losses and gradients.

use nisp::Precision;
use nisp::network::Architecture;

use crate::row::{Extent, Row};
use nisp_references::each_model;
use nisp_references::reference::{Model, Reference, engine};

/// What of rows, loss and gradient is not finite, and of how many numbers.
fn not_finite<E: Precision, M: Model>(model: &M, architecture: Architecture, bias: f64) -> (usize, usize) {
    let reference = Reference::new(model, architecture);
    let mut theta = reference.theta(1);
    for (at, m) in reference.layout.affine.iter().chain(&reference.layout.hidden).enumerate() {
        let sign = if at % 2 == 0 { 1.0 } else { -1.0 };
        theta[m.bias..m.bias + m.rows].fill(sign * bias);
    }
    let theta: Vec<E> = theta.iter().map(|&x| E::from_f64(x)).collect();
    let mut engine = engine::<E>(&reference.problem, architecture);
    let mut numbers: Vec<f64> = (0..model.groups().len()).flat_map(|group| engine.raw_rows(group, &theta)).collect();
    let mut gradient = vec![E::ZERO; theta.len()];
    numbers.push(engine.loss_and_gradient(&theta, &mut gradient).unwrap_or(f64::NAN));
    numbers.extend(gradient.iter().map(|g| g.to_f64()));
    (numbers.iter().filter(|x| !x.is_finite()).count(), numbers.len())
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let networks = extent.pick(
        vec![Architecture::modified(8, 3)],
        vec![Architecture::modified(8, 3), Architecture::plain(32, 5), Architecture::modified(128, 4)],
    );
    let biases = [0.0, 6.0, 10.0, 20.0, 50.0];
    biases
        .into_iter()
        .map(|bias| {
            let (mut wrong, mut all) = (0, 0);
            let mut add = |(bad, count): (usize, usize)| {
                wrong += bad;
                all += count;
            };
            for &network in &networks {
                macro_rules! both {
                    ($model:expr) => {
                        add(not_finite::<f64, _>($model, network, bias));
                        add(not_finite::<f32, _>($model, network, bias));
                    };
                }
                each_model!(both!);
            }
            Row::count(format!("biases {bias} and -{bias}, f32 and f64: numbers that are not finite"), all, wrong)
        })
        .collect()
}
