//! Splines on a lattice against closed forms: a conductivity from a noisy field, a source that does not change, loads from clouds,
//! and the same answers from a compiled scene and from its text.

mod across;
mod bounded;
mod clashes;
mod clouds;
mod edges;
mod given;
mod jumps;
mod leaning;
mod mixed;
mod singular;
mod some;
mod sources;
mod swings;
mod units;
mod waves;

use std::f64::consts::PI;
use std::time::Duration;

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, SavedAnswer, SceneRef, Settings, Solution, recover, resume, scene};
use nisp_interpreter::interpret;

nisp::pde! {
    /// A conductivity that varies over a square.
    pub mod conduction {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: a;
        parameters: turn = 1;
        let known_a = 1 + 0.5 * sin(2 * x) * y;
        let known_u = x^2 + turn * x * y + cos(y);
        on inside { balance: div(a * grad(u)) == div(known_a * grad(known_u)); }
        on edge { known: a == known_a; }
        on samples { observe u; }
        scene recover { }
    }
}

nisp::pde! {
    /// A rod that something heats always in the same way.
    pub mod heated {
        units: off;
        coordinates: x, t;
        fields: T;
        sources: q(x);
        parameters: k = 0.5;
        on rod { balance: d(T, t) == k * d(T, x, 2) + q; }
        on ends { held: T == 0; }
        on start { cold: T == 0; }
        on samples { observe T; }
        scene recover { }
        scene with_conductivity { learn k; }
    }
}

interpret! {
    /// Basins that are the wider the farther away, filled from time to time and never emptied.
    pub mod basins {
        units: off;
        coordinates: x, t;
        fields: level;
        sources: inflow >= 0;
        on filling { balance: (1 + x) * d(level, t) == inflow; }
        on samples { observe level; }
        scene recover { }
    }
}

interpret! {
    /// The same basins behind gates that let through no more than a half.
    pub mod gates {
        units: off;
        coordinates: x, t;
        fields: level;
        sources: inflow in 0 .. 0.5;
        on filling { balance: (1 + x) * d(level, t) == inflow; }
        on samples { observe level; }
        scene recover { }
    }
}

interpret! {
    /// Sound of one frequency in a room whose walls give way.
    pub mod sound {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f;
        parameters: k = 7;
        on inside { helmholtz: laplacian(u) + k^2 * u == f; }
        on walls { soft: u == 0; }
        on samples { observe u; }
        scene recover { }
    }
}

interpret! {
    /// A cloud of dye that a stream of unknown speed carries.
    pub mod stream {
        units: off;
        coordinates: x, t;
        fields: u;
        parameters: c = 1;
        on inside { carried: d(u, t) + c * d(u, x) == 0; }
        on samples { observe u; }
        scene identify { learn c; }
    }
}

interpret! {
    /// A square skin under a load that is sought.
    pub mod skin {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f;
        on inside { balance: laplacian(u) + f == 0; }
        on edge { held: u == 0; }
        on samples { observe u; }
        scene recover { }
    }
}

interpret! {
    /// A square plate, free to turn at its edge.
    pub mod plate {
        units: off;
        coordinates: x, y;
        fields: w;
        sources: p;
        on inside { bending: laplacian(laplacian(w)) == p; }
        on edge { held: w == 0; free: laplacian(w) == 0; }
        on samples { observe w; }
        scene recover { }
    }
}

interpret! {
    /// Heat that a rod takes up and passes on.
    pub mod lit {
        units: off;
        coordinates: x, t;
        fields: T;
        sources: q;
        on rod { balance: d(T, t) == 0.05 * d(T, x, 2) + q; }
        on samples { observe T; }
        scene recover { }
    }
}

/// This file, whose equations are read here once more.
const TEXT: &str = include_str!("main.rs");

/// A scene, interpreted: from the braces of the `pde!` that declares its module.
fn interpreted(scene: SceneRef) -> SceneRef {
    let module = format!("mod {} {{", scene.schema.module);
    let text = TEXT.split("pde! {").find(|text| text.contains(&module)).unwrap();
    let (text, _) = text.split_once("\n}\n").unwrap();
    let equation = nisp_interpreter::read(text, "unnamed").unwrap_or_else(|mistakes| panic!("{mistakes}"));
    equation.scenes.into_iter().find(|read| read.schema.name == scene.schema.name).unwrap()
}

/// Points at the centres of a lattice's cells, or at its corners.
fn grid(counts: [usize; 2], sides: [f64; 2], corners: bool) -> Vec<f64> {
    let along = |axis: usize, i: usize| {
        let count = counts[axis] as f64;
        sides[axis] * if corners { i as f64 / (count - 1.0) } else { (i as f64 + 0.5) / count }
    };
    (0..counts[0]).flat_map(|i| (0..counts[1]).flat_map(move |j| [along(0, i), along(1, j)])).collect()
}

fn pairs(points: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    points.as_chunks::<2>().0.iter().copied()
}

/// Normal numbers, about: sums of twelve uniform ones.
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

fn conductivity([x, y]: [f64; 2]) -> f64 {
    1.0 + 0.5 * (2.0 * x).sin() * y
}

/// The square with a field that is measured with noise; `turn` is what the equation takes for the field's.
fn conduction(scene: SceneRef, noise: f64, turn: f64) -> Problem {
    let mut normal = normals(5);
    let samples = grid([24, 24], [1.0, 1.0], true);
    let field = pairs(&samples).map(|[x, y]| x * x + x * y + y.cos() + noise * normal()).collect();
    let edge = (0..25).map(|i| f64::from(i) / 24.0).flat_map(|s| [s, 0.0, s, 1.0, 0.0, s, 1.0, s]);
    let mut problem = Problem::new(scene);
    problem.set_parameter("turn", turn).unwrap();
    problem.set_group("inside", grid([24, 24], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge.collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![field]).unwrap();
    problem
}

/// The rod: with `q = k pi^2 sin(pi x)` its temperature is `(1 - exp(-k pi^2 t)) sin(pi x)`.
fn heated(scene: SceneRef) -> Problem {
    let samples = grid([15, 15], [1.0, 0.4], true);
    let rate = 0.5 * PI * PI;
    let warm = pairs(&samples).map(|[x, t]| (1.0 - (-rate * t).exp()) * (PI * x).sin()).collect();
    let times = (0..25).map(|i| 0.4 * f64::from(i) / 24.0).flat_map(|t| [0.0, t, 1.0, t]).collect::<Vec<f64>>();
    let places = (0..25).flat_map(|i| [f64::from(i) / 24.0, 0.0]).collect::<Vec<f64>>();
    let mut problem = Problem::new(scene);
    problem.set_group("rod", grid([24, 24], [1.0, 0.4], false).into(), Vec::new()).unwrap();
    problem.set_group("ends", times.into(), Vec::new()).unwrap();
    problem.set_group("start", places.into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![warm]).unwrap();
    problem
}

fn settings() -> Settings {
    Settings { budget: Some(Duration::from_secs(100)), threads: 2, ..Settings::default() }
}

fn solve(problem: &Problem) -> Solution {
    recover(problem, &settings(), &mut |_| Flow::Continue).unwrap()
}

/// Values and deviations of a source or field at points.
fn values(solution: &mut Solution, name: &str, points: &[f64]) -> (Vec<f64>, Option<Vec<f64>>) {
    let estimates = solution.evaluate_with_errors(points);
    let own = estimates.into_iter().find(|estimate| estimate.name == name).unwrap();
    (own.values, own.deviations)
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = values.map(|x| x * x).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn a_conductivity_is_found_with_bars_that_hold() {
    let mut solution = solve(&conduction(scene::<conduction::recover::Scene>(), 0.01, 1.0));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places = grid([20, 20], [1.0, 1.0], false);
    let (found, deviations) = values(&mut solution, "a", &places);
    let off: Vec<f64> = found.iter().zip(pairs(&places)).map(|(a, place)| a - conductivity(place)).collect();
    assert!(root_mean_square(off.iter().copied()) < 0.03, "{}", root_mean_square(off.iter().copied()));
    let deviations = deviations.unwrap();
    let within = off.iter().zip(&deviations).filter(|(off, deviation)| off.abs() <= 2.0 * **deviation).count();
    assert!(within as f64 > 0.8 * off.len() as f64, "{within} of {}", off.len());
}

#[test]
fn an_equation_that_the_data_contradict_is_inconsistent() {
    let solution = solve(&conduction(scene::<conduction::recover::Scene>(), 0.01, -1.0));
    assert!(!solution.verdict.passed() && solution.status != Status::Converged);
}

/// Walls that reflect have the waves of cosines, which are largest where the conditions ask for none: cells that bend in a strip
/// along the walls, between the points of the equation, meet both.
#[test]
fn a_wrong_condition_at_a_wall_is_noticed() {
    let waves = [(1.0, 1.0, 0.8), (2.0, 1.0, 0.6), (1.0, 3.0, 0.4), (2.0, 2.0, -0.5)];
    for (wave, is_right) in [(f64::sin as fn(f64) -> f64, true), (f64::cos, false)] {
        let sum = |[x, y]: [f64; 2], of: &dyn Fn(f64) -> f64| -> f64 {
            waves.iter().map(|(m, n, a)| of(m * m + n * n) * a * wave(m * PI * x) * wave(n * PI * y)).sum()
        };
        let mut normal = normals(8);
        let samples = grid([20, 20], [1.0, 1.0], true);
        let measured = pairs(&samples).map(|place| sum(place, &|_| 1.0) + 2e-3 * normal()).collect();
        let walls = (0..40).map(|i| f64::from(i) / 39.0).flat_map(|s| [s, 0.0, s, 1.0, 0.0, s, 1.0, s]);
        let mut problem = Problem::new(sound::scene("recover"));
        problem.set_group("inside", grid([20, 20], [1.0, 1.0], false).into(), Vec::new()).unwrap();
        problem.set_group("walls", walls.collect::<Vec<f64>>().into(), Vec::new()).unwrap();
        problem.set_group("samples", samples.into(), vec![measured]).unwrap();
        let settings = Settings { carrier: Carrier::Splines, ..settings() };
        let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
        assert_eq!(solution.verdict.passed(), is_right, "{:?}", solution.verdict.checks);
        let places = grid([15, 15], [1.0, 1.0], false);
        let (found, deviations) = values(&mut solution, "f", &places);
        assert_eq!(deviations.is_some(), is_right);
        let exact = |place| sum(place, &|squares| 49.0 - PI * PI * squares);
        let off = root_mean_square(found.iter().zip(pairs(&places)).map(|(f, place)| f - exact(place)));
        assert!(!is_right || off < 0.1 * root_mean_square(pairs(&places).map(exact)), "{off}");
    }
}

#[test]
fn an_answer_that_steps_still_change_is_not_called_right() {
    let mut problem = heated(scene::<heated::with_conductivity::Scene>());
    problem.set_parameter("k", 2.0).unwrap();
    for iterations in 3..=12 {
        let settings = Settings { carrier: Carrier::Splines, iterations: Some(iterations), ..settings() };
        let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
        let off = (solution.learned()[0].value / 0.5 - 1.0).abs();
        assert!(!solution.verdict.passed() || off < 0.01, "{iterations} steps: {off} off");
    }
}

#[test]
fn an_equation_is_asked_between_points_that_are_few() {
    // Rows of points that are close along `x` and far apart along `t`.
    let (points, places) = (grid([25, 12], [2.0, 1.0], true), grid([20, 8], [2.0, 1.0], true));
    let exact = pairs(&places).map(|[x, t]| (-((x - 0.4 * t - 0.7) / 0.3).powi(2)).exp()).collect();
    let mut problem = Problem::new(stream::scene("identify"));
    problem.set_group("inside", points.into(), vec![]).unwrap();
    problem.set_group("samples", places.into(), vec![exact]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let off = solution.learned()[0].value / 0.4 - 1.0;
    assert!(off.abs() < 1e-4, "{off}");
}

#[test]
fn a_source_that_does_not_change_is_found_from_exact_data() {
    let mut solution = solve(&heated(scene::<heated::recover::Scene>()));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places = grid([20, 3], [1.0, 0.4], false);
    let (found, _) = values(&mut solution, "q", &places);
    let exact = |[x, _]: [f64; 2]| 0.5 * PI * PI * (PI * x).sin();
    let off = root_mean_square(found.iter().zip(pairs(&places)).map(|(q, place)| q - exact(place)));
    assert!(off < 2e-3 * root_mean_square(pairs(&places).map(exact)), "{off}");
    // The saved answer has the same values, which do not depend on the time.
    let saved = SavedAnswer::from_bytes(&solution.saved().unwrap().to_bytes()).unwrap();
    let opened = saved.open(scene::<heated::recover::Scene>()).unwrap();
    let again = opened.evaluate(&places);
    let own = again.iter().find(|quantity| quantity.name == "q").unwrap();
    assert_eq!(own.values, found);
}

/// A field bends most where a source sets in; what is believed of it beforehand must not flatten the source.
#[test]
fn a_narrow_source_that_sets_in_at_the_start_is_not_flattened() {
    // Sines of the rod that add up to two bells, and how they warm it from rest.
    let bell =
        |middle: f64, width: f64, n: f64| (-(n * PI * width).powi(2) / 2.0).exp() * width * (n * PI * middle).sin();
    let part = |n: f64| 2.0 * (2.0 * PI).sqrt() * (0.6 * bell(0.3, 0.06, n) + 2.0 * bell(0.65, 0.08, n));
    let sum = |x: f64, of: &dyn Fn(f64) -> f64| -> f64 {
        (1..=30).map(f64::from).map(|n| of(n) * part(n) * (n * PI * x).sin()).sum()
    };
    let warm = |[x, t]: [f64; 2]| {
        sum(x, &|n| {
            let rate = 0.5 * (n * PI).powi(2);
            (1.0 - (-rate * t).exp()) / rate
        })
    };
    let samples: Vec<f64> =
        (1..=20).flat_map(|j| (1..=9).flat_map(move |i| [f64::from(i) / 10.0, 0.06 * f64::from(j)])).collect();
    let mut normal = normals(3);
    let measured = pairs(&samples).map(|place| warm(place) + 6e-4 * normal()).collect();
    let mut problem = Problem::new(scene::<heated::recover::Scene>());
    problem.set_group("rod", grid([20, 40], [1.0, 1.2], false).into(), Vec::new()).unwrap();
    let ends = (0..80).flat_map(|i| [0.0, 1.0].into_iter().flat_map(move |x| [x, 1.2 * f64::from(i) / 79.0]));
    problem.set_group("ends", ends.collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let start = (0..160).flat_map(|i| [f64::from(i) / 159.0, 0.0]);
    problem.set_group("start", start.collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places = grid([60, 1], [1.0, 1.2], false);
    let (found, deviations) = values(&mut solution, "q", &places);
    let exact = || pairs(&places).map(|[x, _]| sum(x, &|_| 1.0));
    let off = root_mean_square(found.iter().zip(exact()).map(|(q, exact)| q - exact));
    assert!(off < 0.12 * root_mean_square(exact()), "{off}");
    let within =
        found.iter().zip(deviations.unwrap()).zip(exact()).filter(|((q, sd), exact)| (*q - exact).abs() < 2.0 * sd);
    assert!(within.count() >= 48, "fewer than four fifths of 60 places are within two deviations");
}

#[test]
fn a_text_has_the_answer_of_the_compiled_scene() {
    let answers = |compiled: SceneRef, bind: &dyn Fn(SceneRef) -> Problem, name: &str| {
        let places = grid([9, 9], [1.0, 0.4], false);
        let [compiled, read] = [compiled, interpreted(compiled)].map(|scene| {
            let mut solution = solve(&bind(scene));
            (values(&mut solution, name, &places), solution.learned(), solution.iterations)
        });
        assert_eq!(compiled.2, read.2);
        let size = root_mean_square(compiled.0.0.iter().copied());
        let apart = root_mean_square(compiled.0.0.iter().zip(&read.0.0).map(|(a, b)| a - b));
        // Rounding, times the condition of the normal equations of rows that are a hundred thousand times as strict as others: by the
        // noise and by the order of elimination it is anything from none to a ten-thousandth.
        assert!(apart < 5e-4 * size, "{name}: {apart:e} of {size:e}");
        for (a, b) in compiled.1.iter().zip(&read.1) {
            assert!((a.value - b.value).abs() < 1e-5 * a.value.abs(), "{}: {} {}", a.name, a.value, b.value);
        }
    };
    answers(scene::<conduction::recover::Scene>(), &|scene| conduction(scene, 0.01, 1.0), "a");
    answers(scene::<heated::recover::Scene>(), &heated, "q");
}

#[test]
fn a_resumed_run_has_the_bits_of_one_that_did_not_stop() {
    let problem = conduction(scene::<conduction::recover::Scene>(), 0.01, 1.0);
    let settings = Settings { carrier: Carrier::Splines, ..settings() };
    let mut whole = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let mut kept = None;
    let _ = recover(&problem, &settings, &mut |report| {
        if report.iteration == 7 {
            kept = Some((report.checkpoint)());
            return Flow::Stop;
        }
        Flow::Continue
    });
    let mut resumed = resume(&problem, &settings, &kept.unwrap(), &mut |_| Flow::Continue).unwrap();
    let places = grid([5, 5], [1.0, 1.0], false);
    assert_eq!(values(&mut whole, "a", &places).0, values(&mut resumed, "a", &places).0);
}

/// Places, and the inflow of basins there that is found from noisy levels.
fn inflows(scene: SceneRef, level: impl Fn([f64; 2]) -> f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut normal = normals(seed);
    let samples = grid([12, 60], [1.0, 3.0 * PI], true);
    let measured = pairs(&samples).map(|at| level(at) + 0.01 * normal()).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("filling", samples.clone().into(), vec![]).unwrap();
    problem.set_group("samples", samples.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(
        (solution.carrier, solution.status),
        ("splines on a lattice", Status::Converged),
        "{:?}",
        solution.verdict
    );
    let inside = grid([7, 90], [1.0, 3.0 * PI], false);
    let (found, _) = values(&mut solution, "inflow", &inside);
    (inside, found)
}

#[test]
fn a_source_between_two_bounds_stays_at_both() {
    // The inflow is sin t between nothing and a half, for a turn and a half.
    let inflow = |[_, t]: [f64; 2]| t.sin().clamp(0.0, 0.5);
    let (open, closed) = (PI / 6.0, 5.0 * PI / 6.0);
    let rising = |t: f64| 1.0 - t.min(open).cos();
    let filled =
        |t: f64| rising(t) + 0.5 * (t.clamp(open, closed) - open) + rising(open) - rising(PI - t.clamp(closed, PI));
    let level = |[x, t]: [f64; 2]| (filled(PI) * (t / (2.0 * PI)).floor() + filled(t % (2.0 * PI))) / (1.0 + x);
    let (inside, found) = inflows(gates::scene("recover"), level, 12);
    assert!(found.iter().all(|q| (0.0..=0.5).contains(q)));
    let exact: Vec<f64> = pairs(&inside).map(inflow).collect();
    let off = root_mean_square(found.iter().zip(&exact).map(|(q, exact)| q - exact));
    let size = root_mean_square(exact.iter().copied());
    assert!(off < 0.15 * size, "{off} of {size}");
}

#[test]
fn a_source_with_a_bound_stays_at_it() {
    // The inflow is max(0, sin t)^2, for a turn and a half.
    let inflow = |[_, t]: [f64; 2]| t.sin().max(0.0).powi(2);
    let filled = |t: f64| 0.5 * t - 0.25 * (2.0 * t).sin();
    let level = |[x, t]: [f64; 2]| (0.5 * PI * (t / (2.0 * PI)).floor() + filled((t % (2.0 * PI)).min(PI))) / (1.0 + x);
    let (inside, found) = inflows(basins::scene("recover"), level, 11);
    assert!(found.iter().all(|&q| q >= 0.0));
    let exact: Vec<f64> = pairs(&inside).map(inflow).collect();
    let off = root_mean_square(found.iter().zip(&exact).map(|(q, exact)| q - exact));
    let size = root_mean_square(exact.iter().copied());
    assert!(off < 0.1 * size, "{off} of {size}");
    let idle: Vec<f64> =
        found.iter().zip(pairs(&inside)).filter(|(_, [_, t])| t.sin() < -0.5).map(|(q, _)| *q).collect();
    let most = idle.iter().copied().fold(0.0, f64::max);
    assert!(most < 0.05, "{most}");
}
