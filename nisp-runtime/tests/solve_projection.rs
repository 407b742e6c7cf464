//! Variable projection on problems whose solutions are known in closed form.

mod solve_common;

use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::{LeastSquares, Objective};
use nisp_runtime::solve::prior::WeightPrior;
use nisp_runtime::solve::projection::{Projection, linear_parameters};
use solve_common::rows::Rows;

/// Amplitudes and rates, in turn.
const TRUTH: [f64; 4] = [2.0, 1.5, -1.0, 0.4];

/// Two exponentials, whose amplitudes enter linearly, against exact values.
fn exponentials() -> Rows {
    Rows::new(4, 50, |i, theta, row| {
        let t = 0.1 * i as f64;
        let mut difference = 0.0;
        for k in [0, 2] {
            let e = (-theta[k + 1] * t).exp();
            (row[k], row[k + 1]) = (e, -theta[k] * t * e);
            difference += theta[k] * e - TRUTH[k] * (-TRUTH[k + 1] * t).exp();
        }
        difference
    })
}

#[test]
fn linear_parameters_are_found_by_trying() {
    let start = [1.0, 1.0, 1.0, 0.2];
    let candidates = [vec![0], vec![1], vec![2], vec![3]];
    assert_eq!(linear_parameters(&mut exponentials(), &start, &candidates).unwrap(), [0, 2]);
    // A product is linear in either factor, but not in both.
    let mut product = Rows::new(2, 5, |i, theta, row| {
        row.copy_from_slice(&[theta[1], theta[0]]);
        theta[0] * theta[1] - i as f64
    });
    assert_eq!(linear_parameters(&mut product, &[1.0, 2.0], &[vec![1], vec![0]]).unwrap(), [1]);
}

/// Steps until the loss is that of rounding.
fn steps<O: LeastSquares>(method: &mut Marquardt, objective: &mut O) -> usize {
    let small = |step: nisp_runtime::solve::method::Step| step.loss < 1e-22 || step.verdict == Verdict::Exhausted;
    (1..2000).find(|_| small(method.step(objective).unwrap())).expect("ends")
}

#[test]
fn the_amplitudes_are_solved_for_and_fewer_steps_are_taken() {
    let start = vec![1.0, 3.0, 1.0, 0.1];
    let mut whole = exponentials();
    let plain = steps(&mut Marquardt::new(start.clone(), WeightPrior::default()), &mut whole);
    let mut rows = exponentials();
    let mut projection = Projection::new(&mut rows, &[0, 2], 1e-24);
    let mut method = Marquardt::new(projection.searched(&start), WeightPrior::default());
    let projected = steps(&mut method, &mut projection);
    let phi = Method::<f64, Rows>::theta(&method).to_vec();
    for (found, truth) in projection.all(&phi).unwrap().iter().zip(TRUTH) {
        assert!((found - truth).abs() < 1e-8, "{found} {truth}");
    }
    assert!(projected < plain, "{projected} against {plain} steps");
}

#[test]
fn the_gradient_is_that_of_the_projected_loss() {
    let mut rows = exponentials();
    let mut projection = Projection::new(&mut rows, &[0, 2], 0.3);
    let phi = [1.1, 0.7];
    let (mut gradient, mut r, mut j) = ([0.0; 2], vec![0.0; 52], vec![0.0; 104]);
    projection.gradient(&phi, &mut gradient).unwrap();
    projection.jacobian(&phi, &mut r, &mut j).unwrap();
    for k in 0..2 {
        let mut at = |step: f64| {
            let mut moved = phi;
            moved[k] += step;
            projection.value(&moved).unwrap()
        };
        // Central differences of fourth order.
        let h = 1e-3;
        let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        assert!((gradient[k] - slope).abs() < 1e-9, "{} {slope}", gradient[k]);
        let by_rows: f64 = r.iter().zip(j.chunks_exact(2)).map(|(r, j)| r * j[k]).sum();
        assert!((by_rows - slope).abs() < 1e-9, "{by_rows} {slope}");
    }
}
