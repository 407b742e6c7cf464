//! Splines over one coordinate.

use nisp::solve::driver::Flow;
use nisp::{Carrier, Estimate, Problem, Settings, Solution, recover};

mod bounded;
mod driven;
mod equations;
mod few;
#[expect(deprecated, reason = "a lint says that nothing pins a field, which is what is asked here")]
mod free;
mod leaning;
mod measured;
mod oscillator;
mod steps;

/// Normal numbers, about: sums of twelve uniform ones.
pub(crate) fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

/// Steps end the run, not time.
pub(crate) fn settings(carrier: Carrier) -> Settings {
    Settings { carrier, budget: None, ..Settings::default() }
}

pub(crate) fn solve(problem: &Problem, carrier: Carrier) -> Solution {
    recover(problem, &settings(carrier), &mut |_| Flow::Continue).unwrap()
}

pub(crate) fn of<'a>(estimates: &'a [Estimate], name: &str) -> &'a Estimate {
    estimates.iter().find(|estimate| estimate.name == name).unwrap()
}
