//! Clouds and complementarities: what a scene of contact needs beyond its equations.

use nisp::network::Architecture;
use nisp::solve::objective::{LeastSquares, Objective};
use nisp::{Points, Problem, scene};

use crate::reference::engine;

nisp::pde! {
    mod sheet {
        units: off;
        coordinates: a, b;
        fields: w;
        on patch { cloud: plane chamfer [a, b, w]; }
        on same { known: w == 3 + a / 2; }
        scene fit { }
    }
}

nisp::pde! {
    mod slope {
        units: off;
        coordinates: x;
        fields: w;
        on line { cloud: chamfer [x, w]; }
        scene fit { }
    }
}

nisp::pde! {
    mod stop {
        units: off;
        coordinates: x;
        fields: u;
        sources: f >= 0;
        parameters: k = 1;
        on inside { balance: k * laplacian(u) == f; contact: 0 <= f _|_ u >= 0; observe u; }
        scene solve { }
    }
}

fn small() -> Architecture {
    Architecture::plain(5, 1)
}

/// A network that is the same everywhere: all weights zero but the head's bias.
fn constant(engine: &nisp::engine::Engine<f64>, head: f64) -> Vec<f64> {
    let layout = engine.layout();
    let mut theta = vec![0.0; layout.len];
    theta[layout.head.bias] = head;
    theta
}

fn grid() -> Vec<f64> {
    (0..8).flat_map(|i| (0..8).flat_map(move |j| [f64::from(i), f64::from(j)])).collect()
}

/// A cloud above a level sheet, half-way between its points: only the height counts.
#[test]
fn to_the_plane_only_the_distance_across_counts() {
    let cloud: Vec<f64> = grid().chunks_exact(2).flat_map(|p| [p[0] + 0.4, p[1] - 0.4, 3.25]).collect();
    let mut problem = Problem::new(scene::<sheet::fit::Scene>());
    problem.set_group("patch", grid().into(), vec![]).unwrap();
    problem.set_group("same", grid().into(), vec![]).unwrap();
    problem.set_cloud("patch", "cloud", cloud).unwrap();
    let mut engine = engine::<f64>(&problem, small());
    let theta = constant(&engine, 0.0);
    let level = engine.raw_rows(0, &theta)[2 * 64];
    let mut rows = vec![0.0; engine.rows()];
    engine.residuals(&theta, &mut rows).unwrap();
    let block = &engine.blocks()[0];
    // The mean square of 64 heights, over the natural size.
    let height = (3.25 - level) / block.sigma;
    let found: f64 = rows[block.rows.clone()].iter().map(|r| r * r).sum();
    assert!((found - height * height).abs() <= 1e-12 * found, "{found} {height}");
    assert_eq!(block.count, 64.0);
}

/// Assignments are frozen until a step is accepted, and found again by looking at every point.
#[test]
fn assignments_follow_accepted_steps() {
    let x: Vec<f64> = (0..40).map(|i| f64::from(i) / 40.0).collect();
    let cloud: Vec<f64> = (0..60).flat_map(|i| [(f64::from(i) * 0.618).fract(), (f64::from(i) * 0.37).sin()]).collect();
    let mut problem = Problem::new(scene::<slope::fit::Scene>());
    problem.set_group("line", x.clone().into(), vec![]).unwrap();
    problem.set_cloud("line", "cloud", cloud.clone()).unwrap();
    let mut engine = engine::<f64>(&problem, small());
    let size = engine.blocks()[0].sigma;
    let theta = |step: usize, len: usize| -> Vec<f64> {
        (0..len).map(|i| ((i * 7 + 3) as f64).sin() + 0.03 * step as f64 * (i as f64).cos()).collect()
    };
    let len = engine.parameters();
    for step in 0..12 {
        let now = theta(step, len);
        let before = engine.loss(&now).unwrap();
        let changed = engine.accepted(&now);
        let after = engine.loss(&now).unwrap();
        assert_eq!(changed, before != after, "step {step}");
        let rows = engine.raw_rows(0, &now);
        let nearest = |y: &[f64]| -> f64 {
            let squares = (0..40).map(|p| (rows[p] - y[0]).powi(2) + (rows[40 + p] - y[1]).powi(2));
            squares.fold(f64::INFINITY, f64::min)
        };
        let expected = cloud.chunks_exact(2).map(nearest).sum::<f64>() / 60.0 / (size * size) / 2.0;
        assert!((after - expected).abs() <= 1e-12 * expected, "step {step}: {after} {expected}");
        assert!(!engine.accepted(&now), "nothing has moved");
    }
}

/// Loss of a contact whose pressure is `k` times as large.
fn pressed(k: f64) -> f64 {
    let x: Vec<f64> = (0..50).map(|i| f64::from(i) / 25.0 - 1.0).collect();
    let u: Vec<f64> = x.iter().map(|x| 1e-3 * x * x).collect();
    let mut problem = Problem::new(scene::<stop::solve::Scene>());
    problem.set_parameter("k", k).unwrap();
    problem.set_group("inside", x.into(), vec![u]).unwrap();
    let mut engine = engine::<f64>(&problem, small());
    let theta: Vec<f64> = (0..engine.parameters()).map(|i| (i as f64 * 1.7).sin()).collect();
    engine.loss(&theta).unwrap()
}

#[test]
fn a_complementarity_is_judged_alike_whatever_the_size_of_its_sides() {
    let expected = pressed(1.0);
    for k in [1e-9, 1e-3, 1e6, 1e12] {
        let found = pressed(k);
        assert!((found - expected).abs() <= 1e-9 * expected, "{k}: {found} {expected}");
    }
}

#[test]
fn what_is_bound_to_a_cloud_is_checked() {
    let bound = |cloud: Vec<f64>| {
        let mut problem = Problem::new(scene::<slope::fit::Scene>());
        let points = Points::from(vec![0.0, 0.5, 1.0]);
        problem.set_group("line", points, vec![]).unwrap();
        problem.set_cloud("line", "cloud", cloud).unwrap();
        problem.engine::<f64>(nisp::simd::Isa::detect(), small()).map(|_| ()).unwrap_err().to_string()
    };
    assert!(bound(vec![]).contains("`cloud` has no cloud"), "{}", bound(vec![]));
    assert!(bound(vec![1.0, 2.0, 3.0]).contains("3 numbers where 4"), "{}", bound(vec![1.0, 2.0, 3.0]));
    assert!(bound(vec![1.0, 2.0, f64::NAN, 3.0]).contains("not finite at point 1"));
}
