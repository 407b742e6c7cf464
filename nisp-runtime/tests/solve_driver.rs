//! Stopping: convergence, budget, stagnation, interruption.

mod solve_common;

use nisp_runtime::solve::adam::{Adam, AdamSettings};
use nisp_runtime::solve::broyden::{Broyden, Update};
use nisp_runtime::solve::driver::{Flow, Limits, Outcome, Status, WarningKind, resume, run};
use nisp_runtime::solve::fault::Kind;
use nisp_runtime::solve::gauss_newton::GaussNewton;
use nisp_runtime::solve::lbfgs::Lbfgs;
use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::Method;
use nisp_runtime::solve::objective::Objective;
use nisp_runtime::solve::prior::WeightPrior;
use solve_common::rows::{Rows, cosine, exponential};
use solve_common::{Function, Narrow, quadratic, rosenbrock};
use std::time::Duration;

/// Least squares with a known remainder: 1 / 2 sum (theta . c_k - y)^2 with y outside of the span.
fn remainder() -> Rows {
    Rows::new(4, 30, |i, theta, row| {
        (0..4).for_each(|k| row[k] = cosine(k, i, 30));
        let fit: f64 = row.iter().zip(theta).map(|(j, x)| j * (x + 0.1 * x.powi(3))).sum();
        row.iter_mut().zip(theta).for_each(|(j, x)| *j *= 1.0 + 0.3 * x * x);
        fit - cosine(1, i, 30) - cosine(9, i, 30)
    })
}

#[test]
fn second_order_methods_converge_by_their_own_estimate() {
    let methods: [Box<dyn Method<f64, Rows>>; 4] = [
        Box::new(Marquardt::new(vec![0.5; 4], WeightPrior::default())),
        Box::new(GaussNewton::new(vec![0.5; 4], WeightPrior::default(), 50)),
        Box::new(Broyden::new(vec![0.5; 4], Update::SelfScaledBroyden)),
        Box::new(Lbfgs::new(vec![0.5; 4], 10)),
    ];
    for mut method in methods {
        let outcome = run(&mut *method, &mut remainder(), Limits::default(), &mut |_| Flow::Continue);
        assert_eq!(outcome.status, Status::Converged, "{}", method.name());
        assert!(outcome.iterations < 100, "{}: {}", method.name(), outcome.iterations);
        // What is left is |cosine_9|^2 / 2 = 30 / 4.
        assert!((outcome.loss - 7.5).abs() < 1e-5, "{}: {}", method.name(), outcome.loss);
        assert!(outcome.warnings.is_empty());
    }
}

#[test]
fn matrix_free_steps_reach_the_exact_fit() {
    let mut method = GaussNewton::new(vec![1.0, 0.1, 0.0], WeightPrior::default(), 50);
    let outcome = run(&mut method, &mut exponential(40), Limits::default(), &mut |_| Flow::Continue);
    for (found, expected) in outcome.theta.iter().zip([2.0, 1.5, 0.3]) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn a_budget_is_kept_with_the_best_iterate() {
    let slow = |x: &[f64]| {
        std::thread::sleep(Duration::from_millis(4));
        (x[0] * x[0], vec![2.0 * x[0]])
    };
    let mut method = Adam::new(vec![3.0], AdamSettings::default());
    let budget = Duration::from_millis(300);
    let limits = Limits { budget: Some(budget), ..Limits::default() };
    let mut best = f64::INFINITY;
    let outcome = run(&mut method, &mut Function::new(1, slow), limits, &mut |progress| {
        best = best.min(progress.step.loss);
        Flow::Continue
    });
    assert_eq!(outcome.status, Status::Budget);
    assert_eq!(outcome.loss, best);
    // Loose, because a busy machine oversleeps: the promise is 5 % on a quiet one.
    assert!((0.2..0.4).contains(&outcome.wall_s), "{}", outcome.wall_s);
}

#[test]
fn a_budget_that_is_spent_before_the_start_allows_one_step() {
    let mut method = Broyden::new(vec![-1.2, 1.0], Update::Bfgs);
    let limits = Limits { budget: Some(Duration::ZERO), ..Limits::default() };
    let outcome = run(&mut method, &mut rosenbrock(2), limits, &mut |_| Flow::Continue);
    assert_eq!((outcome.status, outcome.iterations), (Status::Budget, 1));
    assert!(outcome.loss.is_finite());
}

#[test]
fn steps_are_limited_and_a_monitor_may_stop() {
    let limits = Limits { iterations: 7, ..Limits::default() };
    let mut method = Broyden::new(vec![-1.2, 1.0], Update::Bfgs);
    let outcome = run(&mut method, &mut rosenbrock(2), limits, &mut |_| Flow::Continue);
    assert_eq!((outcome.status, outcome.iterations), (Status::Budget, 7));
    let mut saved = None;
    let outcome = run(&mut method, &mut rosenbrock(2), Limits::default(), &mut |progress| {
        if progress.iteration == 3 {
            saved = Some((progress.checkpoint)());
            return Flow::Stop;
        }
        Flow::Continue
    });
    assert_eq!((outcome.status, outcome.iterations), (Status::Interrupted, 3));
    let mut other = Broyden::new(vec![0.0, 0.0], Update::Bfgs);
    Method::<f64, Function>::restore(&mut other, &saved.unwrap()).unwrap();
    assert_eq!(Method::<f64, Function>::save(&other), Method::<f64, Function>::save(&method));
}

#[test]
fn a_resumed_run_is_judged_and_remembered_as_if_it_had_not_stopped() {
    let start = || Marquardt::new(vec![1.0, 0.1, 0.0], WeightPrior::uniform(1e-4, 3));
    let function = || {
        let mut rows = exponential(25);
        rows.faulty = vec![4];
        rows
    };
    let straight = run(&mut start(), &mut function(), Limits::default(), &mut |_| Flow::Continue);
    assert_eq!(straight.status, Status::Converged);
    assert!(matches!(straight.warnings[0].kind, WarningKind::Fault(_)));
    // After the fault: who goes on may evaluate once more than who does not stop, so that calls are numbered otherwise.
    for stop in 4..straight.iterations {
        let limits = Limits { iterations: stop, ..Limits::default() };
        let mut shared = function();
        let first = run(&mut start(), &mut shared, limits, &mut |_| Flow::Continue);
        let mut method = start();
        let resumed =
            resume(&mut method, &mut shared, &first.state, Limits::default(), &mut |_| Flow::Continue).unwrap();
        assert_eq!(Outcome { wall_s: straight.wall_s, ..resumed }, straight, "after {stop}");
    }
}

#[test]
fn a_floor_ends_exact_problems() {
    let limits = Limits { floor: 1e-12, ..Limits::default() };
    let mut method = Broyden::new(vec![-1.2, 1.0], Update::SelfScaledBroyden);
    let outcome = run(&mut method, &mut rosenbrock(2), limits, &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::Converged);
    assert!(outcome.loss <= 1e-12);
}

#[test]
fn single_precision_is_said_to_be_exhausted() {
    // The minimum is not a number of single precision.
    let mut method = Lbfgs::new(vec![0.0_f32; 10], 10);
    let mut function = Narrow(quadratic(10, 1e6));
    let limits = Limits { tolerance: 1e-10, ..Limits::default() };
    let function: &mut dyn Objective<f32> = &mut function;
    let outcome = run(&mut method, function, limits, &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::NotConverged);
    assert_eq!(outcome.warnings[0].kind, WarningKind::SinglePrecision);
    assert!(outcome.warnings[0].message.contains("go on in f64"));
}

#[test]
fn stagnation_is_said_with_a_remedy() {
    // Adam with a rate too large for its valley bounces from wall to wall.
    let settings = AdamSettings { rate: 0.5, decay: 1.0, ..AdamSettings::default() };
    let wall = |x: &[f64]| (1.0 + x[0].abs(), vec![x[0].signum()]);
    let mut method = Adam::new(vec![0.2], settings);
    let outcome = run(&mut method, &mut Function::new(1, wall), Limits::default(), &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::NotConverged);
    assert_eq!(outcome.warnings[0].kind, WarningKind::Stagnation);
    assert!(outcome.iterations < 2000);
}

#[test]
fn a_rate_that_has_yet_to_fall_does_not_converge() {
    // Around the minimum the gradient is small again and again, and the loss no lower than before.
    let settings = AdamSettings { rate: 0.01, decay: 0.1, decay_steps: 2000, ..AdamSettings::default() };
    let bowl = |x: &[f64]| (1.0 + x[0] * x[0], vec![2.0 * x[0]]);
    let mut method = Adam::new(vec![0.5], settings);
    let outcome = run(&mut method, &mut Function::new(1, bowl), Limits::default(), &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::Converged);
    assert!(outcome.iterations > 2000, "{}", outcome.iterations);
}

#[test]
fn a_plateau_of_a_rate_that_falls_is_no_stagnation() {
    // Steps of half a unit cannot come nearer to the kink than they are long, for 2000 of them: then the rate is a tenth.
    let settings = AdamSettings { rate: 0.5, decay: 0.1, decay_steps: 2000, ..AdamSettings::default() };
    let wall = |x: &[f64]| (1.0 + x[0].abs(), vec![x[0].signum()]);
    let run_to = |iterations| {
        let mut method = Adam::new(vec![0.2], settings);
        let limits = Limits { iterations, ..Limits::default() };
        run(&mut method, &mut Function::new(1, wall), limits, &mut |_| Flow::Continue)
    };
    let outcome = run_to(7000);
    assert_eq!(outcome.status, Status::Budget, "{:?}", outcome.warnings);
    let plateau = run_to(2000);
    assert!(outcome.loss - 1.0 < 0.2 * (plateau.loss - 1.0), "{} {}", outcome.loss, plateau.loss);
}

#[test]
fn a_lasting_fault_is_reported_with_the_best_iterate() {
    let mut function = rosenbrock(2);
    function.faulty = (12..10_000).collect();
    let mut method = Broyden::new(vec![-1.2, 1.0], Update::SelfScaledBroyden);
    let outcome = run(&mut method, &mut function, Limits::default(), &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::NotConverged);
    let WarningKind::Fault(fault) = &outcome.warnings[0].kind else { panic!("{outcome:?}") };
    assert_eq!((fault.term.as_str(), fault.what), ("balance", Kind::Residual));
    assert_eq!(outcome.warnings.len(), 1, "said once");
    assert!(outcome.loss.is_finite() && outcome.loss < 10.0);
}

#[test]
fn who_stops_at_the_last_step_of_a_run_has_come_to_its_end() {
    let quick = || Marquardt::new(vec![0.5; 4], WeightPrior::default());
    let lost = || Adam::new(vec![0.5], AdamSettings { rate: 0.0, ..AdamSettings::default() });
    let parabola = || Function::new(1, |x: &[f64]| (x[0] * x[0], vec![2.0 * x[0]]));
    let limits = Limits { patience: 2, ..Limits::default() };
    let mut states = Vec::new();
    let converged = run(&mut quick(), &mut remainder(), limits, &mut |progress| {
        states.push((progress.checkpoint)());
        Flow::Continue
    });
    let resumed = resume(&mut quick(), &mut remainder(), &states[states.len() - 1], limits, &mut |_| Flow::Continue);
    assert_eq!(converged.status, Status::Converged);
    let resumed = resumed.unwrap();
    assert_eq!((resumed.status, resumed.iterations), (Status::Converged, converged.iterations));
    assert_eq!(resumed.state, converged.state);
    let given_up = run(&mut lost(), &mut parabola(), limits, &mut |_| Flow::Continue);
    let resumed = resume(&mut lost(), &mut parabola(), &given_up.state, limits, &mut |_| Flow::Continue).unwrap();
    assert_eq!((resumed.status, resumed.iterations), (Status::NotConverged, given_up.iterations));
    assert_eq!(resumed.warnings, given_up.warnings);
}
