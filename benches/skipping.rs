//! What is skipped, and what it would cost not to.
//!
//! `cargo bench --bench skipping`

#![allow(deprecated, reason = "nothing is solved here, so nothing needs boundary conditions")]

mod support;

use std::hint::black_box;
use std::time::Duration;

use nisp::network::{Architecture, initialise};
use nisp::simd::Isa;
use nisp::solve::objective::Objective;
use nisp::{Problem, SceneRef, scene_in_both_precisions as scene};
use support::{best, group, scatter};

nisp::pde! {
    /// The same equations with more and less asked of them.
    mod plate {
        units: off;
        coordinates: x, y;
        fields: u, v, w;
        sources: f;
        parameters: D = 0.7;
        on inside { balance: D * biharmonic(w) + d(u, x) * d(v, y) == f; }
        on cheap { held: w == 0; }
        on dear { held: w == 0, d(w, x) * d(w, y) == 0, d(w, x, 2) * d(w, y, 2) == d(w, x, y)^2, biharmonic(w) == 0; }
        on tied { tie: u == 0, v == 0, f == 0; }
        scene values { only cheap, tied; }
        scene jets { only dear, tied; }
        scene with_source { only inside, cheap, tied; }
        scene without_source { only inside, cheap; f = 0; u = 0; v = 0; }
        scene fixed { only inside, cheap, tied; }
        scene learned { only inside, cheap, tied; learn D; }
    }
}

nisp::pde! {
    /// A surface seen as a cloud.
    mod sheet {
        units: off;
        coordinates: x, y;
        fields: w;
        on surface { cloud: chamfer [x, y, w]; }
        scene fit { }
    }
}

const POINTS: usize = 4000;

fn problem(scene: SceneRef) -> Problem {
    let mut problem = Problem::new(scene);
    for declared in scene.schema.groups {
        let count = if declared.name == "tied" { 1 } else { POINTS };
        group(&mut problem, declared.name, scatter(count, &[2.0, 2.0]), vec![]);
    }
    problem
}

/// Milliseconds of the loss, and of the loss with its gradient.
fn milliseconds(scene: SceneRef) -> [f64; 2] {
    let problem = problem(scene);
    let mut engine = problem.engine::<f32>(Isa::detect(), Architecture::modified(64, 3)).expect("a bound problem");
    let theta: Vec<f32> = initialise(engine.layout(), 1).into_iter().map(|x| x as f32).collect();
    let mut gradient = vec![0.0; theta.len()];
    let budget = Duration::from_secs(1);
    let forward = best(budget, || {
        black_box(engine.loss(&theta).expect("finite"));
    });
    let both = best(budget, || {
        black_box(engine.loss_and_gradient(&theta, &mut gradient).expect("finite"));
    });
    [forward * 1e3, both * 1e3]
}

/// Milliseconds to see which surface point each point of a cloud belongs to, after a step that changes none of them, and
/// after one that may have changed all.
fn assignments() -> [f64; 2] {
    let mut problem = Problem::new(scene::<sheet::fit::Scene>());
    group(&mut problem, "surface", scatter(3000, &[2.0, 2.0]), vec![]);
    let seen = scatter(2000, &[1.99, 1.99]).coordinates;
    let cloud =
        seen.as_chunks().0.iter().flat_map(|at: &[f64; 2]| [at[0], at[1], (2.0 * at[0]).sin() * at[1]]).collect();
    problem.set_cloud("surface", "cloud", cloud).expect("a term of the scene");
    let mut engine = problem.engine::<f64>(Isa::detect(), Architecture::modified(64, 3)).expect("a bound problem");
    let there = initialise(engine.layout(), 1);
    let [nearby, elsewhere] = [1.0 + 1e-12, -2.0].map(|factor| there.iter().map(|x| factor * x).collect::<Vec<f64>>());
    engine.loss(&there).expect("finite");
    let budget = Duration::from_secs(1);
    let mut back = false;
    let kept = best(budget, || {
        assert!(!engine.accepted(if back { &there } else { &nearby }));
        back = !back;
    });
    back = false;
    let anew = best(budget, || {
        assert!(engine.accepted(if back { &there } else { &elsewhere }));
        back = !back;
    });
    [kept * 1e3, anew * 1e3]
}

fn main() {
    println!("| what is skipped | skipped, ms | not skipped, ms | ratio |\n|---|---|---|---|");
    let row = |what: &str, skipped: f64, whole: f64| {
        println!("| {what} | {skipped:.2} | {whole:.2} | {:.2} |", whole / skipped);
    };
    let [values, jets] =
        [scene::<plate::values::Scene>(), scene::<plate::jets::Scene>()].map(|scene| milliseconds(scene)[1]);
    row("derivatives on a group of values", values, jets);
    let [lean, full] = [scene::<plate::without_source::Scene>(), scene::<plate::with_source::Scene>()]
        .map(|scene| milliseconds(scene)[1]);
    row("heads that the scene sets to zero", lean, full);
    let [fixed, learned] =
        [scene::<plate::fixed::Scene>(), scene::<plate::learned::Scene>()].map(|scene| milliseconds(scene)[1]);
    row("the adjoint of a parameter that is given", fixed, learned);
    let [forward, both] = milliseconds(scene::<plate::with_source::Scene>());
    row("the adjoint, where only values are wanted", forward, both);
    let [kept, anew] = assignments();
    row("assignments of a cloud that cannot have changed", kept, anew);
}
