//! What the benchmarks share.

use std::time::{Duration, Instant};

use nisp::{Points, Problem};

/// Points that fill a box from the origin evenly: multiples of the golden ratio's generalisation (Roberts).
pub(crate) fn scatter(count: usize, extents: &[f64]) -> Points {
    let ratio = (0..60).fold(2.0_f64, |g, _| (1.0 + g).powf(1.0 / (extents.len() as f64 + 1.0)));
    let steps: Vec<f64> = (1..=extents.len() as i32).map(|i| ratio.powi(-i)).collect();
    let point = |n: usize| steps.iter().zip(extents).map(move |(step, extent)| extent * (n as f64 * step).fract());
    (1..=count).flat_map(point).collect::<Vec<f64>>().into()
}

/// Binds a group of a scene that is known to have it.
pub(crate) fn group(problem: &mut Problem, name: &str, points: Points, columns: Vec<Vec<f64>>) {
    problem.set_group(name, points, columns).expect("a group of the scene");
}

/// Shortest time of one call, in seconds, over about `budget`: on a shared machine the least disturbed of many.
pub(crate) fn best(budget: Duration, mut work: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut best = f64::INFINITY;
    while begin.elapsed() < budget {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}
