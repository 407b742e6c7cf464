//! Least-squares methods on problems whose solutions are known in closed form.

mod solve_common;

use nisp_runtime::solve::fault::Kind;
use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::LeastSquares;
use nisp_runtime::solve::prior::WeightPrior;
use solve_common::rows::{Rows, cosine, exponential};

fn flat() -> WeightPrior {
    WeightPrior::default()
}

fn theta(method: &Marquardt) -> &[f64] {
    Method::<f64, Rows>::theta(method)
}

/// Runs to the end and gives the number of steps.
fn finish(method: &mut Marquardt, rows: &mut Rows) -> usize {
    let done = |verdict: &Verdict| *verdict == Verdict::Exhausted;
    (1..500).find(|_| done(&method.step(rows).unwrap().verdict)).expect("ends")
}

#[test]
fn exponential_fit_is_exact_on_exact_data() {
    let mut method = Marquardt::new(vec![1.0, 0.1, 0.0], flat());
    let steps = finish(&mut method, &mut exponential(40));
    assert!(steps < 40, "{steps}");
    for (found, expected) in theta(&method).iter().zip([2.0, 1.5, 0.3]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn accepted_steps_never_raise_the_loss() {
    let mut rows = exponential(40);
    let mut method = Marquardt::new(vec![-5.0, 4.0, 3.0], flat());
    let mut loss = f64::INFINITY;
    for _ in 0..60 {
        let step = method.step(&mut rows).unwrap();
        if step.verdict == Verdict::Moved {
            assert!(step.loss < loss);
            loss = step.loss;
        }
    }
}

#[test]
fn fewer_rows_than_parameters_give_the_least_norm_solution() {
    // theta . cosine_k = 1 + k for 5 orthogonal rows of length 30, with a tiny prior: the solution of least norm is
    // sum_k (1 + k) cosine_k / |cosine_k|^2.
    let (len, count) = (30, 5);
    let mut rows = Rows::new(len, count, move |k, theta, row| {
        (0..len).for_each(|i| row[i] = cosine(k + 1, i, len));
        row.iter().zip(theta).map(|(j, x)| j * x).sum::<f64>() - (1.0 + k as f64)
    });
    let start = (0..len).map(|i| (i as f64).sin()).collect();
    let mut method = Marquardt::new(start, WeightPrior::uniform(1e-9, len));
    finish(&mut method, &mut rows);
    for (i, found) in theta(&method).iter().enumerate() {
        let expected: f64 = (0..count).map(|k| (1.0 + k as f64) * cosine(k + 1, i, len) / 15.0).sum();
        assert!((found - expected).abs() < 1e-6, "{i}: {found} {expected}");
    }
}

#[test]
fn both_spaces_take_the_same_step() {
    // The same rows, once alone (row space) and once with rows of zeros below them (parameter space).
    let step = |count: usize| {
        let mut rows = Rows::new(8, count, |i, theta, row| {
            row.fill(0.0);
            if i >= 6 {
                return 0.0;
            }
            (0..8).for_each(|k| row[k] = cosine(k, i, 6) + 0.3 * (i + k) as f64 * (0.1 * theta[k]).cos());
            (0..8).map(|k| cosine(k, i, 6) * theta[k] + 3.0 * (i + k) as f64 * (0.1 * theta[k]).sin()).sum::<f64>()
                - i as f64
        });
        let mut method = Marquardt::new(vec![0.5; 8], WeightPrior::uniform(0.01, 8));
        for _ in 0..3 {
            method.step(&mut rows).unwrap();
        }
        theta(&method).to_vec()
    };
    for (a, b) in step(6).iter().zip(step(20)) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}

#[test]
fn a_fault_in_a_trial_is_refused_bitwise_and_overcome() {
    let mut rows = exponential(40);
    let mut method = Marquardt::new(vec![1.0, 0.1, 0.0], flat());
    while method.step(&mut rows).unwrap().verdict != Verdict::Moved {}
    let (before, damping) = (theta(&method).to_vec(), method.damping());
    // The next two calls are the derivatives at theta and the trial.
    rows.faulty = vec![rows.calls + 2];
    let step = method.step(&mut rows).unwrap();
    let Verdict::Faulty(fault) = step.verdict else { panic!("{step:?}") };
    assert_eq!((fault.term.as_str(), fault.point, fault.what), ("balance", Some(17), Kind::Residual));
    assert_eq!(theta(&method), before);
    assert!(method.damping() > damping);
    assert!((0..5).any(|_| method.step(&mut rows).unwrap().verdict == Verdict::Moved));
    finish(&mut method, &mut rows);
    assert!((theta(&method)[1] - 1.5).abs() < 1e-12);
}

#[test]
fn a_lasting_fault_stops_cleanly_and_names_the_term() {
    let mut rows = exponential(40);
    rows.faulty = (3..100).collect();
    let mut method = Marquardt::new(vec![1.0, 0.1, 0.0], flat());
    method.step(&mut rows).unwrap();
    let before = theta(&method).to_vec();
    let fault = (0..5).find_map(|_| method.step(&mut rows).err()).expect("stops within five steps");
    assert_eq!(theta(&method), before);
    let message = fault.to_string();
    assert!(message.starts_with("balance at point 17: the residual is not finite; check"), "{message}");
}

#[test]
fn duplicated_rows_and_unused_parameters_do_no_harm() {
    let mut rows = Rows::new(3, 8, |_, theta, row| {
        row.copy_from_slice(&[1.0, 1.0, 0.0]);
        theta[0] + theta[1] - 2.0
    });
    let mut method = Marquardt::new(vec![0.0, 0.0, 7.0], flat());
    finish(&mut method, &mut rows);
    for (found, expected) in theta(&method).iter().zip([1.0, 1.0, 7.0]) {
        assert!((found - expected).abs() < 1e-9);
    }
}

#[test]
fn objects_of_the_trait_are_accepted() {
    let mut rows = exponential(10);
    let rows: &mut dyn LeastSquares = &mut rows;
    let mut method = Marquardt::new(vec![1.0, 0.1, 0.0], flat());
    assert!(method.step(rows).unwrap().loss.is_finite());
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut rows = Rows::new(250, 300, |i, theta, row| {
                let entry = |k: usize, x: f64| cosine(k, i, 300) * (1.0 + 0.1 * x);
                (0..250).for_each(|k| row[k] = entry(k, 2.0 * theta[k]));
                (0..250).map(|k| entry(k, theta[k]) * theta[k]).sum::<f64>() - (i as f64).cos()
            });
            let mut method = Marquardt::new(vec![0.1; 250], WeightPrior::uniform(0.1, 250));
            (0..3).for_each(|_| assert!(method.step(&mut rows).is_ok()));
            theta(&method).to_vec()
        })
    };
    assert_eq!(run(1), run(3));
}
