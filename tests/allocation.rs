//! A step of a warm solver allocates nothing: its memory is laid out once, when the problem is bound. Only where a cloud may
//! belong elsewhere than before is there a tree to build.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use nisp::engine::Engine;
use nisp::network::{Architecture, Fourier, Inputs, initialise};
use nisp::simd::Isa;
use nisp::solve::adam::{Adam, AdamSettings};
use nisp::solve::method::Method;
use nisp::{Points, Precision, Problem, scene_in_both_precisions as scene};

nisp::pde! {
    /// Every kind of term that gradients go through.
    mod heat {
        units: off;
        coordinates: x, t;
        fields: T;
        sources: q >= 0;
        parameters: k = 0.7;
        on inside { balance: d(T, t) == d(k * d(T, x), x) + q; }
        on probes { observe T with huber(0.5); }
        on whole { energy: integral(T * q) == 1.5 * k; }
        /// A surface so flat that the cloud above it stays assigned as it is.
        on sheet { seen: chamfer [x, t, T / 1000]; }
        scene recover { learn k; }
    }
}

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn problem() -> Problem {
    let points =
        |count: usize| -> Points { (0..2 * count).map(|i| (i as f64 * 0.618).fract()).collect::<Vec<f64>>().into() };
    let mut problem = Problem::new(scene::<heat::recover::Scene>());
    problem.set_group("inside", points(300), vec![]).expect("a group");
    problem.set_group("probes", points(50), vec![(0..50).map(|i| f64::from(i).sin()).collect()]).expect("a group");
    let grid: Vec<f64> = (0..100).flat_map(|i| [f64::from(i % 10), f64::from(i / 10)]).map(|x| 0.1 * x).collect();
    let above = grid.as_chunks().0.iter().flat_map(|&[x, t]| [x + 0.01, t, 0.02]).collect();
    problem.set_group("sheet", grid.into(), vec![]).expect("a group");
    problem.set_cloud("sheet", "seen", above).expect("a term");
    problem.set_group("whole", points(80), vec![]).expect("a group");
    problem
}

/// Allocations of 20 steps after as many to warm up.
fn allocations_of_steps<E: Precision>(problem: &Problem, architecture: Architecture) -> usize {
    let mut engine: Engine<E> = problem.engine(Isa::detect(), architecture).expect("a bound problem");
    let theta = initialise(engine.layout(), 1).into_iter().map(E::from_f64).collect();
    let mut method = Adam::new(theta, AdamSettings::default());
    let mut steps = || {
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        for _ in 0..20 {
            method.step(&mut engine).expect("finite");
        }
        ALLOCATIONS.load(Ordering::Relaxed) - before
    };
    steps();
    steps()
}

#[test]
fn a_warm_step_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let mapped = Inputs::Fourier(Fourier { frequencies: 6, deviation: 1.0 });
    // The last is wide enough for the optimizer's update to be shared out.
    for architecture in [
        Architecture::modified(24, 3),
        Architecture { factorised: true, inputs: mapped, ..Architecture::plain(16, 2) },
        Architecture::modified(128, 3),
    ] {
        let problem = problem();
        pool.install(|| {
            assert_eq!(allocations_of_steps::<f32>(&problem, architecture), 0, "f32 {architecture:?}");
            assert_eq!(allocations_of_steps::<f64>(&problem, architecture), 0, "f64 {architecture:?}");
        });
    }
}
