//! Given numbers that the data contradict, where a source takes over most of what is wrong with them.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, solve};

interpret! {
    /// A heater in a room with a wall that stores heat, a thermometer in each.
    mod room {
        units: off;
        coordinates: t;
        fields: a, w;
        sources: p;
        parameters: k = 2, c = 5;
        on house { air: d(a, t) == -a - k * (a - w) + p; wall: c * d(w, t) == k * (a - w); }
        on start { cold: w == 0; outside: a == 0; }
        on samples { observe a, w; }
        scene recover { }
    }
}

/// `w = t^2 exp(-t)`, with `a` and `p` as the equations make them of `k = 2` and `c = 5`.
fn found(k: f64, seed: u64) -> Solution {
    let rows: Vec<f64> = (0..121).map(|row| 0.08 * f64::from(row)).collect();
    let wall = |t: f64| t * t * (-t).exp();
    let air = |t: f64| wall(t) + 2.5 * (2.0 * t - t * t) * (-t).exp();
    let mut normal = normals(seed);
    let mut measured = |of: &dyn Fn(f64) -> f64| rows.iter().map(|&t| of(t) + 0.01 * normal()).collect::<Vec<f64>>();
    let columns = vec![measured(&air), measured(&wall)];
    let mut problem = Problem::new(room::scene("recover"));
    problem.set_parameter("k", k).unwrap();
    let house: Vec<f64> = (0..200).map(|i| 9.6 * f64::from(i) / 199.0).collect();
    problem.set_group("house", house.into(), Vec::new()).unwrap();
    problem.set_group("start", vec![0.0].into(), Vec::new()).unwrap();
    problem.set_group("samples", rows.into(), columns).unwrap();
    solve(&problem, Carrier::Splines)
}

#[test]
fn a_number_that_is_a_little_wrong_is_named_with_what_it_should_be() {
    for seed in 1..4 {
        let right = found(2.0, seed);
        assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
        let wrong = found(2.2, seed);
        assert_eq!(wrong.status, Status::Inconsistent);
        let check = wrong.verdict.failed().find(|check| check.check == "given").unwrap();
        assert!(
            check.message.contains("`k` about 2.0") || check.message.contains("`k` about 1.9"),
            "{}",
            check.message
        );
    }
}
