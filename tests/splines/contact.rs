//! Bounds that set in and let go along a record.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// A cart with friction on a spring, and the push of the stop that it meets.
    mod stop {
        units: off;
        coordinates: t;
        fields: x;
        sources: n;
        parameters: k = 1;
        on motion { columns: f; balance: d(x, t) + k * x == f + n; touch: 0 <= n _|_ x >= 0; }
        on samples { observe x; }
        scene met { }
    }
}

interpret! {
    /// The same in three terms.
    mod apart {
        units: off;
        coordinates: t;
        fields: x;
        sources: n;
        on motion {
            columns: f;
            balance: d(x, t) + x == f + n;
            pushes: n >= 0;
            gap: x >= 0;
            either: n * x == 0;
        }
        on samples { observe x; }
        scene met { }
    }
}

const END: f64 = 6.5;
const NOISE: f64 = 0.01;

/// With `f = cos t - sin t` a free cart is at `cos t`. It meets the stop at a quarter of a turn, where its speed jumps and with it the
/// push, and leaves it at five eighths, from where on the exponential is what is left of that.
fn force(t: f64) -> f64 {
    t.cos() - t.sin()
}

const MEETS: f64 = std::f64::consts::FRAC_PI_2;
const LEAVES: f64 = 1.25 * std::f64::consts::PI;

fn place(t: f64) -> f64 {
    match t {
        _ if t < MEETS => t.cos(),
        _ if t < LEAVES => 0.0,
        _ => t.cos() + std::f64::consts::FRAC_1_SQRT_2 * (LEAVES - t).exp(),
    }
}

fn push(t: f64) -> f64 {
    if (MEETS..LEAVES).contains(&t) { -force(t) } else { 0.0 }
}

fn times(count: usize) -> Vec<f64> {
    (0..count).map(|i| END * i as f64 / (count - 1) as f64).collect()
}

/// The problem with as many rows, each at a time of the drive.
fn bound(mut problem: Problem, rows: usize, seed: u64) -> Solution {
    let (rows, mut normal) = (times(rows), normals(seed));
    let measured = rows.iter().map(|&t| place(t) + NOISE * normal()).collect();
    problem.set_group("motion", rows.clone().into(), vec![rows.iter().map(|&t| force(t)).collect()]).unwrap();
    problem.set_group("samples", rows.into(), vec![measured]).unwrap();
    solve(&problem, Carrier::Splines)
}

/// At the rows and between them; next to the jump no spline is right.
fn is_right(mut solution: Solution) {
    let failed: Vec<&String> = solution.verdict.failed().map(|check| &check.message).collect();
    assert!(solution.status == Status::Converged && failed.is_empty(), "{failed:?}");
    let at = times(401);
    let answer = solution.evaluate_with_errors(&at);
    let (found, bars) = (&of(&answer, "n").values, of(&answer, "n").deviations.as_ref().unwrap());
    let off: Vec<f64> = at.iter().zip(found).map(|(&t, n)| (n - push(t)).abs()).collect();
    let share = |is: &dyn Fn(usize) -> bool| (0..at.len()).filter(|&i| is(i)).count() as f64 / at.len() as f64;
    assert!(share(&|i| off[i] > 0.1) < 0.05, "{}", share(&|i| off[i] > 0.1));
    assert!(share(&|i| off[i] > 4.0 * bars[i] + 1e-3) < 0.05, "{}", share(&|i| off[i] > 4.0 * bars[i] + 1e-3));
    // It rests at the stop, and does not go to and fro about it from row to row.
    let gap = &of(&answer, "x").values;
    let resting = at.iter().zip(gap).filter(|(t, _)| (MEETS + 0.3..LEAVES - 0.3).contains(*t));
    let most = resting.map(|(_, x)| x.abs()).fold(0.0, f64::max);
    assert!(most < 0.3 * NOISE, "{most:.2e}");
}

#[test]
fn a_stop_that_is_met_and_left_pushes_as_it_does_between_the_rows_too() {
    for (rows, seed) in [(121, 3), (201, 4)] {
        is_right(bound(Problem::new(stop::scene("met")), rows, seed));
    }
}

#[test]
fn the_same_in_three_terms_is_the_same() {
    is_right(bound(Problem::new(apart::scene("met")), 121, 5));
}

/// With another spring the record and the stop contradict each other.
#[test]
fn a_stop_that_cannot_have_pushed_so_is_doubted() {
    let mut problem = Problem::new(stop::scene("met"));
    problem.set_parameter("k", 1.3).unwrap();
    let solution = bound(problem, 121, 3);
    assert!(!solution.verdict.passed());
}
