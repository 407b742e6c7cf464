//! Where problems become singular: bodies that hardly change their volume, plates without thickness, long times. Each error is
//! divided by that of the benign case.

use std::f64::consts::PI;

use nisp::local::Local;
use nisp::network::Architecture;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Optimizer, Points, Problem, Settings, Solution, Width, recover};
use nisp_equations::{Request, catalogue};
use nisp_interpreter::interpret;

use crate::row::{Extent, Row};

interpret! {
    /// Plane strain in displacements alone.
    mod compact {
        coordinates: x [m], y [m];
        fields: u: vector [m];
        parameters: E [Pa], nu;
        let mu = E / (2 * (1 + nu));
        let lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
        let eps = sym(grad(u));
        let sigma = lambda * tr(eps) * I + 2 * mu * eps;
        on inside { columns: b: vector [N/m^3]; balance: div(sigma) + b == 0; }
        on rim { columns: held: vector [m]; fixed: u == held; }
        scene solve { }
    }
}

interpret! {
    /// Plane strain with the pressure as a field of its own.
    mod mixed {
        coordinates: x [m], y [m];
        fields: u: vector [m], p [Pa];
        parameters: E [Pa], nu;
        let mu = E / (2 * (1 + nu));
        let sigma = 2 * mu * sym(grad(u)) - p * I;
        on inside {
            columns: b: vector [N/m^3];
            balance: div(sigma) + b == 0;
            volume: div(u) + p * (1 + nu) * (1 - 2 * nu) / (E * nu) == 0;
        }
        on rim { columns: held: vector [m]; fixed: u == held; }
        scene solve { }
    }
}

interpret! {
    /// Something that follows a slow cosine.
    mod relaxation {
        coordinates: t [s];
        fields: u [V];
        parameters: rate [1/s], slow [1/s], first [V], size [V];
        on flow { law: d(u, t) == rate * (size * cos(slow * t) - u); }
        on start { known: u == first; }
        scene solve { }
    }
}

fn solve(problem: &Problem, iterations: u64, seed: u64, local: Option<Local>) -> Option<Solution> {
    let settings = Settings {
        optimizer: if local.is_some() { Optimizer::Auto } else { Optimizer::Broyden },
        precision: Width::F64,
        architecture: Architecture { width: 16, ..Settings::default().architecture },
        iterations: Some(iterations),
        budget: None,
        seed,
        carrier: local.map_or(Carrier::Network, Carrier::Local),
        ..Settings::default()
    };
    recover(problem, &settings, &mut |_| Flow::Continue).ok()
}

/// What came out.
struct Answer {
    /// Mean distance of heads from the truth, over its mean size; NaN without a solution.
    error: f64,
    /// The user was told that it is not converged, or what is wrong with it.
    is_told: bool,
}

impl Answer {
    fn of(solution: Option<Solution>, at: &[f64], truth: &[(&str, Vec<f64>)]) -> Self {
        let Some(solution) = solution else { return Self { error: f64::NAN, is_told: true } };
        let estimates = solution.evaluate(at);
        let (mut off, mut size) = (0.0, 0.0);
        for (name, truth) in truth {
            let found = estimates.iter().find(|estimate| estimate.name == *name).expect("a head of the scene");
            off += found.values.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum::<f64>();
            size += truth.iter().map(|x| x.abs()).sum::<f64>();
        }
        Self { error: off / size, is_told: solution.status != Status::Converged || !solution.warnings.is_empty() }
    }
}

/// The mean over seeds: runs of a fixed number of steps end at errors that scatter.
fn mean(answers: impl ExactSizeIterator<Item = Answer>) -> Answer {
    let count = answers.len() as f64;
    let both = |a: Answer, b: Answer| Answer { error: a.error + b.error, is_told: a.is_told && b.is_told };
    let all = answers.fold(Answer { error: 0.0, is_told: true }, both);
    Answer { error: all.error / count, ..all }
}

/// A square of a metre whose divergence-free displacement is known for every Poisson's ratio.
fn displacement(x: f64, y: f64) -> [f64; 2] {
    [1e-3 * (PI * x).sin() * (PI * y).cos(), -1e-3 * (PI * x).cos() * (PI * y).sin()]
}

/// Midpoints of a grid, flat.
fn grid(side: usize) -> Vec<f64> {
    let at = move |i: usize| (i as f64 + 0.5) / side as f64;
    (0..side).flat_map(|i| (0..side).flat_map(move |j| [at(i), at(j)])).collect()
}

/// One component of the displacement at flat points, times a factor.
fn component(points: &[f64], axis: usize, factor: f64) -> Vec<f64> {
    points.chunks_exact(2).map(|p| factor * displacement(p[0], p[1])[axis]).collect()
}

fn elastic_error(scene: nisp::SceneRef, nu: f64, side: usize, iterations: u64, local: Option<Local>) -> Answer {
    const E: f64 = 1e5;
    let mut problem = Problem::new(scene);
    let inside = grid(side);
    let rim: Vec<f64> = (0..4 * side)
        .flat_map(|i| {
            let s = (i % side) as f64 / side as f64;
            [[s, 0.0], [1.0, s], [1.0 - s, 1.0], [0.0, 1.0 - s]][i / side]
        })
        .collect();
    // -div sigma = -mu laplacian(u) = 2 pi^2 mu u
    let load = 2.0 * PI * PI * E / (2.0 * (1.0 + nu));
    let weights = vec![1.0 / (side * side) as f64; side * side];
    let columns = |points: &[f64], factor: f64| vec![component(points, 0, factor), component(points, 1, factor)];
    let points = Points { coordinates: inside.clone(), weights, ..Points::default() };
    let bound = problem
        .set_parameter("E", E)
        .and_then(|()| problem.set_parameter("nu", nu))
        .and_then(|()| problem.set_group("inside", points, columns(&inside, load)))
        .and_then(|()| problem.set_group("rim", rim.clone().into(), columns(&rim, 1.0)));
    bound.expect("a bound problem");
    let at = grid(17);
    let truth = [("u_x", component(&at, 0, 1.0)), ("u_y", component(&at, 1, 1.0))];
    let seeds = if local.is_some() { 1 } else { SEEDS };
    mean((0..seeds).map(|seed| Answer::of(solve(&problem, iterations, seed.into(), local), &at, &truth)))
}

fn plate_error(thickness_mm: f64, iterations: u64) -> Answer {
    let entry = catalogue().into_iter().find(|entry| entry.name == "plate").expect("an entry");
    let request = Request { parameters: vec![("t".into(), thickness_mm)], ..Request::default() };
    let prepared = entry.prepare(&request).expect("the repository's example");
    // Its defaults, in SI units; the deflection comes in millimetres.
    let (young, nu, pressure, radius) = (1e9, 0.5, 2757.0, 0.04_f64);
    let stiffness = young * (1e-3 * thickness_mm).powi(3) / (12.0 * (1.0 - nu * nu));
    let deflection =
        |p: &[f64]| 1e3 * pressure * (radius * radius - p[0] * p[0] - p[1] * p[1]).powi(2) / (64.0 * stiffness);
    let truth = [("w", prepared.points.chunks_exact(2).map(deflection).collect())];
    Answer::of(solve(&prepared.problem, iterations, 0, None), &prepared.points, &truth)
}

fn relaxation_error(rate: f64, end: f64, iterations: u64) -> Answer {
    let (slow, first) = (6.0 / end, 0.2);
    let uniform = (0..=100).map(|i| end * f64::from(i) / 100.0);
    let logarithmic = (0..100).map(|i| 1e-2 / rate * (rate * end / 1e-2).powf(f64::from(i) / 100.0));
    let times: Vec<f64> = uniform.chain(logarithmic).collect();
    let mut problem = Problem::new(relaxation::scene("solve"));
    let parameters = [("rate", rate), ("slow", slow), ("first", first), ("size", 1.0)];
    for (name, value) in parameters {
        problem.set_parameter(name, value).expect("a parameter");
    }
    let bound = problem
        .set_group("flow", times.clone().into(), Vec::new())
        .and_then(|()| problem.set_group("start", vec![0.0].into(), Vec::new()));
    bound.expect("a bound problem");
    let share = rate / (rate * rate + slow * slow);
    let exact = |t: &f64| {
        share * (rate * (slow * t).cos() + slow * (slow * t).sin()) + (first - share * rate) * (-rate * t).exp()
    };
    let truth = [("u", times.iter().map(exact).collect())];
    mean((0..SEEDS).map(|seed| Answer::of(solve(&problem, iterations, seed.into(), None), &times, &truth)))
}

/// A row for each case but the first, which is the benign one: its error over that of the benign case. Then how many that are
/// worse than they should be pass for a good answer.
fn series(what: &str, name: &str, cases: &[f64], of: &dyn Fn(f64) -> Answer, missing: (f64, &'static str)) -> Vec<Row> {
    let benign = of(cases[0]).error;
    let (mut rows, mut silent) = (Vec::new(), 0);
    for case in &cases[1..] {
        let Answer { error, is_told } = of(*case);
        let samples = format!("{error:.1e} against {benign:.1e} at {name} = {}", cases[0]);
        let row =
            Row::new(format!("{what}, {name} = {case}: error over the benign one's"), samples, error / benign, 2.0);
        silent += usize::from(!row.passes() && !is_told);
        rows.push(row.missing(missing.0, missing.1));
    }
    let what = format!("{what}: worse than that, and called converged without a warning");
    rows.push(Row::count(what, cases.len() - 1, silent));
    rows
}

/// Initial weights that errors of networks are averaged over.
const SEEDS: u32 = 3;

const FULL_NU: [f64; 5] = [0.1, 0.45, 0.499, 0.4999, 0.49999];

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let (side, steps) = extent.pick((8, 150), (14, 2000));
    let nus: &[f64] = extent.pick(&[0.1, 0.4999], &FULL_NU);
    let local =
        |cells| Some(Local { cells, coarser: 3, degree: 3, tests: 1, finer: 1, source_dimensions: 2, patches: None });
    let (displacements, pressure) = (|| compact::scene("solve"), || mixed::scene("solve"));
    let mut rows = series(
        "elasticity with a pressure field, network",
        "nu",
        nus,
        &|nu| elastic_error(pressure(), nu, side, steps, None),
        (20.0, "the pressure is left to the gradient in the balance alone, so that as many steps lead less far"),
    );
    let locking =
        "in displacements alone the volume is a penalty that grows with 1/(1 - 2 nu); declare a pressure field";
    rows.extend(series(
        "elasticity in displacements, network",
        "nu",
        nus,
        &|nu| elastic_error(displacements(), nu, side, steps, None),
        (1e6, locking),
    ));
    let cells = extent.pick(8, 16);
    rows.extend(series(
        "elasticity with a pressure field, local functions",
        "nu",
        nus,
        &|nu| elastic_error(pressure(), nu, 3 * cells, 30, local(cells)),
        (1e6, "displacement and pressure have splines of one degree, and equations a tolerance of a hundredth of their size"),
    ));
    let stiff = "the splines' error in the volume counts 1/(1 - 2 nu) times; what moves with the lattice by over a hundredth of \
                 its size is said; declare a pressure field";
    let mut locked = series(
        "elasticity in displacements, local functions",
        "nu",
        nus,
        &|nu| elastic_error(displacements(), nu, 3 * cells, 30, local(cells)),
        (1e6, stiff),
    );
    if let Some(silent) = locked.last_mut() {
        (silent.held, silent.why) = (
            extent.pick(0.0, 1.0),
            "an answer that moves with the lattice by less than a hundredth passes for resolved",
        );
    }
    rows.extend(locked);
    let thin: &[f64] = extent.pick(&[0.3, 3e-5], &[0.3, 0.03, 3e-3, 3e-5, 3e-7]);
    let plate_steps = extent.pick(25, 600);
    let held = (2.0, "");
    rows.extend(series("plate, network", "t in mm", thin, &|t| plate_error(t, plate_steps), held));
    let ends: &[f64] = extent.pick(&[1.0, 1e6], &[1.0, 1e3, 1e6]);
    let time_steps = extent.pick(60, 1500);
    rows.extend(series(
        "relaxation with rate 3/T over [0, T]",
        "T in s",
        ends,
        &|end| relaxation_error(3.0 / end, end, time_steps),
        (4.0, "errors of some billionths scatter by as much from seed to seed"),
    ));
    if extent == Extent::Full {
        let layer = "a layer of a second in so long a record takes more than a small network has";
        rows.extend(series(
            "relaxation with rate 1/s over [0, T]",
            "T in s",
            &[10.0, 1e3, 1e6],
            &|end| relaxation_error(1.0, end, time_steps),
            (1e6, layer),
        ));
    }
    rows
}
