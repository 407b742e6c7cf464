//! Weights far apart, points that say too little, and points on which an equation is singular.

use nisp::Problem;
use nisp::engine::Engine;
use nisp::network::{Architecture, initialise};
use nisp::solve::broyden::{Broyden, Update};
use nisp::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use nisp::solve::fault::Kind;
use nisp::solve::gauss_newton::GaussNewton;
use nisp::solve::lbfgs::Lbfgs;
use nisp::solve::marquardt::Marquardt;
use nisp::solve::method::{Method, Verdict};
use nisp::solve::objective::LeastSquares;
use nisp::solve::prior::WeightPrior;
use nisp_interpreter::interpret;

use crate::row::{Extent, Row};
use nisp_references::reference::engine;

interpret! {
    mod film {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: s;
        on inside { balance: laplacian(u) == s * (1 + u^2); }
        on samples { observe u; }
        scene recover { }
    }
}

interpret! {
    mod singular {
        units: off;
        coordinates: x;
        fields: u;
        on kinks { value: u == 0; root: sqrt(u) == 0; size: abs(u) == 0; low: min(u, 0) == 0; }
        on ratios { ratio: u / x == 0; }
        scene kinked { only kinks; }
        scene divided { only ratios; }
    }
}

const SHAPE: fn() -> Architecture = || Architecture::modified(8, 2);

/// The film with its equations at some points and data at others.
fn film_engine(inside: &[f64], samples: &[f64]) -> Engine<f64> {
    let mut problem = Problem::new(film::scene("recover"));
    let u = samples.chunks_exact(2).map(|p| (2.0 * p[0]).sin() * p[1].cosh()).collect();
    let bound = problem
        .set_group("inside", inside.to_vec().into(), Vec::new())
        .and_then(|()| problem.set_group("samples", samples.to_vec().into(), vec![u]));
    bound.expect("groups of the scene");
    engine::<f64>(&problem, SHAPE())
}

fn grid(side: usize) -> Vec<f64> {
    let at = move |i: usize| i as f64 / (side.max(2) - 1) as f64;
    (0..side).flat_map(|i| (0..side).flat_map(move |j| [at(i), at(j)])).collect()
}

/// Steps that moved uphill, or to what is no number; a run that ends with a fault counts too.
fn wrong_steps<M: Method<f64, Engine<f64>>>(mut method: M, engine: &mut Engine<f64>, steps: usize) -> usize {
    let mut before = f64::INFINITY;
    let mut wrong = 0;
    for _ in 0..steps {
        let Ok(step) = method.step(engine) else { return wrong + 1 };
        wrong += usize::from(method.theta().iter().any(|x| !x.is_finite()));
        match step.verdict {
            // Losses that are equal but for rounding are compared by their slopes.
            Verdict::Moved => {
                wrong += usize::from(!step.loss.is_finite() || step.loss > before * (1.0 + 1e-14));
                before = step.loss;
            }
            // Another function from here on.
            Verdict::Changed => before = f64::INFINITY,
            Verdict::Refused | Verdict::Exhausted => {}
            Verdict::Faulty(_) => wrong += 1,
        }
    }
    wrong
}

/// The same for every method that promises descent.
fn all_methods(make: &dyn Fn() -> Engine<f64>, steps: usize) -> (usize, usize) {
    let theta = initialise(make().layout(), 2);
    let prior = || WeightPrior::uniform(1e-6, theta.len());
    let wrong = [
        wrong_steps(Lbfgs::new(theta.clone(), 20), &mut make(), steps),
        wrong_steps(Broyden::new(theta.clone(), Update::SelfScaledBroyden), &mut make(), steps),
        wrong_steps(Marquardt::new(theta.clone(), prior()), &mut make(), steps),
        wrong_steps(GaussNewton::new(theta.clone(), prior(), 50), &mut make(), steps / 2),
        wrong_steps(EmpiricalBayes::new(theta.clone(), prior(), EmpiricalBayesSettings::default()), &mut make(), steps),
    ];
    (9 * steps / 2, wrong.iter().sum())
}

/// Rows and their slopes by the head's bias where `u` is zero, as the language documents them.
fn wrong_kinks() -> (usize, usize) {
    let mut problem = Problem::new(singular::scene("kinked"));
    problem.set_group("kinks", vec![0.0, 0.5, 1.0].into(), Vec::new()).expect("a group of the scene");
    let mut engine = engine::<f64>(&problem, SHAPE());
    let theta = vec![0.0; engine.parameters()];
    let (rows, len, bias) = (engine.rows(), theta.len(), engine.layout().head.bias);
    let (mut r, mut j) = (vec![0.0; rows], vec![0.0; rows * len]);
    if engine.jacobian(&theta, &mut r, &mut j).is_err() {
        return (rows, rows);
    }
    let count = rows / 4;
    let slope = |row: usize| j[row * len + bias];
    let unit = slope(0);
    let right = |row: usize| match row / count {
        0 => slope(row) == unit && unit > 0.0,
        1 | 2 => slope(row) == 0.0,
        _ => (0.0..=1.0).contains(&(slope(row) / unit)),
    };
    let wrong = (0..rows).filter(|&row| !(r[row] == 0.0 && right(row))).count();
    (rows, wrong + j.iter().filter(|x| !x.is_finite()).count())
}

/// Nought over nought is refused, and said where.
fn wrong_ratio() -> usize {
    let mut problem = Problem::new(singular::scene("divided"));
    problem.set_group("ratios", vec![-1.0, 0.5, 0.0, 1.0].into(), Vec::new()).expect("a group of the scene");
    let mut engine = engine::<f64>(&problem, SHAPE());
    let theta = vec![0.0; engine.parameters()];
    let named = engine
        .loss(&theta)
        .err()
        .is_some_and(|fault| fault.term == "ratios.ratio" && fault.point == Some(2) && fault.what == Kind::Residual);
    usize::from(!named)
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let steps = extent.pick(20, 100);
    let points = grid(7);
    let mut rows = Vec::new();
    let mut add = |what: String, make: &dyn Fn() -> Engine<f64>| {
        let (samples, wrong) = all_methods(make, steps);
        rows.push(Row::count(format!("{what}: steps uphill or not finite"), samples, wrong));
    };
    for ratio in [1.0_f64, 1e-8, 1e-4, 1e4, 1e8] {
        add(format!("equations weigh {ratio:e} times the data"), &|| {
            let mut engine = film_engine(&points, &points);
            let sigma = engine.blocks()[0].sigma;
            engine.set_sigma(0, sigma / ratio.sqrt());
            engine
        });
    }
    let repeated: Vec<f64> = (0..5).flat_map(|_| points.clone()).collect();
    add("every point five times".into(), &|| film_engine(&repeated, &repeated));
    let line: Vec<f64> = (0..49).flat_map(|i| [f64::from(i) / 48.0, 0.3 + 0.2 * f64::from(i) / 48.0]).collect();
    add("all points on a line".into(), &|| film_engine(&line, &line));
    add("2 points for 200 parameters".into(), &|| film_engine(&points[..2], &points[2..4]));
    let (samples, wrong) = wrong_kinks();
    rows.push(Row::count(
        "sqrt, abs, min at 0: rows and slopes that are not those of the documentation",
        samples,
        wrong,
    ));
    rows.push(Row::count("0/0 in an equation: not refused with term and point", 1, wrong_ratio()));
    rows
}
