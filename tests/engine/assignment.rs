//! Clouds and the surfaces that they are assigned to, step by step.

use nisp::engine::Engine;
use nisp::network::Architecture;
use nisp::solve::adam::{Adam, AdamSettings};
use nisp::solve::driver::{Flow, Limits, resume, run};
use nisp::solve::fault::Fault;
use nisp::solve::method::{Method, Verdict};
use nisp::solve::objective::{LeastSquares, Objective};
use nisp::{Points, Problem, SceneRef, scene};

use nisp_references::reference::engine;

nisp::pde! {
    mod line {
        units: off;
        coordinates: x;
        fields: w;
        on line {
            cloud: chamfer [x, w];
            tilted: chamfer [x - d(w, x) / 10, w];
            robust: symmetric plane chamfer [x, w] with huber(0.3);
            straight: d(w, x, 2) == 0;
        }
        /// Values alone.
        scene values { without line.tilted, line.robust, line.straight; }
        /// Derivatives beside the surface.
        scene bending { without line.tilted, line.robust; }
        /// A surface of derivatives.
        scene offset { without line.cloud, line.robust, line.straight; }
        /// Rows that depend on where the surface is.
        scene moving { without line.cloud, line.tilted; }
    }
}

const POINTS: usize = 40;
const SEEN: usize = 60;

fn cloud() -> Vec<f64> {
    (0..SEEN).flat_map(|i| [(i as f64 * 0.618).fract(), (i as f64 * 0.37).sin()]).collect()
}

fn problem(scene: SceneRef) -> Problem {
    let mut problem = Problem::new(scene);
    problem
        .set_group("line", (0..POINTS).map(|i| i as f64 / POINTS as f64).collect::<Vec<f64>>().into(), vec![])
        .unwrap();
    for term in ["cloud", "tilted", "robust"] {
        if scene.schema.groups[0].terms.iter().any(|declared| declared.name == term) {
            problem.set_cloud("line", term, cloud()).unwrap();
        }
    }
    problem
}

fn bound(scene: SceneRef) -> Engine<f64> {
    engine(&problem(scene), Architecture::modified(8, 2))
}

/// Parameters of a step.
fn theta(step: usize, len: usize) -> Vec<f64> {
    (0..len).map(|i| ((i * 7 + 3) as f64).sin() + 0.03 * step as f64 * (i as f64).cos()).collect()
}

fn scenes() -> [SceneRef; 4] {
    [
        scene::<line::values::Scene>(),
        scene::<line::bending::Scene>(),
        scene::<line::offset::Scene>(),
        scene::<line::moving::Scene>(),
    ]
}

/// Assignments are frozen until a step is accepted, and found again by looking at every point.
#[test]
fn assignments_follow_accepted_steps() {
    for scene in scenes().into_iter().take(3) {
        let mut engine = bound(scene);
        let size = engine.blocks()[0].sigma;
        let len = engine.parameters();
        for step in 0..12 {
            let now = theta(step, len);
            let before = engine.loss(&now).unwrap();
            let changed = engine.accepted(&now);
            let after = engine.loss(&now).unwrap();
            assert_eq!(changed, before != after, "step {step}");
            let mut counted = vec![0.0; engine.rows()];
            engine.residuals(&now, &mut counted).unwrap();
            let found: f64 = counted[engine.blocks()[0].rows.clone()].iter().map(|r| r * r).sum();
            let rows = engine.raw_rows(0, &now);
            let nearest = |y: &[f64]| -> f64 {
                let squares = (0..POINTS).map(|p| (rows[p] - y[0]).powi(2) + (rows[POINTS + p] - y[1]).powi(2));
                squares.fold(f64::INFINITY, f64::min)
            };
            let expected = cloud().chunks_exact(2).map(nearest).sum::<f64>() / SEEN as f64 / (size * size);
            assert!((found - expected).abs() <= 1e-12 * expected, "step {step}: {found} {expected}");
            assert!(!engine.accepted(&now), "nothing has moved");
        }
    }
}

/// What is assigned follows from the parameters alone, to the bit, whatever was assigned on the way to them.
#[test]
fn the_way_to_an_iterate_leaves_no_trace() {
    for scene in scenes() {
        let mut travelled = bound(scene);
        let len = travelled.parameters();
        for step in 0..12 {
            let now = theta(step, len);
            travelled.refresh(&now);
            let mut fresh = bound(scene);
            let [mut here, mut there] = [vec![0.0; len], vec![0.0; len]];
            let losses = [travelled.gradient(&now, &mut here).unwrap(), fresh.gradient(&now, &mut there).unwrap()];
            assert!(losses[0] == losses[1] && here == there, "{} step {step}: {losses:?}", scene.schema.name);
        }
    }
}

/// An engine whose gradients are counted, some of them with a fault.
struct Counted {
    engine: Engine<f64>,
    gradients: usize,
    faulty: Vec<usize>,
}

impl Objective<f64> for Counted {
    fn len(&self) -> usize {
        self.engine.len()
    }

    fn value(&mut self, theta: &[f64]) -> Result<f64, Fault> {
        self.engine.value(theta)
    }

    fn gradient(&mut self, theta: &[f64], gradient: &mut [f64]) -> Result<f64, Fault> {
        self.gradients += 1;
        let loss = self.engine.gradient(theta, gradient)?;
        if self.faulty.contains(&self.gradients) { Err(Fault::gradient("gradient", None)) } else { Ok(loss) }
    }

    fn accepted(&mut self, theta: &[f64]) -> bool {
        self.engine.accepted(theta)
    }

    fn refresh(&mut self, theta: &[f64]) -> bool {
        self.engine.refresh(theta)
    }
}

/// Adam's steps, long enough that assignments change at many of them.
fn adam(objective: &impl Objective<f64>) -> Adam<f64> {
    Adam::new(theta(0, objective.len()), AdamSettings { rate: 0.03, ..AdamSettings::default() })
}

/// One gradient a step, though the cloud belongs elsewhere after it; a step that is refused leaves nothing behind.
#[test]
fn adam_follows_a_cloud_at_the_cost_of_one_gradient_a_step() {
    for scene in scenes() {
        let mut objective = Counted { engine: bound(scene), gradients: 0, faulty: vec![9, 10] };
        let method: &mut dyn Method<f64, Counted> = &mut adam(&objective);
        for step in 0..20 {
            let before = method.theta().to_vec();
            let taken = method.step(&mut objective).unwrap();
            assert_eq!(matches!(taken.verdict, Verdict::Faulty(_)), step == 7 || step == 8);
            assert_eq!(method.theta() == before, step == 7 || step == 8);
            // Of the function that the cloud makes when it is assigned to this very surface.
            let here = objective.engine.loss(method.theta()).unwrap();
            assert_eq!(here, bound(scene).loss(method.theta()).unwrap(), "{} step {step}", scene.schema.name);
            assert_eq!(here, taken.loss, "{} step {step}", scene.schema.name);
        }
        assert_eq!(objective.gradients, 21, "{}", scene.schema.name);
    }
}

#[test]
fn adam_resumes_beside_a_cloud_to_the_bit() {
    for scene in scenes() {
        let limits = |iterations| Limits { iterations, ..Limits::default() };
        let mut engine = bound(scene);
        let whole = run(&mut adam(&engine), &mut engine, limits(30), &mut |_| Flow::Continue);
        let mut engine = bound(scene);
        let half = run(&mut adam(&engine), &mut engine, limits(15), &mut |_| Flow::Continue);
        let mut engine = bound(scene);
        let mut method = adam(&engine);
        let rest = resume(&mut method, &mut engine, &half.state, limits(30), &mut |_| Flow::Continue).unwrap();
        assert_eq!(whole.state, rest.state, "{}", scene.schema.name);
    }
}

#[test]
fn what_is_bound_to_a_cloud_is_checked() {
    let bound = |cloud: Vec<f64>| {
        let mut problem = Problem::new(scene::<line::values::Scene>());
        problem.set_group("line", Points::from(vec![0.0, 0.5, 1.0]), vec![]).unwrap();
        problem.set_cloud("line", "cloud", cloud).unwrap();
        let architecture = Architecture::plain(5, 1);
        problem.engine::<f64>(nisp::simd::Isa::detect(), architecture).map(|_| ()).unwrap_err().to_string()
    };
    assert!(bound(vec![]).contains("`cloud` has no cloud"), "{}", bound(vec![]));
    assert!(bound(vec![1.0, 2.0, 3.0]).contains("3 numbers where 4"), "{}", bound(vec![1.0, 2.0, 3.0]));
    assert!(bound(vec![1.0, 2.0, f64::NAN, 3.0]).contains("not finite at point 1"));
}
