//! What a lattice finds does not depend on the sizes that parameters have beside lengths and times, or on where a temperature is counted from.

use nisp_interpreter::interpret;

use super::sources::{judged, scattered};
use super::*;

interpret! {
    /// A steel rod that something heats always in the same way, between ends of one temperature.
    pub mod steel {
        coordinates: x [m], t [s];
        fields: T [K];
        sources: q(x) [W/m^3];
        parameters: k [W/(m K)] = 15, rho [kg/m^3] = 7800, c [J/(kg K)] = 500, T0 [K] = 0;
        on inside { heat: rho * c * d(T, t) == k * d(T, x, 2) + q; }
        on ends { held: T == T0; }
        on begin { cold: T == T0; }
        on samples { observe T; }
        scene recover { }
    }
}

/// `T = T0 + A (1 - exp(-r t)) sin(pi x / L)` with `r = k (pi / L)^2 / (rho c)` belongs to `q = A r rho c sin(pi x / L)`.
fn found(level: f64, warm: f64, noise: f64) -> (Solution, f64, f64) {
    let [length, time] = [0.1, 600.0];
    let heat = 7800.0 * 500.0;
    let rate = 15.0 / heat * (PI / length).powi(2);
    let mut normal = normals(3);
    let samples = scattered(300, [length, time], 6);
    let measured = pairs(&samples)
        .map(|[x, t]| level + warm * (1.0 - (-rate * t).exp()) * (PI * x / length).sin() + noise * normal())
        .collect();
    let along = |count: usize, i: usize| i as f64 / (count - 1) as f64;
    let mut problem = Problem::new(steel::scene("recover"));
    problem.set_parameter("T0", level).unwrap();
    problem.set_group("inside", grid([28, 28], [length, time], true).into(), Vec::new()).unwrap();
    let ends: Vec<f64> = (0..60).flat_map(|i| [0.0, time * along(60, i), length, time * along(60, i)]).collect();
    problem.set_group("ends", ends.into(), Vec::new()).unwrap();
    let begin: Vec<f64> = (0..60).flat_map(|i| [length * along(60, i), 0.0]).collect();
    problem.set_group("begin", begin.into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    let source = |[x, _]: [f64; 2]| warm * rate * heat * (PI * x / length).sin();
    let (off, within) = judged(&mut solution, "q", &grid([40, 1], [length, time], false), &source);
    (solution, off, within)
}

#[test]
fn a_source_is_found_whatever_conductivity_and_density_are() {
    let (_, off, within) = found(0.0, 10.0, 0.1);
    assert!(off < 0.2 && within > 0.8, "{off} {within}");
}

/// A rod at room temperature that is warmed by a tenth of a kelvin is one at zero.
#[test]
fn a_source_is_found_beside_a_large_level() {
    for level in [0.0, 293.15] {
        let (solution, off, within) = found(level, 0.1, 0.002);
        assert_eq!(solution.status, Status::Converged, "{level}: {:?}", solution.verdict.failed().collect::<Vec<_>>());
        assert!(off < 0.2 && within > 0.8, "{level}: {off} {within}");
    }
}
