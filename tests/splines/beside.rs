//! Scalars that are learned beside a free source, where the source that is smallest is not the true one.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, Solution};
use nisp_interpreter::interpret;

use crate::{normals, simulated, solve};

interpret! {
    /// A body on a spring that a force moves: what does it weigh?
    mod body {
        units: off;
        coordinates: t;
        fields: x;
        sources: f;
        parameters: m > 0 = 1, c = 0.4, k = 12;
        on motion { balance: m * d(x, t, 2) + c * d(x, t) + k * x == f; }
        on samples { observe x; }
        scene weighed { learn m; }
    }
}

interpret! {
    /// A body that is heated, and loses heat.
    mod heated {
        units: off;
        coordinates: t;
        fields: T;
        sources: P;
        parameters: C > 0 = 1, h > 0 = 0.5;
        on body { balance: C * d(T, t) + h * T == P; }
        on start { cold: T == 0; }
        on samples { observe T; }
        scene capacity { learn C; }
        scene loss { learn h; }
    }
}

/// An answer from measurements with a noise of a hundredth of their size.
fn answered(mut problem: Problem, equation: &str, times: &[f64], motion: &[f64]) -> Solution {
    let mut normal = normals(5);
    let size = motion.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let measured = motion.iter().map(|x| x + 0.01 * size * normal()).collect();
    problem.set_group(equation, times.to_vec().into(), vec![]).unwrap();
    problem.set_group("samples", times.to_vec().into(), vec![measured]).unwrap();
    solve(&problem, Carrier::Splines)
}

/// The same problem with its start at zero.
fn begun(mut problem: Problem) -> Problem {
    problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
    problem
}

/// That the only learned scalar is near its value, by its deviation and by itself.
fn assert_near(solution: &mut Solution, exact: f64) {
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let [learned] = &solution.learned()[..] else { panic!("one scalar") };
    let (off, deviation) = ((learned.value - exact).abs(), learned.deviation.unwrap());
    assert!(off < 4.0 * deviation && off < 0.05 * exact, "{learned:?} is not {exact}");
}

/// No mass would ask for a smaller force, and for motions that look like no other.
#[test]
fn a_body_is_weighed_beside_a_force_that_steps() {
    let times: Vec<f64> = (0..300).map(|i| 0.05 * f64::from(i)).collect();
    let force = |t: f64| if t > 6.0 { 5.0 } else { 0.0 };
    let slope = |t, [x, v]: [f64; 2]| [v, (force(t) - 0.4 * v - 12.0 * x) / 1.3];
    let motion: Vec<f64> = simulated(&times, [0.3, 0.0], slope).iter().map(|[x, _]| *x).collect();
    let problem = Problem::new(body::scene("weighed"));
    assert_near(&mut answered(problem, "motion", &times, &motion), 1.3);
}

/// An even heater: the temperature rises by an exponential to its end, which tells both the loss and the capacity.
#[test]
fn what_a_heated_body_takes_up_and_loses_is_told_by_an_even_heater() {
    let times: Vec<f64> = (0..200).map(|i| 0.06 * f64::from(i)).collect();
    let (power, start) = (2.0, [1.0, 0.5]);
    let motion = |capacity: f64, loss: f64| -> Vec<f64> {
        times.iter().map(|t| power / loss * (1.0 - (-loss * t / capacity).exp())).collect()
    };
    let [capacity, loss] = [1.6, 0.8];
    let of = begun(Problem::new(heated::scene("capacity")));
    assert_near(&mut answered(of, "body", &times, &motion(capacity, start[1])), capacity);
    let of = begun(Problem::new(heated::scene("loss")));
    assert_near(&mut answered(of, "body", &times, &motion(start[0], loss)), loss);
}
