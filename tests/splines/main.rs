//! Splines over one coordinate.

use nisp::solve::driver::Flow;
use nisp::{Carrier, Estimate, Problem, Settings, Solution, recover};

mod averaged;
mod beside;
mod blurred;
mod bounded;
mod conditions;
mod contact;
mod correlated;
mod driven;
mod equations;
mod few;
mod free;
mod gaps;
mod given;
mod large;
mod leaning;
mod levels;
mod measured;
mod oscillator;
mod readings;
mod spoiled;
mod steps;
mod storms;
mod told;

/// Normal numbers, about: sums of twelve uniform ones.
pub(crate) fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

/// States of `d y / d t = slope(t, y)` at times that rise, from the first on: classical steps of Runge and Kutta, twenty from one time to
/// the next.
pub(crate) fn simulated<const N: usize>(
    times: &[f64],
    start: [f64; N],
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let moved = |y: [f64; N], k: [f64; N], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
    let mut states = vec![start];
    for pair in times.windows(2) {
        let step = (pair[1] - pair[0]) / 20.0;
        let mut y = states[states.len() - 1];
        for at in 0..20 {
            let t = pair[0] + step * f64::from(at);
            let a = slope(t, y);
            let b = slope(t + 0.5 * step, moved(y, a, 0.5 * step));
            let c = slope(t + 0.5 * step, moved(y, b, 0.5 * step));
            let d = slope(t + step, moved(y, c, step));
            y = std::array::from_fn(|i| y[i] + step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        states.push(y);
    }
    states
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
