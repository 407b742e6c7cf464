//! Lengths, fields and moduli times 1e-12 to 1e12: the dimensionless loss stays what it is.

use nisp::network::{Architecture, initialise};
use nisp::simd::Isa;
use nisp::{Precision, Problem};
use nisp_interpreter::interpret;

use crate::row::{Extent, Row};

interpret! {
    mod bar {
        coordinates: x [m];
        fields: u [m];
        sources: f [N/m^3];
        parameters: E [Pa], area [m^2];
        on inside { balance: d(E * area * d(u, x), x) + f * area == 0; }
        on end { pull: E * d(u, x) == 0; }
        on samples { observe u; }
        scene recover { }
    }
}

interpret! {
    mod plate {
        coordinates: x [m], y [m];
        fields: w [m];
        sources: p [Pa] >= 0;
        parameters: E [Pa], nu, t [m];
        let D = E * t^3 / (12 * (1 - nu^2));
        on inside { balance: D * biharmonic(w) == p; }
        on rim { held: w == 0; moment: D * laplacian(w) == 0; }
        on samples { observe w; }
        scene recover { }
    }
}

/// Factors on lengths, on the field, and on the modulus.
#[derive(Clone, Copy)]
struct Factors {
    length: f64,
    field: f64,
    modulus: f64,
}

fn bar_problem(by: Factors) -> Problem {
    let mut problem = Problem::new(bar::scene("recover"));
    let x: Vec<f64> = (0..40).map(|i| by.length * f64::from(i) / 39.0).collect();
    let u: Vec<f64> = x.iter().map(|x| by.field * (3.0 * x / by.length).sin()).collect();
    let bound = problem
        .set_parameter("E", by.modulus * 2.0)
        .and_then(|()| problem.set_parameter("area", by.length * by.length * 0.01))
        .and_then(|()| problem.set_group("inside", x.clone().into(), Vec::new()))
        .and_then(|()| problem.set_group("end", vec![by.length].into(), Vec::new()))
        .and_then(|()| problem.set_group("samples", x.into(), vec![u]));
    bound.expect("a bound problem");
    problem
}

fn plate_problem(by: Factors) -> Problem {
    let mut problem = Problem::new(plate::scene("recover"));
    let grid = || (0..6).flat_map(|i| (0..6).map(move |j| [f64::from(i) / 5.0, f64::from(j) / 5.0]));
    let points =
        |keep: fn(&[f64; 2]) -> bool| -> Vec<f64> { grid().filter(keep).flatten().map(|x| by.length * x).collect() };
    let on_rim = |p: &[f64; 2]| p.iter().any(|&x| x == 0.0 || x == 1.0);
    let w: Vec<f64> = grid().map(|[x, y]| by.field * (3.0 * x).sin() * (2.0 * y).cos()).collect();
    let bound = problem
        .set_parameter("E", by.modulus * 2.0)
        .and_then(|()| problem.set_parameter("nu", 0.3))
        .and_then(|()| problem.set_parameter("t", by.length * 0.05))
        .and_then(|()| problem.set_group("inside", points(|_| true).into(), Vec::new()))
        .and_then(|()| problem.set_group("rim", points(on_rim).into(), Vec::new()))
        .and_then(|()| problem.set_group("samples", points(|_| true).into(), vec![w]));
    bound.expect("a bound problem");
    problem
}

/// The loss, and whether its gradient is finite.
fn loss<E: Precision>(problem: &Problem) -> f64 {
    let mut engine = problem.engine::<E>(Isa::detect(), Architecture::modified(12, 3)).expect("a bound problem");
    let theta: Vec<E> = initialise(engine.layout(), 4).iter().map(|&x| E::from_f64(x)).collect();
    let mut gradient = vec![E::ZERO; theta.len()];
    engine.loss_and_gradient(&theta, &mut gradient).unwrap_or(f64::NAN)
}

/// Relative changes of the loss; NaN where one is not finite.
fn changes<E: Precision>(problem: fn(Factors) -> Problem, factors: &[Factors]) -> Vec<f64> {
    let base = loss::<E>(&problem(Factors { length: 1.0, field: 1.0, modulus: 1.0 }));
    factors.iter().map(|&by| (loss::<E>(&problem(by)) / base - 1.0).abs()).collect()
}

/// The largest; NaN if there is one.
fn worst(changes: &[f64]) -> f64 {
    if changes.iter().any(|x| x.is_nan()) { f64::NAN } else { changes.iter().copied().fold(0.0, f64::max) }
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let powers: &[i32] = extent.pick(&[-12, 0, 12], &[-12, -9, -6, -3, 0, 3, 6, 9, 12]);
    let tens = || powers.iter().map(|&n| 10.0_f64.powi(n));
    let factors: Vec<Factors> = tens()
        .flat_map(|length| tens().flat_map(move |field| tens().map(move |modulus| Factors { length, field, modulus })))
        .collect();
    let samples = || format!("{} triples of length, field and modulus", factors.len());
    let mut rows = Vec::new();
    for (name, problem) in [("bar", bar_problem as fn(Factors) -> Problem), ("plate", plate_problem)] {
        let double = worst(&changes::<f64>(problem, &factors));
        rows.push(Row::new(format!("loss of the {name}, f64"), samples(), double, 1e-10));
        let single = worst(&changes::<f32>(problem, &factors));
        rows.push(Row::new(format!("loss of the {name}, f32"), samples(), single, 1e-5));
    }
    rows
}
