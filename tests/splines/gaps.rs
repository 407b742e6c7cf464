//! Sources that step where nothing is measured, and what is hidden remembers it.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, simulated, solve};

interpret! {
    /// A heated room whose wall nobody measures.
    mod room {
        units: off;
        coordinates: t;
        fields: air, wall;
        sources: heat;
        on inside { quick: 40 * d(air, t) == heat - 20 * (air - wall); slow: 200 * d(wall, t) == 20 * (air - wall) - 15 * wall; }
        on start { cold: air == 0; frozen: wall == 0; }
        on samples { observe air; }
        scene heating { }
    }
}

const LENGTH: f64 = 40.0;
/// Where nothing is measured.
const GAP: (f64, f64) = (15.0, 21.0);

/// Where in the gap it was that the heat changed is what the wall remembers long after it. A smooth change would be known better than
/// that: bars behind the gap were a tenth of what the answer was off by.
#[test]
fn a_step_in_a_gap_is_covered_behind_it() {
    for (seed, step, heat) in [(1, 16.0, [213.0, 790.0]), (2, 18.5, [620.0, 180.0]), (3, 20.2, [300.0, 850.0])] {
        let all: Vec<f64> = (0..=400).map(|row| LENGTH * f64::from(row) / 400.0).collect();
        let power = |t: f64| heat[usize::from(t >= step)];
        let slope = |t: f64, [air, wall]: [f64; 2]| {
            let through = 20.0 * (air - wall);
            [(power(t) - through) / 40.0, (through - 15.0 * wall) / 200.0]
        };
        let states = simulated(&all, [0.0; 2], slope);
        let mut normal = normals(seed);
        let measured = all.iter().zip(&states).filter(|(t, _)| !(GAP.0..GAP.1).contains(*t));
        let (times, air): (Vec<f64>, Vec<f64>) = measured.map(|(t, state)| (*t, state[0] + 0.03 * normal())).unzip();
        let mut problem = Problem::new(room::scene("heating"));
        problem.set_group("inside", times.clone().into(), vec![]).unwrap();
        problem.set_group("start", vec![0.0].into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![air]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{step}: {:?}", solution.verdict);
        let estimates = solution.evaluate_with_errors(&times);
        let found = of(&estimates, "heat");
        let bars = found.deviations.as_ref().expect("a sound answer has error bars");
        let beyond = |deviations: f64| {
            let rows =
                (0..times.len()).filter(|&row| (found.values[row] - power(times[row])).abs() > deviations * bars[row]);
            rows.count() as f64 / times.len() as f64
        };
        assert!(beyond(2.0) < 0.2 && beyond(4.0) < 0.05, "{step}: {} {}", beyond(2.0), beyond(4.0));
    }
}
