//! Gradients in single precision point where those in double precision do.

use nisp::network::Architecture;

use crate::promotion;
use crate::row::{Extent, Row};
use nisp_references::each_model;
use nisp_references::reference::{Model, Reference, architectures, engine};

/// One minus the cosine between the gradients at the same weights, from the difference of the unit vectors, so that it is not
/// lost in rounding.
fn off_direction<M: Model>(model: &M, architecture: Architecture) -> f64 {
    let reference = Reference::new(model, architecture);
    let single: Vec<f32> = reference.theta(13).iter().map(|&x| x as f32).collect();
    let double: Vec<f64> = single.iter().map(|&x| f64::from(x)).collect();
    let (mut g, mut h) = (vec![0.0_f64; double.len()], vec![0.0_f32; double.len()]);
    let exact = engine::<f64>(&reference.problem, architecture).loss_and_gradient(&double, &mut g);
    let rounded = engine::<f32>(&reference.problem, architecture).loss_and_gradient(&single, &mut h);
    if exact.is_err() || rounded.is_err() {
        return f64::NAN;
    }
    let h: Vec<f64> = h.into_iter().map(f64::from).collect();
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (g_norm, h_norm) = (norm(&g), norm(&h));
    let apart: Vec<f64> = g.iter().zip(&h).map(|(g, h)| g / g_norm - h / h_norm).collect();
    norm(&apart).powi(2) / 2.0
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let networks = match extent {
        Extent::Fast => vec![Architecture::modified(16, 3)],
        Extent::Full => {
            architectures().into_iter().chain([Architecture::modified(64, 4), Architecture::modified(256, 4)]).collect()
        }
    };
    let mut rows = Vec::new();
    macro_rules! one {
        ($model:expr) => {{
            let found: Vec<f64> = networks.iter().map(|&network| off_direction($model, network)).collect();
            let worst = if found.iter().any(|x| x.is_nan()) { f64::NAN } else { found.into_iter().fold(0.0, f64::max) };
            let what = format!("1 - cosine of the gradients, `{}`", $model.scene().schema.module);
            rows.push(Row::new(what, format!("{} networks", networks.len()), worst, 1e-8));
        }};
    }
    each_model!(one!);
    rows.extend(promotion::rows(extent));
    rows
}
