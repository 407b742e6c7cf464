//! Fields with bounds, of which equations take derivatives.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// A leaking tank that begins empty, with an unknown inflow.
    mod tank {
        units: off;
        coordinates: t;
        fields: h >= 0;
        sources: q;
        parameters: k = 0.8;
        on flow { balance: d(h, t) == q - k * h; }
        on start { empty: h == 0; }
        on samples { observe h; }
        scene filled { }
    }
}

interpret! {
    /// A mass between two walls, and the force on it.
    mod walled {
        units: off;
        coordinates: t;
        fields: x in -1 .. 1;
        sources: f;
        on motion { newton: d(x, t, 2) + 4 * x == f; }
        on samples { observe x; }
        scene moved { }
    }
}

interpret! {
    /// One substance that becomes another and decays; both amounts are measured, and neither is negative.
    mod decay {
        units: off;
        coordinates: t;
        fields: a > 0, b >= 0;
        parameters: k = 1, m = 2;
        on flask { first: d(a, t) == -k * a; second: d(b, t) == k * a - m * b; }
        on start { none: b == 0; }
        on samples { observe a, b; }
        scene rates { learn k, m; }
    }
}

/// Times in order, and values of closed forms with noise there.
fn times(count: usize, end: f64) -> Vec<f64> {
    (0..count).map(|i| end * i as f64 / (count - 1) as f64).collect()
}

fn noisy(times: &[f64], value: impl Fn(f64) -> f64, noise: f64, seed: u64) -> Vec<f64> {
    let mut normal = normals(seed);
    times.iter().map(|&t| value(t) + noise * normal()).collect()
}

fn failed(solution: &Solution) -> Vec<String> {
    solution.verdict.failed().map(|check| check.message.clone()).collect()
}

/// `h = t^2 exp(-t)` touches its bound where it begins, and the data lie on both sides of it.
#[test]
fn a_field_that_touches_its_bound_has_the_source_of_its_derivative() {
    let (h, slope) = (|t: f64| t * t * (-t).exp(), |t: f64| (2.0 * t - t * t) * (-t).exp());
    let mut problem = Problem::new(tank::scene("filled"));
    let places = times(120, 6.0);
    problem.set_group("flow", times(200, 6.0).into(), vec![]).unwrap();
    problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
    problem.set_group("samples", places.clone().into(), vec![noisy(&places, h, 0.005, 3)]).unwrap();
    let mut right = solve(&problem, Carrier::Splines);
    assert_eq!(right.status, Status::Converged, "{:?}", failed(&right));
    let at = times(60, 6.0);
    let answer = right.evaluate_with_errors(&at);
    let (found, bars) = (&of(&answer, "q").values, of(&answer, "q").deviations.as_ref().unwrap());
    let off = |i: usize| (found[i] - slope(at[i]) - 0.8 * h(at[i])).abs();
    assert!((0..at.len()).all(|i| off(i) < 4.0 * bars[i]));
    assert!((0..at.len()).filter(|&i| off(i) < 2.0 * bars[i]).count() >= 52);
    assert!((0..at.len()).all(|i| off(i) < 0.12), "{:?}", (0..at.len()).map(off).fold(0.0, f64::max));
    assert!(of(&answer, "h").values.iter().all(|&h| h > -1e-3));
    // What a saved answer says of the derivative closes the balance too, where there is something of either.
    let saved = right.saved().unwrap();
    let (read, names) = nisp_interpreter::ask(&saved, "d(h, t) + k * h").unwrap();
    let all = read.evaluate(&at);
    let sums = &of(&all, &names[0]).values;
    assert!(sums.iter().zip(found).all(|(sum, q)| (sum - q).abs() < 2e-3), "{sums:?} {found:?}");
    let error = nisp_interpreter::ask(&saved, "h_ttttt").err().unwrap().to_string();
    assert!(error.contains("`h`") && !error.contains("kink"), "{error}");
}

/// `x = 0.99 sin(t)` comes within a hundredth of both walls; the force is `3 x`.
#[test]
fn a_field_between_two_bounds_has_second_derivatives() {
    let x = |t: f64| 0.99 * t.sin();
    let mut problem = Problem::new(walled::scene("moved"));
    let places = times(200, 9.0);
    problem.set_group("motion", times(300, 9.0).into(), vec![]).unwrap();
    problem.set_group("samples", places.clone().into(), vec![noisy(&places, x, 0.002, 5)]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", failed(&solution));
    let at = times(50, 8.0).iter().map(|t| t + 0.5).collect::<Vec<_>>();
    let answer = solution.evaluate(&at);
    let found = &of(&answer, "f").values;
    let off: f64 = at.iter().zip(found).map(|(&t, f)| (f - 3.0 * x(t)).powi(2)).sum::<f64>() / at.len() as f64;
    assert!(off.sqrt() < 0.05, "{}", off.sqrt());
}

/// Rates of closed forms are found, and data that the equations cannot have given are not taken for theirs.
#[test]
fn bounds_of_fields_hide_no_wrong_data() {
    let (a, b) = (|t: f64| (-0.5 * t).exp(), |t: f64| ((-0.5 * t).exp() - (-1.5 * t).exp()) / 2.0);
    let solved = |share: f64| {
        let mut problem = Problem::new(decay::scene("rates"));
        let places = times(40, 5.0);
        problem.set_group("flask", times(100, 5.0).into(), vec![]).unwrap();
        problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
        let data = vec![noisy(&places, a, 0.004, 1), noisy(&places, |t| share * b(t), 0.004, 2)];
        problem.set_group("samples", places.into(), data).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let mut right = solved(1.0);
    assert_eq!(right.status, Status::Converged, "{:?}", failed(&right));
    for (name, exact) in [("k", 0.5), ("m", 1.5)] {
        let found = right.learned().into_iter().find(|learned| learned.name == name).unwrap();
        assert!((found.value - exact).abs() < 4.0 * found.deviation.unwrap(), "{name}: {found:?}");
        assert!((found.value / exact - 1.0).abs() < 0.03, "{name}: {found:?}");
    }
    // Amounts above what there was of the first substance.
    assert_eq!(solved(2.5).status, Status::Inconsistent);
}
