//! A field that varies by a millionth of its level: an equation reads its difference to another level, and that alone counts.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// A tank whose pressure leaks away to that of its surroundings.
    mod tank {
        units: off;
        coordinates: t;
        fields: p;
        sources: inflow;
        parameters: around = 1e6;
        on inside { balance: d(p, t) == -(p - around) / 8 + inflow; }
        on samples { observe p; }
        scene leaking { }
    }
}

const ROWS: usize = 300;

fn over(t: f64) -> f64 {
    (0.5 * t).sin() + 0.5 * (0.23 * t).cos()
}

fn inflow(t: f64) -> f64 {
    0.5 * (0.5 * t).cos() - 0.115 * (0.23 * t).sin() + over(t) / 8.0
}

/// With the level in the sizes of the equation, the inflow was off by a quarter of itself where pressures are exact, and called right; beside
/// noise nothing was told of it.
#[test]
fn an_inflow_is_found_beside_a_large_level() {
    for (noise, most) in [(0.0, 0.01), (0.01, 0.03)] {
        let times: Vec<f64> = (0..ROWS).map(|row| 0.2 * row as f64).collect();
        let mut normal = normals(1);
        let pressures = times.iter().map(|&t| 1e6 + over(t) + noise * normal()).collect();
        let mut problem = Problem::new(tank::scene("leaking"));
        problem.set_group("inside", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![pressures]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
        let estimates = solution.evaluate_with_errors(&times);
        let found = &of(&estimates, "inflow").values;
        let square = |of: &dyn Fn(usize) -> f64| (0..ROWS).map(|row| of(row).powi(2)).sum::<f64>();
        let off = square(&|row| found[row] - inflow(times[row])) / square(&|row| inflow(times[row]));
        assert!(off.sqrt() < most, "{noise}: {}", off.sqrt());
    }
}
