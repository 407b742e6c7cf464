//! The network along a straight line, as one-dimensional Taylor series: derivatives in one direction, and nothing else.

use nisp::engine::Scaling;
use nisp::network::{Kind, Layout, Matrix};

/// Highest derivative.
pub(crate) const ORDER: usize = 6;

/// Taylor coefficients in the position along the line.
type Series = [f64; ORDER + 1];

/// Derivatives of the first head by the position along the line through `x` in `direction`.
pub(crate) fn derivatives(
    layout: &Layout,
    scaling: &Scaling,
    theta: &[f64],
    x: &[f64],
    direction: &[f64],
) -> [f64; ORDER + 1] {
    let inputs: Vec<Series> = (0..x.len())
        .map(|i| {
            let mut series = [0.0; ORDER + 1];
            series[0] = (x[i] - scaling.centre[i]) / scaling.half[i];
            series[1] = direction[i] / scaling.half[i];
            series
        })
        .collect();
    let activated = |m: &Matrix, z: &[Series]| affine(m, theta, z).into_iter().map(tanh).collect::<Vec<Series>>();
    let lifted: Vec<Vec<Series>> = layout.affine.iter().map(|m| activated(m, &inputs)).collect();
    let gated = |z: Vec<Series>| match layout.architecture.kind {
        Kind::Plain => z,
        Kind::Modified => {
            let gates = lifted[1].iter().zip(&lifted[2]);
            z.iter().zip(gates).map(|(z, (c, d))| sum(&product(c, z), &product(d, &rest(z)))).collect()
        }
    };
    let last = layout.hidden.iter().fold(gated(lifted[0].clone()), |z, m| gated(activated(m, &z)));
    let mut head = affine(&layout.head, theta, &last)[0];
    head.iter_mut().for_each(|c| *c *= scaling.scale[0]);
    head[0] += scaling.offset[0];
    let mut factorial = 1.0;
    for (n, c) in head.iter_mut().enumerate() {
        factorial *= n.max(1) as f64;
        *c *= factorial;
    }
    head
}

fn affine(m: &Matrix, theta: &[f64], inputs: &[Series]) -> Vec<Series> {
    let row = |i: usize| {
        let mut series = [0.0; ORDER + 1];
        series[0] = theta[m.bias + i];
        for (j, input) in inputs.iter().enumerate() {
            let weight = theta[m.weights + i * m.columns + j];
            series.iter_mut().zip(input).for_each(|(sum, c)| *sum += weight * c);
        }
        series
    };
    (0..m.rows).map(row).collect()
}

/// From `t' = (1 - t^2) a'`, coefficient by coefficient.
fn tanh(a: Series) -> Series {
    let (mut t, mut slope) = ([0.0; ORDER + 1], [0.0; ORDER + 1]);
    t[0] = a[0].tanh();
    slope[0] = a[0].cosh().powi(-2);
    for k in 0..ORDER {
        t[k + 1] = (0..=k).map(|j| (j + 1) as f64 * a[j + 1] * slope[k - j]).sum::<f64>() / (k + 1) as f64;
        slope[k + 1] = -(0..=k + 1).map(|j| t[j] * t[k + 1 - j]).sum::<f64>();
    }
    t
}

fn product(a: &Series, b: &Series) -> Series {
    std::array::from_fn(|k| (0..=k).map(|j| a[j] * b[k - j]).sum())
}

fn sum(a: &Series, b: &Series) -> Series {
    std::array::from_fn(|k| a[k] + b[k])
}

/// `1 - z`
fn rest(z: &Series) -> Series {
    std::array::from_fn(|k| if k == 0 { 1.0 - z[0] } else { -z[k] })
}
