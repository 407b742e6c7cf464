//! Given numbers that the data contradict, where a source takes over most of what is wrong with them.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, simulated, solve};

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

interpret! {
    /// Prey and predators, with all rates unknown.
    mod prey {
        units: off;
        coordinates: t;
        fields: u, v;
        parameters: a > 0 = 0.8, b > 0 = 0.04, c > 0 = 0.5, e > 0 = 0.03;
        on growth { prey: d(u, t) == a * u - b * u * v; predators: d(v, t) == e * u * v - c * v; }
        on samples { observe u, v; }
        scene rates { learn a, b, c, e; }
    }
}

/// A sensor's offset is made up for by rates that are not those of the animals: the data would be likelier with another zero.
#[test]
fn an_offset_of_a_sensor_is_named() {
    let times: Vec<f64> = (0..201).map(|row| 0.15 * f64::from(row)).collect();
    let rate = |_: f64, [u, v]: [f64; 2]| [0.9 * u - 0.05 * u * v, 0.02 * u * v - 0.6 * v];
    let course = simulated(&times, [30.0, 10.0], rate);
    let found = |offset: f64| {
        let mut normal = normals(6);
        let mut measured =
            |of: usize, by: f64| course.iter().map(|x| x[of] + by + 0.5 * normal()).collect::<Vec<f64>>();
        let columns = vec![measured(0, 0.0), measured(1, offset)];
        let mut problem = Problem::new(prey::scene("rates"));
        problem.set_group("growth", times.clone().into(), Vec::new()).unwrap();
        problem.set_group("samples", times.clone().into(), columns).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let mut right = found(0.0);
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
    for (learned, exact) in right.learned().iter().zip([0.9, 0.05, 0.6, 0.02]) {
        assert!((learned.value - exact).abs() < 3.5 * learned.deviation.unwrap(), "{learned:?} is not {exact}");
    }
    let wrong = found(4.0);
    assert_eq!(wrong.status, Status::Inconsistent);
    let check = wrong.verdict.failed().find(|check| check.check == "given").unwrap();
    assert!(check.message.contains("added to `v` all along"), "{}", check.message);
}

interpret! {
    /// A heated rod, seen by a camera and felt by a few thermocouples.
    mod rod {
        units: off;
        coordinates: x;
        fields: u;
        sources: q;
        domains: span = 0 .. 1;
        on inside in span { conduction: -d(u, x, 2) == q; }
        on ends boundary of span { cold: u == 0; }
        on camera { observe u; }
        on couples { observe u; }
        scene heated { }
    }
}

/// Five values that are all otherwise than what the others make of them are no noise, however few they are.
#[test]
fn few_values_that_contradict_all_others_are_no_noise() {
    let pi = std::f64::consts::PI;
    let found = |gain: f64| {
        let mut normal = normals(9);
        let grid = |count: u32| (0..count).map(move |i| (f64::from(i) + 0.5) / f64::from(count));
        let warm = |x: f64| (pi * x).sin() + 0.3 * (3.0 * pi * x).sin();
        let seen = grid(81).map(|x| gain * warm(x) + 0.01 * normal()).collect();
        let felt = grid(5).map(|x| warm(x) + 0.002 * normal()).collect();
        let mut problem = Problem::new(rod::scene("heated"));
        let inside: Vec<f64> = (0..=80).map(|i| f64::from(i) / 80.0).collect();
        problem.set_group("inside", inside.into(), Vec::new()).unwrap();
        problem.set_group("ends", vec![0.0, 1.0].into(), Vec::new()).unwrap();
        problem.set_group("camera", grid(81).collect::<Vec<f64>>().into(), vec![seen]).unwrap();
        problem.set_group("couples", grid(5).collect::<Vec<f64>>().into(), vec![felt]).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let right = found(1.0);
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
    let wrong = found(0.7);
    assert_eq!(wrong.status, Status::Inconsistent, "{:?}", wrong.verdict);
    let is_said = |check: &nisp::Check| (check.check, check.group) == ("contradicted", "couples");
    assert!(wrong.verdict.failed().any(is_said), "{:?}", wrong.verdict.failed().collect::<Vec<_>>());
}

interpret! {
    /// A room under a heater whose power is logged.
    mod heater {
        units: off;
        coordinates: t;
        fields: u;
        parameters: c > 0 = 1, r > 0 = 1;
        on room { columns: p; heat: c * d(u, t) == p - u / r; }
        on samples { observe u; }
        scene rates { learn c, r; }
    }
}

/// A heater at full power and a meter at the end of its range look alike in the log, and only the room tells them apart.
#[test]
fn a_given_column_at_the_end_of_its_range_is_told_from_a_heater_at_full_power() {
    let times: Vec<f64> = (0..241).map(|row| 0.1 * f64::from(row)).collect();
    let wanted = |t: f64| 2.0 + (1.1 * t).sin() + 0.8 * (2.7 * t).sin();
    let limited = |t: f64| wanted(t).min(2.6);
    let found = |power: &dyn Fn(f64) -> f64| {
        let course = simulated(&times, [1.5, 0.0], |t, [u, _]| [(power(t) - u / 1.3) / 2.0, 0.0]);
        let mut normal = normals(4);
        let measured = course.iter().map(|x| x[0] + 0.01 * normal()).collect();
        let logged = times.iter().map(|&t| limited(t)).collect();
        let mut problem = Problem::new(heater::scene("rates"));
        problem.set_group("room", times.clone().into(), vec![logged]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![measured]).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let mut right = found(&limited);
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
    for (learned, exact) in right.learned().iter().zip([2.0, 1.3]) {
        assert!((learned.value - exact).abs() < 3.5 * learned.deviation.unwrap(), "{learned:?} is not {exact}");
    }
    let wrong = found(&wanted);
    assert_eq!(wrong.status, Status::Inconsistent, "{:?}", wrong.verdict);
    let check = wrong.verdict.failed().find(|check| check.check == "given").unwrap();
    assert!(check.message.contains("added to `p` where it stands still"), "{}", check.message);
}
