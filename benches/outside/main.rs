//! What kernels of a user's crate do a second, for every instruction set at hand: gradients of von Karman's equations.
//!
//! `benches/outside/run` builds this file as a crate outside of the workspace too, and compares.

// Nothing is measured in a scene that is timed and not solved, which the macro warns of.
#![allow(deprecated)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use nisp::network::{Architecture, initialise};
use nisp::simd::Isa;
use nisp::{Precision, Problem, scene_in_both_precisions as scene};

nisp::pde! {
    mod membrane {
        coordinates: a [m], b [m];
        fields: u [m], v [m], w [m];
        sources: f [Pa] >= 0;
        parameters: E [Pa] = 341260, nu = 0.5, t [mm] = 0.45, p [Pa] = 5700;
        let D = E * t^3 / (12 * (1 - nu^2));
        let C = E * t / (1 - nu^2);
        let E_aa = d(u, a) + d(w, a)^2 / 2;
        let E_bb = d(v, b) + d(w, b)^2 / 2;
        let E_ab = (d(u, b) + d(v, a) + d(w, a) * d(w, b)) / 2;
        let N_a = C * (E_aa + nu * E_bb);
        let N_b = C * (E_bb + nu * E_aa);
        let N_ab = C * (1 - nu) * E_ab;
        on interior {
            balance: D * biharmonic(w) - (N_a * d(w, a, 2) + 2 * N_ab * d(w, a, b) + N_b * d(w, b, 2)) == p - f;
            inplane_a: d(N_a, a) + d(N_ab, b) == 0;
            inplane_b: d(N_ab, a) + d(N_b, b) == 0;
        }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }
        scene contact { }
    }
}

const POINTS: usize = 600;

/// Points a second through a gradient, best of many, on one thread. Width 32: the emitted rules are a good half of the work.
fn rate<E: Precision>(problem: &Problem, isa: Isa) -> f64 {
    let mut engine = problem.engine::<E>(isa, Architecture::modified(32, 4)).expect("a bound problem");
    let theta: Vec<E> = initialise(engine.layout(), 1).into_iter().map(E::from_f64).collect();
    let mut gradient = vec![E::ZERO; theta.len()];
    let (begin, mut best) = (Instant::now(), f64::INFINITY);
    while begin.elapsed() < Duration::from_secs(1) {
        let start = Instant::now();
        black_box(engine.loss_and_gradient(&theta, &mut gradient).expect("finite"));
        best = best.min(start.elapsed().as_secs_f64());
    }
    POINTS as f64 / best
}

fn main() {
    let point = |i: usize| [(i as f64 * 0.7549).fract() * 0.12, (i as f64 * 0.5698).fract() * 0.08];
    let points: Vec<f64> = (0..POINTS).flat_map(point).collect();
    let mut problem = Problem::new(scene::<membrane::contact::Scene>());
    problem.set_group("interior", points.into(), Vec::new()).expect("a group of the scene");
    problem.set_group("rim", vec![0.0, 0.0].into(), Vec::new()).expect("a group of the scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        for isa in Isa::available() {
            println!("{} f32 {:.0}", isa.name(), rate::<f32>(&problem, isa));
            println!("{} f64 {:.0}", isa.name(), rate::<f64>(&problem, isa));
        }
    });
}
