//! What rests on a stop: a force that acts only where a place is zero.

use nisp::{Carrier, Problem, scene};

use crate::{normals, of, solve};

nisp::pde! {
    /// A damper on a spring, driven against a stop.
    mod damper {
        units: off;
        coordinates: t;
        fields: x;
        sources: N;
        on motion { columns: F; balance: 2 * d(x, t) + 5 * (x - 0.1) == F + N; touch: 0 <= N _|_ x >= 0; }
        on samples { observe x; }
        scene stopped { }
    }
}

fn drive(t: f64) -> f64 {
    (1.1 * t).sin()
}

/// The place and the stop's force, by small steps that end at the stop, where the force bears what the drive and the spring leave.
fn motion(times: &[f64]) -> Vec<[f64; 2]> {
    const STEPS: u32 = 1000;
    let (mut x, mut states) = (0.1_f64, vec![[0.1, 0.0]]);
    for pair in times.windows(2) {
        let step = (pair[1] - pair[0]) / f64::from(STEPS);
        for at in 0..STEPS {
            let t = pair[0] + step * f64::from(at);
            x = (x + step * (drive(t) - 5.0 * (x - 0.1)) / 2.0).max(0.0);
        }
        let bears = (-drive(pair[1]) - 0.5).max(0.0);
        states.push([x, if x > 0.0 { 0.0 } else { bears }]);
    }
    states
}

/// The place is zero at all rows of a contact, and must be zero between them.
#[test]
fn the_force_of_a_stop_does_not_go_to_and_fro_between_rows() {
    for rows in [301, 401] {
        let times: Vec<f64> = (0..rows).map(|row| 12.0 * f64::from(row) / f64::from(rows - 1)).collect();
        let states = motion(&times);
        let mut normal = normals(3);
        let places = states.iter().map(|[x, _]| x + 1e-3 * normal()).collect();
        let mut problem = Problem::new(scene::<damper::stopped::Scene>());
        problem.set_group("motion", times.clone().into(), vec![times.iter().map(|&t| drive(t)).collect()]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![places]).unwrap();
        let mut solution = solve(&problem, Carrier::Splines);
        let found = solution.evaluate_with_errors(&times);
        let force = of(&found, "N");
        let off: Vec<f64> = force.values.iter().zip(&states).map(|(found, [_, force])| (found - force).abs()).collect();
        let size = states.iter().map(|[_, force]| force * force).sum::<f64>();
        let square = off.iter().map(|off| off * off).sum::<f64>();
        assert!(square < 0.1_f64.powi(2) * size, "{rows} rows: {}", (square / size).sqrt());
        let Some(deviations) = &force.deviations else { continue };
        let beyond = off.iter().zip(deviations).filter(|(off, deviation)| **off > 4.0 * **deviation).count();
        assert!(20 * beyond < off.len(), "{rows} rows: {beyond} beyond four deviations");
    }
}
