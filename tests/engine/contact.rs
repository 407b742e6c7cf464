//! Clouds and complementarities: what a scene of contact needs beyond its equations.

use nisp::network::Architecture;
use nisp::solve::objective::LeastSquares;
use nisp::{Problem, scene};

use nisp_references::reference::engine;

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
