//! Gradient methods on functions whose minima are known in closed form.

mod solve_common;

use nisp_runtime::solve::adam::{Adam, AdamSettings};
use nisp_runtime::solve::broyden::{Broyden, Update};
use nisp_runtime::solve::lbfgs::Lbfgs;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::Objective;
use solve_common::{Function, quadratic, rosenbrock};
use std::cell::RefCell;
use std::rc::Rc;

/// Steps until the loss is below `target`; `None` after `most` steps.
fn steps_to(
    method: &mut dyn Method<f64, dyn Objective<f64>>,
    function: &mut (dyn Objective<f64> + 'static),
    target: f64,
    most: usize,
) -> Option<usize> {
    (1..=most).find(|_| method.step(function).unwrap().loss < target)
}

#[test]
fn rosenbrock_reaches_ones() {
    let start = vec![-1.2, 1.0, -1.2, 1.0, 0.5, -0.3];
    let methods: [Box<dyn Method<f64, dyn Objective<f64>>>; 4] = [
        Box::new(Lbfgs::new(start.clone(), 10)),
        Box::new(Broyden::new(start.clone(), Update::Bfgs)),
        Box::new(Broyden::new(start.clone(), Update::SelfScaledBfgs)),
        Box::new(Broyden::new(start.clone(), Update::SelfScaledBroyden)),
    ];
    for mut method in methods {
        let steps = steps_to(&mut *method, &mut rosenbrock(6), 1e-20, 300);
        assert!(steps.is_some(), "{}", method.name());
        for x in method.theta() {
            assert!((x - 1.0).abs() < 1e-8, "{}: {x}", method.name());
        }
    }
}

#[test]
fn ill_conditioned_quadratic_reaches_its_minimum() {
    // Condition number 1e8, minimum at 1 / (1 + i).
    let len = 50;
    for update in [Update::Bfgs, Update::SelfScaledBfgs, Update::SelfScaledBroyden] {
        let mut method = Broyden::new(vec![0.0; len], update);
        let steps = steps_to(&mut method, &mut quadratic(len, 1e8), 1e-18, 1500);
        assert!(steps.is_some(), "{}", update.name());
        let theta = Method::<f64, dyn Objective<f64>>::theta(&method);
        for (i, x) in theta.iter().enumerate() {
            assert!((x - 1.0 / (1.0 + i as f64)).abs() < 1e-6, "{}: {i}", update.name());
        }
    }
}

#[test]
fn self_scaling_pays_on_an_ill_conditioned_quartic() {
    // sum_i k_i (x_i^2 / 2 + x_i^4 / 4) in mixed coordinates, far from the minimum at zero: the curvature falls by
    // orders of magnitude on the way, which is what self-scaling is for.
    let len = 60;
    let run = |update| {
        let mut function = solve_common::quartic(len, 1e4);
        let start = (0..len).map(|i| 10.0 * (1.0 + i as f64).cos()).collect();
        let mut method = Broyden::new(start, update);
        steps_to(&mut method, &mut function, 1e-10, 5000).expect("converges")
    };
    let (bfgs, broyden) = (run(Update::Bfgs), run(Update::SelfScaledBroyden));
    println!("bfgs {bfgs}, ssbfgs {}, ssbroyden {broyden}", run(Update::SelfScaledBfgs));
    assert!(broyden < bfgs, "ssbroyden {broyden}, bfgs {bfgs}");
}

#[test]
fn adam_follows_its_definition() {
    // One parameter, gradient 2 x: two steps by hand, with the rate decayed after the first.
    let settings = AdamSettings { rate: 0.1, decay: 0.5, decay_steps: 1, ..AdamSettings::default() };
    let mut square = Function::new(1, |x| (x[0] * x[0], vec![2.0 * x[0]]));
    let mut adam = Adam::new(vec![3.0], settings);
    adam.step(&mut square as &mut dyn Objective<f64>).unwrap();
    let x1 = 3.0 - 0.1 * 6.0 / (6.0 + 1e-8);
    let theta = |adam: &Adam<f64>| Method::<f64, dyn Objective<f64>>::theta(adam)[0];
    assert!((theta(&adam) - x1).abs() < 1e-14);
    adam.step(&mut square as &mut dyn Objective<f64>).unwrap();
    let m = (0.9 * 0.1 * 6.0 + 0.1 * 2.0 * x1) / (1.0 - 0.81);
    let v = (0.999 * 0.001 * 36.0 + 0.001 * 4.0 * x1 * x1) / (1.0 - 0.999_f64.powi(2));
    assert!((theta(&adam) - (x1 - 0.05 * m / (v.sqrt() + 1e-8))).abs() < 1e-14);
}

#[test]
fn a_minimum_is_recognised() {
    let mut method = Broyden::new(vec![1.0; 6], Update::SelfScaledBroyden);
    let step = method.step(&mut rosenbrock(6) as &mut dyn Objective<f64>).unwrap();
    assert_eq!(step.verdict, Verdict::Exhausted);
    assert_eq!(step.loss, 0.0);
}

#[test]
fn single_precision_gets_as_far_as_it_can() {
    let mut method = Lbfgs::new(vec![-1.2_f32, 1.0], 10);
    let mut function = solve_common::Narrow(rosenbrock(2));
    for _ in 0..200 {
        let step = method.step(&mut function as &mut dyn Objective<f32>).unwrap();
        if step.verdict == Verdict::Exhausted {
            break;
        }
    }
    let theta = Method::<f32, dyn Objective<f32>>::theta(&method);
    assert!((theta[0] - 1.0).abs() < 2e-3 && (theta[1] - 1.0).abs() < 4e-3, "{theta:?}");
}

#[test]
fn slopes_lead_on_where_losses_are_noise() {
    // The losses are good to nine digits, as where small residuals are differences of large numbers; the gradients to all.
    // Where a gradient is below 1e-6, the loss is within 1e-12 of its minimum, a thousandth of the noise.
    let len = 20;
    let methods: [Box<dyn Method<f64, dyn Objective<f64>>>; 2] =
        [Box::new(Lbfgs::new(vec![0.0; len], 20)), Box::new(Broyden::new(vec![0.0; len], Update::SelfScaledBroyden))];
    for mut method in methods {
        let mut exact = quadratic(len, 1e4);
        let mut rounded = Function::new(len, move |x| {
            let mut gradient = vec![0.0; len];
            let value = exact.gradient(x, &mut gradient).unwrap();
            let noise = x.iter().map(|x| (1e9 * x).sin()).sum::<f64>() / len as f64;
            (1.0 + value + 1e-9 * noise, gradient)
        });
        let least = (0..400).map(|_| method.step(&mut rounded).unwrap().gradient_norm).fold(f64::INFINITY, f64::min);
        assert!(least < 1e-6, "{}: {least:e}", method.name());
    }
}

/// Half the squared distance of `theta`, stretched, to the nearest whole numbers as they were when last looked at.
fn nearest(len: usize) -> Function {
    let targets = Rc::new(RefCell::new(vec![0.0; len]));
    let seen = Rc::clone(&targets);
    let stretch = |i: usize| 1.0 + 10.0 * i as f64;
    let mut function = Function::new(len, move |x| {
        let difference = |i: usize| x[i] - seen.borrow()[i];
        let value = (0..len).map(|i| 0.5 * stretch(i) * difference(i).powi(2)).sum();
        (value, (0..len).map(|i| stretch(i) * difference(i)).collect())
    });
    function.on_accepted = Some(Box::new(move |x| {
        let new: Vec<f64> = x.iter().map(|x| (x + 0.4).round()).collect();
        let changed = *targets.borrow() != new;
        targets.replace(new);
        changed
    }));
    function
}

#[test]
fn an_assignment_may_be_refreshed_at_every_step() {
    let start: Vec<f64> = (0..10).map(|i| (7.0 * i as f64).sin() * 3.0).collect();
    let methods: [Box<dyn Method<f64, dyn Objective<f64>>>; 2] =
        [Box::new(Lbfgs::new(start.clone(), 10)), Box::new(Broyden::new(start, Update::SelfScaledBroyden))];
    for mut method in methods {
        let mut function = nearest(10);
        let function: &mut (dyn Objective<f64> + 'static) = &mut function;
        let verdicts: Vec<_> = (0..60).map(|_| method.step(function).unwrap().verdict).collect();
        assert!(verdicts.contains(&Verdict::Changed), "{}", method.name());
        for x in method.theta() {
            assert!((x - x.round()).abs() < 1e-7, "{}: {x}", method.name());
        }
    }
}
