//! Other equations over one coordinate: coefficients, rates, beliefs, boundary values, bounds, and what is refused.

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, SceneRef, Settings, Solution, recover};
use nisp_interpreter::interpret;

use crate::{normals, of, settings, solve};

interpret! {
    /// A spring of which something is believed.
    mod spring {
        coordinates: s [cm];
        fields: u [mm];
        parameters: k [N/m] in 1 .. 9 = 5 within 0.5;
        on samples { observe u within 0.3 [mm]; }
        on outputs { observe pull: k * s ~ force [mN] within 3 [mN]; }
        scene believed { learn k; }
    }
}

interpret! {
    /// A string under a known load, held at both ends.
    mod string {
        units: off;
        coordinates: x;
        fields: w;
        on inside { balance: -d(w, x, 2) == sin(pi * x); }
        on left { held: w == 0; }
        on right { held: w == 0; }
        scene loaded { }
    }
}

interpret! {
    /// A string without any load: its equation has one quantity, which vanishes.
    mod slack {
        units: off;
        coordinates: x;
        fields: w;
        on inside { balance: d(w, x, 2) == 0; }
        on left { held: w == 1; }
        on right { held: w == 2; }
        scene straight { }
    }
}

interpret! {
    /// Lorenz's equations, all three coefficients unknown.
    mod lorenz {
        units: off;
        coordinates: t;
        fields: x, y, z;
        parameters: a = 8, b = 10, c = 2;
        on flow {
            first: d(x, t) == a * (y - x);
            second: d(y, t) == x * (b - z) - y;
            third: d(z, t) == x * y - c * z;
        }
        on start { x0: x == -8; y0: y == 7; z0: z == 27; }
        on samples { observe x, y, z; }
        scene identify { learn a, b, c; }
    }
}

interpret! {
    /// A reaction whose rate along the line is unknown, with a thin diffusion.
    mod reaction {
        units: off;
        coordinates: x;
        fields: u;
        sources: k;
        on inside { law: 0.01 * d(u, x, 2) - k * u == sin(2 * pi * x); }
        on left { held: u == 0; }
        on right { held: u == 0; }
        on gauges { observe u; }
        scene rate { }
    }
}

interpret! {
    /// The same where the load is known at points, as a measured one is.
    mod loaded_reaction {
        units: off;
        coordinates: x;
        fields: u;
        sources: k >= 0;
        on inside { columns: load; law: k * u - 0.02 * d(u, x, 2) == load; }
        on left { held: u == 0; }
        on right { held: u == 0; }
        on gauges { observe u; }
        scene rate { }
    }
}

interpret! {
    /// An epidemic: a share `S` may still be infected, a share `exp(y)` is.
    mod epidemic {
        units: off;
        coordinates: t;
        fields: S, y;
        sources: beta;
        parameters: y0 = 0;
        on days {
            susceptible: d(S, t) == -beta * S * exp(y);
            infected: d(y, t) == beta * S - 1;
        }
        on start { all: S == 1; first: y == y0; }
        on cases { observe y; }
        scene spread { }
    }
}

interpret! {
    /// A source whose sum is known.
    mod summed {
        units: off;
        coordinates: x;
        fields: w;
        sources: q;
        on inside { balance: -d(w, x, 2) == q; total: integral(q) == 1 with huber(3); }
        on gauges { observe w; }
        scene loaded { }
    }
}

interpret! {
    /// A tank that is filled from time to time, and never emptied.
    mod tank {
        units: off;
        coordinates: t;
        fields: level;
        sources: inflow >= 0;
        on filling { balance: d(level, t) == inflow; }
        on samples { observe level; }
        scene filled { }
    }
}

interpret! {
    /// The same tank behind a gate that lets through no more than a half.
    mod gate {
        units: off;
        coordinates: t;
        fields: level;
        sources: inflow in 0 .. 0.5;
        on filling { balance: d(level, t) == inflow; }
        on samples { observe level; }
        scene filled { }
    }
}

/// Twenty-five rows good to a thousandth: steps of Runge and Kutta's method are exact to many digits more.
#[test]
fn coefficients_of_lorenz_are_found_with_bars_that_cover() {
    let exact = [10.0, 15.0, 8.0 / 3.0];
    let [a, b, c] = exact;
    let slope = |[x, y, z]: [f64; 3]| [a * (y - x), x * (b - z) - y, x * y - c * z];
    let along = |s: [f64; 3], k: [f64; 3], h: f64| [0, 1, 2].map(|i| s[i] + h * k[i]);
    let h = 1e-3;
    let mut path = vec![[-8.0, 7.0, 27.0]];
    for _ in 0..3000 {
        let s = path[path.len() - 1];
        let k1 = slope(s);
        let k2 = slope(along(s, k1, h / 2.0));
        let k3 = slope(along(s, k2, h / 2.0));
        let k4 = slope(along(s, k3, h));
        path.push([0, 1, 2].map(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])));
    }
    for seed in [1, 2, 3] {
        let mut normal = normals(seed);
        let rows: Vec<usize> = (0..25).map(|i| 125 * i).collect();
        let columns = (0..3).map(|j| rows.iter().map(|&row| path[row][j] + 0.02 * normal()).collect()).collect();
        let mut problem = Problem::new(lorenz::scene("identify"));
        problem
            .set_group("flow", (0..100).map(|i| f64::from(i) * 3.0 / 99.0).collect::<Vec<f64>>().into(), vec![])
            .unwrap();
        problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
        let times: Vec<f64> = rows.iter().map(|&row| h * row as f64).collect();
        problem.set_group("samples", times.into(), columns).unwrap();
        let mut solution = solve(&problem, Carrier::Auto);
        assert_eq!((solution.carrier, solution.status), ("splines", Status::Converged));
        for (learned, exact) in solution.learned().iter().zip(exact) {
            let deviation = learned.deviation.unwrap();
            assert!((learned.value - exact).abs() < 4.0 * deviation, "{learned:?} is not {exact}");
            assert!(deviation < 0.01 * exact, "{learned:?}");
        }
    }
}

/// A rate of reaction from the temperatures it makes, by differences on a fine grid (Thomas's algorithm).
#[test]
fn a_rate_of_reaction_is_found_from_any_noise() {
    let rate = |x: f64| 0.1 + (-0.5 * ((x - 0.5) / 0.15).powi(2)).exp();
    let count = 4001;
    let h = 1.0 / (count - 1) as f64;
    let (mut upper, mut right) = (vec![0.0; count], vec![0.0; count]);
    for i in 1..count - 1 {
        let x = i as f64 * h;
        let (beside, own) = (0.01 / (h * h), -0.02 / (h * h) - rate(x));
        let pivot = own - beside * upper[i - 1];
        upper[i] = beside / pivot;
        right[i] = ((std::f64::consts::TAU * x).sin() - beside * right[i - 1]) / pivot;
    }
    let mut u = vec![0.0; count];
    for i in (1..count - 1).rev() {
        u[i] = right[i] - upper[i] * u[i + 1];
    }
    let size = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let places: Vec<f64> = (0..101).map(|i| f64::from(i) / 100.0).collect();
    for seed in 1..=6 {
        let mut normal = normals(seed);
        let measured = (0..101).map(|i| u[40 * i] + 0.01 * size * normal()).collect();
        let mut problem = Problem::new(reaction::scene("rate"));
        problem.set_group("inside", places.clone().into(), vec![]).unwrap();
        problem.set_group("left", vec![0.0].into(), vec![]).unwrap();
        problem.set_group("right", vec![1.0].into(), vec![]).unwrap();
        problem.set_group("gauges", places.clone().into(), vec![measured]).unwrap();
        let mut solution = solve(&problem, Carrier::Auto);
        let failed: Vec<_> = solution.verdict.failed().collect();
        assert!(failed.is_empty() && solution.status == Status::Converged, "seed {seed}: {failed:?}");
        assert_eq!(solution.carrier, "splines");
        let estimates = solution.evaluate_with_errors(&places);
        let found = of(&estimates, "k");
        let deviations = found.deviations.as_ref().unwrap();
        let off = |i: usize| (found.values[i] - rate(places[i])).abs();
        let covered = (0..101).filter(|&i| off(i) < 2.0 * deviations[i]).count();
        let error = (0..101).map(off).sum::<f64>() / 101.0;
        assert!(error < 0.2 && covered >= 81, "seed {seed}: {error}, {covered} covered");
    }
}

/// A line through the origin under a Gaussian belief has a closed form: means weigh as much as they are precise.
#[test]
fn a_belief_and_data_weigh_as_much_as_they_are_precise() {
    // Where the spring was pulled to, in cm, and the force there, in mN; N/m times cm are 10 mN.
    let pulls = [(0.1, 3.0), (0.2, 14.0), (0.25, 13.0), (0.3, 20.0)];
    let precision = 0.5_f64.powi(-2) + pulls.iter().map(|(s, _)| (10.0 * s / 3.0_f64).powi(2)).sum::<f64>();
    let mean = (5.0 / 0.25 + pulls.iter().map(|(s, force)| 10.0 * s / 9.0 * force).sum::<f64>()) / precision;
    let mut problem = Problem::new(spring::scene("believed"));
    let places: Vec<f64> = (0..20).map(|i| 0.02 * f64::from(i)).collect();
    problem.set_group("samples", places.clone().into(), vec![places.iter().map(|s| s.sin()).collect()]).unwrap();
    let (pulled, force): (Vec<f64>, Vec<f64>) = pulls.into_iter().unzip();
    problem.set_group("outputs", pulled.into(), vec![force]).unwrap();
    let mut solution = solve(&problem, Carrier::Auto);
    assert_eq!(solution.carrier, "splines");
    let learned = solution.learned()[0].clone();
    let deviation = precision.powf(-0.5);
    // The parameter of a positive scalar is a logarithm, in which the belief is Gaussian too, but not the same.
    assert!((learned.value - mean).abs() < 0.05 * deviation, "{learned:?} instead of {mean}");
    assert!((learned.deviation.unwrap() / deviation - 1.0).abs() < 0.05, "{learned:?} instead of {deviation}");
}

#[test]
fn a_boundary_value_problem_without_data_is_solved() {
    let mut problem = Problem::new(string::scene("loaded"));
    problem.set_group("inside", (0..50).map(|i| f64::from(i) / 49.0).collect::<Vec<f64>>().into(), vec![]).unwrap();
    problem.set_group("left", vec![0.0].into(), vec![]).unwrap();
    problem.set_group("right", vec![1.0].into(), vec![]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged);
    let places: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
    for (x, w) in places.iter().zip(&of(&solution.evaluate(&places), "w").values) {
        let pi = std::f64::consts::PI;
        let exact = (pi * x).sin() / (pi * pi);
        assert!((w - exact).abs() < 1e-7, "{w} instead of {exact} at {x}");
    }
}

#[test]
fn what_splines_do_not_do_is_refused() {
    let bound = |scene: SceneRef| {
        let mut problem = Problem::new(scene);
        let inside: Vec<f64> = (0..50).map(|i| f64::from(i) / 49.0).collect();
        problem.set_group("inside", inside.into(), vec![]).unwrap();
        problem.set_group("gauges", vec![0.2, 0.8].into(), vec![vec![0.1, 0.1]]).unwrap();
        problem
    };
    let error = recover(&bound(summed::scene("loaded")), &settings(Carrier::Splines), &mut |_| Flow::Continue);
    let message = error.err().unwrap().to_string();
    assert_eq!(message, "splines do not do robust losses of integrals; choose a network");
}

/// A residual beside nothing but itself is compared with what the quantity would be elsewhere.
#[test]
fn an_equation_of_one_vanishing_quantity_holds() {
    let mut problem = Problem::new(slack::scene("straight"));
    let inside: Vec<f64> = (0..41).map(|i| f64::from(i) / 40.0).collect();
    problem.set_group("inside", inside.clone().into(), Vec::new()).unwrap();
    problem.set_group("left", vec![0.0].into(), Vec::new()).unwrap();
    problem.set_group("right", vec![1.0].into(), Vec::new()).unwrap();
    let settings = Settings { carrier: Carrier::Splines, ..Settings::default() };
    let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let found = &solution.evaluate(&inside)[0].values;
    assert!(found.iter().zip(&inside).all(|(w, x)| (w - 1.0 - x).abs() < 1e-6), "{found:?}");
}

/// What a gate lets through of [`filling`], and the level behind it.
fn gated(t: f64) -> (f64, f64) {
    use std::f64::consts::{PI, TAU};
    let (open, closed) = (PI / 6.0, 5.0 * PI / 6.0);
    let turn = t % TAU;
    let rising = |t: f64| 1.0 - t.min(open).cos();
    let level =
        rising(turn) + 0.5 * (turn.clamp(open, closed) - open) + rising(open) - rising(PI - turn.clamp(closed, PI));
    let whole = 2.0 * rising(open) + 0.5 * (closed - open);
    (t.sin().clamp(0.0, 0.5), whole * (t / TAU).floor() + level)
}

/// Times, and the answer to a tank's noisy levels there.
fn tank_from(scene: SceneRef, level: impl Fn(f64) -> f64, seed: u64) -> (Vec<f64>, Solution) {
    let mut normal = normals(seed);
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) * 0.04).collect();
    let levels = times.iter().map(|&t| level(t) + 0.01 * normal()).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("filling", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![levels]).unwrap();
    let solution = solve(&problem, Carrier::Auto);
    assert_eq!((solution.carrier, solution.status), ("splines", Status::Converged), "{:?}", solution.verdict);
    (times, solution)
}

#[test]
fn a_source_between_two_bounds_stays_at_both() {
    let (times, mut solution) = tank_from(gate::scene("filled"), |t| gated(t).1, 5);
    let inflow = of(&solution.evaluate_with_errors(&times), "inflow").clone();
    assert!(inflow.values.iter().all(|q| (0.0..=0.5).contains(q)));
    let off: Vec<f64> = times.iter().zip(&inflow.values).map(|(&t, q)| (q - gated(t).0).abs()).collect();
    let size = times.iter().map(|&t| gated(t).0).sum::<f64>() / times.len() as f64;
    let error = off.iter().sum::<f64>() / off.len() as f64;
    assert!(error < 0.1 * size, "{error} of {size}");
    let bars = inflow.deviations.unwrap();
    let beyond = off.iter().zip(&bars).filter(|(off, bar)| **off > 4.0 * **bar).count();
    assert!(20 * beyond < off.len(), "{beyond} of {}", off.len());
    // It is known to be shut where it is shut, and open where it is open.
    let at = |is_there: &dyn Fn(f64) -> bool| {
        let there: Vec<f64> = times.iter().zip(&off).filter(|(t, _)| is_there(t.sin())).map(|(_, off)| *off).collect();
        there.iter().sum::<f64>() / there.len() as f64
    };
    let (shut, open) = (at(&|sine| sine < -0.5), at(&|sine| sine > 0.8));
    assert!(shut < 0.01 * size && open < 0.02 * size, "{shut} and {open} of {size}");
}

/// Inflow of a tank that is filled for a half of each turn, and its level.
fn filling(t: f64) -> (f64, f64) {
    let turn = t % std::f64::consts::TAU;
    let before = 2.0 * (t / std::f64::consts::TAU).floor();
    (t.sin().max(0.0), before + if turn < std::f64::consts::PI { 1.0 - turn.cos() } else { 2.0 })
}

#[test]
fn a_source_with_a_bound_stays_at_it() {
    let (times, solution) = tank_from(tank::scene("filled"), |t| filling(t).1, 3);
    let inflow = of(&solution.evaluate(&times), "inflow").values.clone();
    assert!(inflow.iter().all(|&q| q >= 0.0));
    let error = times.iter().zip(&inflow).map(|(&t, q)| (q - filling(t).0).abs()).sum::<f64>() / times.len() as f64;
    let size = times.iter().map(|&t| filling(t).0).sum::<f64>() / times.len() as f64;
    assert!(error < 0.1 * size, "{error} of {size}");
    // It is known to be nothing where it is nothing: a source without a bound swings there.
    let off: Vec<f64> = times.iter().zip(&inflow).filter(|(t, _)| t.sin() < -0.5).map(|(_, q)| *q).collect();
    let idle = off.iter().sum::<f64>() / off.len() as f64;
    assert!(idle < 0.01 * size, "{idle} of {size}");
}

/// A rate of reaction, the unknown of [`reacting`].
fn rate(x: f64) -> f64 {
    0.3 + 1.2 * (-((x - 0.4) / 0.15).powi(2)).exp()
}

/// Diffusion and reaction under a load that is known at points only, from a field with noise.
fn reacting(gauges: u32, noise: f64) -> Problem {
    let pi = std::f64::consts::PI;
    let load = |x: f64| (0.02 * pi * pi + rate(x)) * (pi * x).sin();
    let places = |count: u32| (0..count).map(|i| f64::from(i) / f64::from(count - 1)).collect::<Vec<f64>>();
    let (inside, gauges) = (places(120), places(gauges));
    let mut problem = Problem::new(loaded_reaction::scene("rate"));
    let loads = inside.iter().map(|&x| load(x)).collect();
    problem.set_group("inside", inside.into(), vec![loads]).unwrap();
    problem.set_group("left", vec![0.0].into(), vec![]).unwrap();
    problem.set_group("right", vec![1.0].into(), vec![]).unwrap();
    let mut normal = normals(11);
    let fields = gauges.iter().map(|x| (pi * x).sin() + noise * normal()).collect();
    problem.set_group("gauges", gauges.into(), vec![fields]).unwrap();
    problem
}

/// Where the field is near zero, at the ends, no data say anything of the rate.
fn middle() -> Vec<f64> {
    (0..81).map(|i| 0.1 + 0.01 * f64::from(i)).collect()
}

#[test]
fn a_rate_is_found_where_the_load_is_known_at_points_only() {
    let solution = solve(&reacting(100, 0.0), Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let at = middle();
    for (x, found) in at.iter().zip(&of(&solution.evaluate(&at), "k").values) {
        assert!((found - rate(*x)).abs() < 1e-4, "{found} at {x}");
    }
}

/// Answers at two tolerances of the equations must not take turns.
#[test]
fn a_rate_from_noisy_data_comes_to_an_end() {
    let settings = Settings { iterations: Some(1000), ..settings(Carrier::Splines) };
    let solution = recover(&reacting(100, 0.007), &settings, &mut |_| Flow::Continue).unwrap();
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let at = middle();
    let found = of(&solution.evaluate(&at), "k").values.clone();
    let error = at.iter().zip(&found).map(|(&x, k)| (k - rate(x)).abs()).sum::<f64>() / at.len() as f64;
    assert!(error < 0.05, "{error}");
}

/// Few gauges ask for wider cells than the load's points, at all of which the equation holds.
#[test]
fn a_rate_is_found_from_few_gauges() {
    for gauges in [20, 25] {
        let solution = solve(&reacting(gauges, 0.005), Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{gauges}: {:?}", solution.verdict);
        let at = middle();
        let found = of(&solution.evaluate(&at), "k").values.clone();
        let error = at.iter().zip(&found).map(|(&x, k)| (k - rate(x)).abs()).sum::<f64>() / at.len() as f64;
        assert!(error < 0.06, "{gauges}: {error}");
    }
}

#[test]
fn terms_of_one_side_do_not_cancel_in_the_size_of_an_equation() {
    // A wave of infections sech^2 leaves 1 - tanh; in `susceptible` both terms are on one side.
    let (most, pace, middle) = (0.1, 0.4, 8.0);
    let y = |t: f64| (most / (pace * (t - middle)).cosh().powi(2)).ln();
    let lost = |t: f64| y(t).exp() + most / pace * (pace * (t - middle)).tanh();
    let beta = |t: f64| (1.0 - 2.0 * pace * (pace * (t - middle)).tanh()) / (1.0 - lost(t) + lost(0.0));
    let times: Vec<f64> = (0..120).map(|i| 16.0 * f64::from(i) / 119.0).collect();
    let mut normal = normals(17);
    let cases = times.iter().map(|&t| y(t) + 0.02 * normal()).collect();
    let mut problem = Problem::new(epidemic::scene("spread"));
    problem.set_group("days", times.clone().into(), vec![]).unwrap();
    problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
    problem.set_group("cases", times.clone().into(), vec![cases]).unwrap();
    problem.set_parameter("y0", y(0.0)).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let found = of(&solution.evaluate(&times), "beta").values.clone();
    let square = |value: &dyn Fn(usize) -> f64| (0..times.len()).map(|i| value(i).powi(2)).sum::<f64>();
    let off = (square(&|i| found[i] - beta(times[i])) / square(&|i| beta(times[i]))).sqrt();
    assert!(off < 0.1, "{off}");
}
