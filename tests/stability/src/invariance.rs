//! Isotropic operators do not see how the axes lie, and harmonic functions have no biharmonic.

#![allow(deprecated, reason = "the scenes are evaluated and not solved, so that nothing need pin their field")]

use nisp::network::Architecture;
use nisp::{Points, Problem, scene};

use crate::row::{Extent, Row};
use nisp_references::reference::engine;

nisp::pde! {
    mod isotropic {
        units: off;
        coordinates: x, y;
        fields: u;
        on frame { held: u == 0; }
        on inside {
            second: laplacian(u) == 0;
            steep: dot(grad(u), grad(u)) == 0;
            fourth: biharmonic(u) == 0;
            sixth: laplacian(biharmonic(u)) == 0;
        }
        scene all { }
    }
}

nisp::pde! {
    mod harmonic {
        units: off;
        coordinates: x, y;
        fields: u;
        on inside {
            wave: biharmonic(u * exp(x) * cos(y)) == 0;
            saddle: biharmonic(u * (x^4 - 6 * x^2 * y^2 + y^4)) == 0;
            well: biharmonic(u * ln(x^2 + y^2)) == 0;
        }
        scene all { }
    }
}

/// The frame fixes the scaling of coordinates, wherever the points are.
const FRAME: [f64; 8] = [-2.0, -2.0, 2.0, -2.0, 2.0, 2.0, -2.0, 2.0];

/// Rows of the isotropic scene at points, whose frame is moved by `shift`.
fn isotropic_rows(points: &[f64], shift: f64, architecture: Architecture, theta: impl Fn(&mut Vec<f64>)) -> Vec<f64> {
    let mut problem = Problem::new(scene::<isotropic::all::Scene>());
    let moved = |x: &[f64]| -> Points { x.iter().map(|x| x + shift).collect::<Vec<f64>>().into() };
    let bound = problem
        .set_group("frame", moved(&FRAME), Vec::new())
        .and_then(|()| problem.set_group("inside", moved(points), Vec::new()));
    bound.expect("groups of the scene");
    let mut engine = engine::<f64>(&problem, architecture);
    let mut weights: Vec<f64> = nisp::network::initialise(engine.layout(), 5);
    weights.iter_mut().enumerate().for_each(|(i, w)| *w += 0.1 * (i as f64 * 0.9).sin());
    theta(&mut weights);
    engine.raw_rows(1, &weights)
}

/// The largest difference, over the largest value of each of `kinds` rows.
fn difference(a: &[f64], b: &[f64], kinds: usize) -> f64 {
    let count = a.len() / kinds;
    let of = |(a, b): (&[f64], &[f64])| {
        let size = a.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
    };
    a.chunks(count).zip(b.chunks(count)).map(of).fold(0.0, f64::max)
}

/// Points of a disc, with twenty binary digits each, so that shifts by whole numbers are exact.
fn disc(count: usize) -> Vec<f64> {
    let point = |i: usize| {
        let (r, angle) = (1.4 * ((i as f64 + 0.5) / count as f64).sqrt(), i as f64 * 2.399_963_229_728_653);
        [r * angle.cos(), r * angle.sin()].map(|x: f64| (x * 1048576.0).round() / 1048576.0)
    };
    (0..count).flat_map(point).collect()
}

/// Turns pairs by an angle.
fn turned(pairs: &[f64], angle: f64) -> Vec<f64> {
    let (sin, cos) = angle.sin_cos();
    pairs.chunks_exact(2).flat_map(|p| [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]).collect()
}

fn rotation_error(architecture: Architecture, count: usize, angle: f64) -> f64 {
    let points = disc(count);
    let layout = {
        let mut problem = Problem::new(scene::<isotropic::all::Scene>());
        let bound = problem
            .set_group("frame", FRAME.to_vec().into(), Vec::new())
            .and_then(|()| problem.set_group("inside", points.clone().into(), Vec::new()));
        bound.expect("groups of the scene");
        engine::<f64>(&problem, architecture).layout().clone()
    };
    let here = isotropic_rows(&points, 0.0, architecture, |_| {});
    // The network that sees turned points as this one sees them unturned.
    let there = isotropic_rows(&turned(&points, angle), 0.0, architecture, |theta| {
        for m in &layout.affine {
            let weights = &mut theta[m.weights..m.weights + 2 * m.rows];
            let new = turned(weights, angle);
            weights.copy_from_slice(&new);
        }
    });
    difference(&here, &there, 4)
}

/// Rows of products of a harmonic function with a network that is constant, over the largest of their parts.
fn harmonic_error(count: usize) -> f64 {
    let mut problem = Problem::new(scene::<harmonic::all::Scene>());
    // Away from the singular point of the logarithm.
    let points: Vec<f64> = disc(count).chunks_exact(2).flat_map(|p| [p[0] + 2.0, p[1]]).collect();
    problem.set_group("inside", points.clone().into(), Vec::new()).expect("a group of the scene");
    let architecture = Architecture::modified(8, 2);
    let mut engine = engine::<f64>(&problem, architecture);
    let mut theta = nisp::network::initialise(engine.layout(), 1);
    let head = engine.layout().head.clone();
    theta[head.weights..head.weights + head.columns].fill(0.0);
    theta[head.bias] = 1.0;
    let rows = engine.raw_rows(0, &theta);
    let scaling = problem.scaling(architecture.inputs).expect("a bound problem");
    let u = (scaling.scale[0] + scaling.offset[0]).abs();
    // The fourth derivative by x of each function.
    let sizes: [fn(f64, f64) -> f64; 3] =
        [|x, y| (x.exp() * y.cos()).abs(), |_, _| 24.0, |x, y| 12.0 / (x * x + y * y).powi(2)];
    let of = |(kind, size): (usize, &fn(f64, f64) -> f64)| {
        let rows = &rows[kind * count..(kind + 1) * count];
        let largest = points.chunks_exact(2).map(|p| size(p[0], p[1])).fold(0.0, f64::max);
        rows.iter().map(|row| row.abs()).fold(0.0, f64::max) / (u * largest)
    };
    sizes.iter().enumerate().map(of).fold(0.0, f64::max)
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let count = extent.pick(20, 200);
    let networks = match extent {
        Extent::Fast => vec![Architecture::modified(12, 3)],
        Extent::Full => vec![Architecture::modified(12, 3), Architecture::plain(64, 5), Architecture::modified(128, 4)],
    };
    let worst = |of: &dyn Fn(Architecture) -> f64| networks.iter().map(|&a| of(a)).fold(0.0, f64::max);
    let angles = [0.1, 0.5, 1.3, 2.9];
    let rotation = worst(&|a| angles.iter().map(|&angle| rotation_error(a, count, angle)).fold(0.0, f64::max));
    let shifts = [16.0, -1024.0, 1048576.0];
    let translation = worst(&|a| {
        let here = isotropic_rows(&disc(count), 0.0, a, |_| {});
        let there = |shift: f64| isotropic_rows(&disc(count), shift, a, |_| {});
        shifts.iter().map(|&shift| difference(&here, &there(shift), 4)).fold(0.0, f64::max)
    });
    let samples = |of: &str| format!("{} networks, {count} points, {of}", networks.len());
    vec![
        Row::new("rotation: |grad|^2 and Laplacians to the third", samples("4 angles"), rotation, 1e-12),
        Row::new("translation, likewise", samples("16 to 1e6 lengths"), translation, 1e-12),
        Row::new(
            "biharmonic of 3 harmonic functions times a constant network",
            format!("{count} points"),
            harmonic_error(count),
            1e-13,
        ),
    ]
}
