//! Points drawn where equations are most off, on a problem with two sharp layers:
//! `u - eps^2 u'' = 1` with `u(-1) = u(1) = 0` has the solution `u = 1 - cosh(x / eps) / cosh(1 / eps)`.

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Problem, Resampling, Settings, recover, scene};

nisp::pde! {
    /// Reaction and diffusion.
    pub mod layer {
        units: off;
        coordinates: x;
        fields: u;
        parameters: eps;
        on line { balance: u - eps^2 * d(u, x, 2) == 1; }
        on left { held: u == 0; }
        on right { held: u == 0; }
        scene forward { }
    }
}

/// Width of the layers: far less than the distance of the points that a step sees.
const EPS: f64 = 0.01;

fn spread(count: usize) -> Vec<f64> {
    (0..count).map(|i| -1.0 + 2.0 * (i as f64 + 0.5) / count as f64).collect()
}

/// Mean error where so many points are bound.
fn error(points: usize, inputs: Inputs, resampling: Option<Resampling>) -> f64 {
    let mut problem = Problem::new(scene::<layer::forward::Scene>());
    problem.set_parameter("eps", EPS).unwrap();
    problem.set_group("line", spread(points).into(), Vec::new()).unwrap();
    problem.set_group("left", vec![-1.0].into(), Vec::new()).unwrap();
    problem.set_group("right", vec![1.0].into(), Vec::new()).unwrap();
    let settings = Settings {
        optimizer: Optimizer::Broyden,
        architecture: Architecture { inputs, ..Architecture::modified(16, 2) },
        resampling,
        budget: None,
        iterations: Some(1500),
        threads: 1,
        ..Settings::default()
    };
    let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let at = spread(2000);
    let exact = |x: f64| 1.0 - (((x - 1.0) / EPS).exp() + ((-x - 1.0) / EPS).exp()) / (1.0 + (-2.0 / EPS).exp());
    let found = &solution.evaluate(&at)[0].values;
    at.iter().zip(found).map(|(x, u)| (u - exact(*x)).abs()).sum::<f64>() / at.len() as f64
}

#[test]
fn points_that_follow_the_residual_find_the_layers() {
    let resampling = Some(Resampling { share: 0.05, ..Resampling::default() });
    let (fixed, drawn) = (error(60, Inputs::Coordinates, None), error(1200, Inputs::Coordinates, resampling));
    assert!(drawn < 0.2 * fixed, "{drawn} drawn, {fixed} fixed");
    assert!(drawn < 2e-3, "{drawn}");
}

#[test]
fn the_answer_is_the_same_every_time() {
    let resampling = Some(Resampling { share: 0.1, every: 20, ..Resampling::default() });
    assert_eq!(error(300, Inputs::Coordinates, resampling), error(300, Inputs::Coordinates, resampling));
}

#[test]
fn features_go_with_the_points_that_are_drawn() {
    let resampling = Some(Resampling { share: 0.05, ..Resampling::default() });
    let (fixed, drawn) = (error(60, Inputs::Automatic, None), error(1200, Inputs::Automatic, resampling));
    assert!(drawn < 0.2 * fixed, "{drawn} drawn, {fixed} fixed");
}
