//! Measurements with gross outliers: an oscillator `x'' + c x' + k x = f` whose force is sought. Position and force are known in
//! closed form.

use nisp::network::Architecture;
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Points, Problem, SceneRef, Settings, Solution, recover, scene};

/// The oscillator, with the suffixes of its measurements.
macro_rules! oscillator {
    ($name:ident, $($suffix:tt)*) => {
        nisp::pde! {
            /// An oscillator.
            mod $name {
                units: off;
                coordinates: t;
                fields: x;
                sources: f;
                on record { observe x $($suffix)*; }
                on times { balance: d(d(x, t), t) + 0.3 * d(x, t) + 4 * x == f; }
                scene force { }
            }
        }
    };
}

oscillator!(square, weight 1);
oscillator!(huber, with huber(3));
oscillator!(welsch, with welsch(2));
oscillator!(tukey, with tukey(4));
oscillator!(known, with tukey(4) within 0.02);

const NOISE: f64 = 0.02;
const COUNT: usize = 200;

/// Position, velocity and acceleration.
fn motion(t: f64) -> [f64; 3] {
    let (s, c) = (1.5 * t).sin_cos();
    let (s3, c3) = (3.0 * t + 0.5).sin_cos();
    [s + 0.3 * s3, 1.5 * c + 0.9 * c3, -2.25 * s - 2.7 * s3]
}

fn force(t: f64) -> f64 {
    let [x, v, a] = motion(t);
    a + 0.3 * v + 4.0 * x
}

/// Numbers between 0 and 1.
fn uniform() -> impl FnMut() -> f64 {
    let mut state = 7u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn times(count: usize) -> Vec<f64> {
    (0..count).map(|i| 6.0 * i as f64 / (count - 1) as f64).collect()
}

/// Positions with noise; of so many, this share is off by up to 3.
fn record(outliers: f64) -> Vec<f64> {
    let mut uniform = uniform();
    let measured = times(COUNT).into_iter().map(|t| {
        // Twelve numbers between 0 and 1 have a sum of variance 1.
        let noise: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let (chance, far) = (uniform(), 6.0 * uniform() - 3.0);
        motion(t)[0] + NOISE * noise + if chance < outliers { far } else { 0.0 }
    });
    measured.collect()
}

fn problem(scene: SceneRef, record: Vec<f64>) -> Problem {
    let mut problem = Problem::new(scene);
    problem.set_group("record", Points::from(times(COUNT)), vec![record]).unwrap();
    problem.set_group("times", Points::from(times(120)), Vec::new()).unwrap();
    problem
}

fn solve(problem: &Problem) -> Solution {
    // Steps end the run, not time.
    let architecture = Architecture { width: 16, layers: 2, ..Settings::default().architecture };
    let settings = Settings {
        architecture,
        optimizer: Optimizer::Evidence,
        budget: None,
        iterations: Some(200),
        threads: 1,
        ..Settings::default()
    };
    recover(problem, &settings, &mut |_| Flow::Continue).unwrap()
}

/// Root mean square error of the force, but for a tenth of the record at either end.
fn error(solution: &Solution) -> f64 {
    let inside: Vec<f64> = times(200).into_iter().filter(|t| (0.6..5.4).contains(t)).collect();
    let found = solution.evaluate(&inside);
    let force_found = &found.iter().find(|estimate| estimate.name == "f").unwrap().values;
    let square: f64 = force_found.iter().zip(&inside).map(|(f, t)| (f - force(*t)).powi(2)).sum();
    (square / inside.len() as f64).sqrt()
}

#[test]
fn a_tenth_of_outliers_does_not_spoil_the_answer() {
    let clean = error(&solve(&problem(scene::<square::force::Scene>(), record(0.0))));
    let spoilt = error(&solve(&problem(scene::<square::force::Scene>(), record(0.1))));
    assert!(spoilt > 3.0 * clean, "outliers matter: {spoilt} beside {clean}");
    // Huber's loss bounds what an outlier does, and the others end it.
    let bounded = error(&solve(&problem(scene::<huber::force::Scene>(), record(0.1))));
    assert!(bounded < 0.5 * spoilt, "huber: {bounded} beside {spoilt}");
    let losses = [
        ("welsch", scene::<welsch::force::Scene>()),
        ("tukey", scene::<tukey::force::Scene>()),
        ("tukey within", scene::<known::force::Scene>()),
    ];
    for (name, scene) in losses {
        let mut solution = solve(&problem(scene, record(0.1)));
        let found = error(&solution);
        let terms = solution.terms();
        let noise = terms.iter().find(|term| term.observation).unwrap().noise.unwrap();
        eprintln!("{name}: {found} beside {clean} and {spoilt}, noise {noise}, {} steps", solution.iterations);
        assert!(found < 1.5 * clean, "{name}: {found} beside {clean}");
        assert!((0.75..1.35).contains(&(noise / NOISE)), "{name}: noise {noise}");
    }
}
