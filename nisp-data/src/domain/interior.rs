//! Points inside a domain. Each stands for an equal share of it.

use super::round::in_ball;
use super::sequence::{GOLDEN_TURN, unit_cube};
use super::{Domain, Points, Sampling, Shape};

impl Domain {
    /// About `count` points (exactly, but for a grid) with weights that add up to [`Domain::measure`].
    pub fn interior(&self, count: usize, sampling: Sampling, seed: u64) -> Points {
        let dim = self.dim();
        let coords = match &self.shape {
            Shape::Box { low, high } => in_box(low, high, count, sampling, seed),
            Shape::Ellipse { centre, semi_axes } => in_ellipse(*centre, *semi_axes, count, sampling, seed),
            Shape::Ball { centre, radius } => in_ball(*centre, *radius, count, sampling, seed),
            Shape::Polygon { .. } | Shape::Cylinder { .. } | Shape::Solid(_) | Shape::Pair(_) => {
                self.by_rejection(count, sampling, seed)
            }
        };
        let actual = coords.len() / dim;
        let weights = Some(vec![self.measure() / actual.max(1) as f64; actual]);
        Points { dim, coords, normals: None, weights }
    }

    /// Points of the surrounding box that lie inside.
    fn by_rejection(&self, count: usize, sampling: Sampling, seed: u64) -> Vec<f64> {
        let (low, high) = self.bounds();
        let box_measure: f64 = low.iter().zip(&high).map(|(a, b)| b - a).product();
        let share = self.measure() / box_measure;
        let mut tries = (count as f64 / share).ceil() as usize;
        loop {
            let drawn = in_box(&low, &high, tries, sampling, seed);
            let dim = self.dim();
            let inside: Vec<f64> = drawn.chunks(dim).filter(|point| self.contains(point)).flatten().copied().collect();
            if sampling == Sampling::Grid {
                return inside;
            }
            if inside.len() >= dim * count {
                return inside[..dim * count].to_vec();
            }
            tries += tries / 8 + 8;
        }
    }
}

fn in_box(low: &[f64], high: &[f64], count: usize, sampling: Sampling, seed: u64) -> Vec<f64> {
    let dim = low.len();
    let unit = match sampling {
        Sampling::Grid => {
            let lengths: Vec<f64> = low.iter().zip(high).map(|(a, b)| b - a).collect();
            cell_middles(&cells(&lengths, count))
        }
        _ => unit_cube(dim, count, sampling, seed),
    };
    unit.iter().enumerate().map(|(at, u)| low[at % dim] + u * (high[at % dim] - low[at % dim])).collect()
}

/// How many cells per axis make about `count` nearly cubic cells.
pub(super) fn cells(lengths: &[f64], count: usize) -> Vec<usize> {
    if lengths.is_empty() {
        return Vec::new();
    }
    let volume: f64 = lengths.iter().product();
    let side = (volume / count.max(1) as f64).powf(1.0 / lengths.len() as f64);
    lengths.iter().map(|length| (length / side).round().max(1.0) as usize).collect()
}

/// Middles of the cells of a regular division of the unit cube; one empty point in no dimensions.
pub(super) fn cell_middles(cells: &[usize]) -> Vec<f64> {
    let total: usize = cells.iter().product();
    let mut out = Vec::with_capacity(total * cells.len());
    for index in 0..total {
        let mut rest = index;
        for &along in cells {
            out.push(((rest % along) as f64 + 0.5) / along as f64);
            rest /= along;
        }
    }
    out
}

/// Equal areas of the unit square become equal areas of the ellipse: the radius goes with the root.
fn in_ellipse(centre: [f64; 2], semi_axes: [f64; 2], count: usize, sampling: Sampling, seed: u64) -> Vec<f64> {
    let unit = match sampling {
        // Sunflower seeds: regular, equal in area, without a preferred direction.
        Sampling::Grid => (0..count)
            .flat_map(|index| [(index as f64 + 0.5) / count as f64, (index as f64 * GOLDEN_TURN).fract()])
            .collect(),
        _ => unit_cube(2, count, sampling, seed),
    };
    let place = |pair: &[f64]| {
        let (radius, angle) = (pair[0].sqrt(), std::f64::consts::TAU * pair[1]);
        [centre[0] + semi_axes[0] * radius * angle.cos(), centre[1] + semi_axes[1] * radius * angle.sin()]
    };
    unit.chunks(2).flat_map(place).collect()
}
