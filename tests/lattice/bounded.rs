//! Fields with bounds, of which equations take derivatives.

use nisp_interpreter::interpret;

use super::sources::judged;
use super::*;

interpret! {
    /// Dye in a layer, which is never less than none; more of it comes in from somewhere.
    pub mod dye {
        units: off;
        coordinates: x, t;
        fields: c >= 0;
        sources: q;
        parameters: D = 0.05;
        on layer { spread: d(c, t) - D * d(c, x, 2) == q; }
        on walls { gone: c == 0; }
        on start { clear: c == 0; }
        on probes { observe c; }
        scene recover { }
    }
}

interpret! {
    /// Dye that decays at an unknown rate, in two directions.
    pub mod decaying {
        units: off;
        coordinates: x, y;
        fields: c > 0;
        parameters: k = 1;
        on pond { spread: laplacian(c) == k * c; }
        on probes { observe c; }
        scene rate { learn k; }
    }
}

/// `c = 16 x^2 (1 - x)^2 t^2 exp(-t)` touches its bound, with its slopes, at both walls and where it begins.
#[test]
fn a_field_that_touches_its_bound_has_the_source_of_its_derivatives() {
    let shape = |x: f64| 16.0 * (x * (1.0 - x)).powi(2);
    let bend = |x: f64| 16.0 * (2.0 - 12.0 * x + 12.0 * x * x);
    let dye = |[x, t]: [f64; 2]| shape(x) * t * t * (-t).exp();
    let inflow = |[x, t]: [f64; 2]| (shape(x) * (2.0 * t - t * t) - 0.05 * bend(x) * t * t) * (-t).exp();
    let probes = grid([24, 24], [1.0, 3.0], true);
    let mut normal = normals(7);
    let seen: Vec<f64> = pairs(&probes).map(|place| dye(place) + 0.005 * normal()).collect();
    let line = |i: i32| f64::from(i) / 24.0;
    let walls: Vec<f64> = (0..25).flat_map(|i| [0.0, 3.0 * line(i), 1.0, 3.0 * line(i)]).collect();
    let mut problem = Problem::new(dye::scene("recover"));
    problem.set_group("layer", grid([30, 30], [1.0, 3.0], false).into(), vec![]).unwrap();
    problem.set_group("walls", walls.into(), vec![]).unwrap();
    problem.set_group("start", (0..25).flat_map(|i| [line(i), 0.0]).collect::<Vec<f64>>().into(), vec![]).unwrap();
    problem.set_group("probes", probes.into(), vec![seen]).unwrap();
    let settings = Settings { carrier: Carrier::Splines, ..settings() };
    let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let (off, within) = judged(&mut solution, "q", &grid([15, 15], [1.0, 3.0], false), &inflow);
    assert!(off < 0.15 && within > 0.9, "{off} {within}");
    let (off, _) = judged(&mut solution, "c", &grid([15, 15], [1.0, 3.0], true), &dye);
    assert!(off < 0.01, "{off}");
}

/// `c = exp(x + y / 2)` decays at a rate of 5 / 4, and by sums of second derivatives.
#[test]
fn a_rate_is_found_from_a_field_that_is_positive() {
    let mut normal = normals(9);
    let probes = grid([20, 20], [1.0, 1.0], true);
    let seen: Vec<f64> = pairs(&probes).map(|[x, y]| (x + y / 2.0).exp() * (1.0 + 0.002 * normal())).collect();
    let mut problem = Problem::new(decaying::scene("rate"));
    problem.set_group("pond", grid([20, 20], [1.0, 1.0], false).into(), vec![]).unwrap();
    problem.set_group("probes", probes.into(), vec![seen]).unwrap();
    let settings = Settings { carrier: Carrier::Splines, ..settings() };
    let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    assert_eq!(solution.status, Status::Converged);
    let found = &solution.learned()[0];
    let bar = found.deviation.unwrap();
    assert!((found.value - 1.25).abs() < 4.0 * bar && bar < 0.1, "{found:?}");
}
