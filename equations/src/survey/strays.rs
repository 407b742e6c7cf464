//! Values that stand alone, far off all their neighbours.

use std::num::NonZero;

use nisp::nearest::Nearest;

/// Neighbours that a value is held against, itself among them.
const AROUND: NonZero<usize> = NonZero::new(13).unwrap();
/// How many times the middle half of its neighbours a stray is off that half, and how many deviations of the noise.
const HALVES: f64 = 6.0;
const DEVIATIONS: f64 = 8.0;
/// A stray is off by this share of all values' range at least.
const LEAST: f64 = 0.02;

/// A value that stands alone.
pub(super) struct Stray {
    pub(super) at: usize,
    /// How far it is off the middle half of its neighbours.
    pub(super) off: f64,
}

/// The strays among values at places, point by point; none over more coordinates than are looked at.
pub(super) fn find(places: &[f64], axes: usize, values: &[f64], noise: f64) -> Vec<Stray> {
    match axes {
        1 => over::<1>(places, values, noise),
        2 => over::<2>(places, values, noise),
        3 => over::<3>(places, values, noise),
        4 => over::<4>(places, values, noise),
        _ => Vec::new(),
    }
}

fn over<const D: usize>(places: &[f64], values: &[f64], noise: f64) -> Vec<Stray> {
    let (places, _) = places.as_chunks::<D>();
    let Some(tree) = Nearest::of(places).filter(|_| values.len() > AROUND.get()) else { return Vec::new() };
    let [low, high] = super::range(values.iter().copied());
    let stray = |(at, place): (usize, &[f64; D])| {
        let near = tree.some(place, AROUND).into_iter().filter(|near| near.index != at);
        let mut near: Vec<f64> = near.map(|near| values[near.index]).collect();
        near.sort_by(f64::total_cmp);
        let [first, last] = [near.len() / 4, near.len() - 1 - near.len() / 4].map(|at| near[at]);
        let off = (first - values[at]).max(values[at] - last);
        let limit = HALVES * (last - first) + DEVIATIONS * noise;
        (off > limit.max(LEAST * (high - low))).then_some(Stray { at, off })
    };
    places.iter().enumerate().filter_map(stray).collect()
}
