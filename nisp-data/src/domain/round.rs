//! Points in and on balls and cylinders.

use std::f64::consts::TAU;

use super::sequence::{self, GOLDEN_TURN};
use super::{Domain, Points, Sampling};

/// Equal shares of the unit cube become equal shares of the ball: its radius goes with the cube root.
pub(super) fn in_ball(centre: [f64; 3], radius: f64, count: usize, sampling: Sampling, seed: u64) -> Vec<f64> {
    let unit = sequence::unit_cube(3, count, sampling, seed);
    let place = |share: &[f64]| {
        let distance = radius * share[0].cbrt();
        let [x, y, z] = direction(2.0 * share[1] - 1.0, share[2]);
        [centre[0] + distance * x, centre[1] + distance * y, centre[2] + distance * z]
    };
    unit.chunks(3).flat_map(place).collect()
}

/// A spiral from pole to pole, with equal areas between its turns.
pub(super) fn on_ball(centre: [f64; 3], radius: f64, count: usize, out: &mut Points) {
    let weight = 2.0 * TAU * radius * radius / count.max(1) as f64;
    for index in 0..count {
        let normal = direction(1.0 - (2.0 * index as f64 + 1.0) / count as f64, index as f64 * GOLDEN_TURN);
        let point: [f64; 3] = std::array::from_fn(|axis| centre[axis] + radius * normal[axis]);
        out.add(&point, &normal, weight);
    }
}

/// The direction of a height on the unit sphere and a number of turns about its axis.
fn direction(height: f64, turns: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * turns).sin_cos();
    let across = (1.0 - height * height).max(0.0).sqrt();
    [across * cos, across * sin, height]
}

/// The mantle, then both lids, by their areas.
pub(super) fn on_cylinder(base: &Domain, [low, high]: [f64; 2], count: usize, out: &mut Points) {
    let (rim, lid) = (base.boundary_measure() * (high - low), base.measure());
    let share = |area: f64| ((count as f64 * area / (rim + 2.0 * lid)).round() as usize).max(1);
    let mantle = share(rim);
    let around = base.boundary(mantle);
    for index in 0..mantle {
        // Neighbours around the mantle are far apart along it.
        let height = low + (high - low) * ((index as f64 + 0.5) * GOLDEN_TURN).fract();
        let (point, normal) = (&around.coords[2 * index..][..2], around.normal(index).unwrap_or_default());
        out.add(&[point[0], point[1], height], &[normal[0], normal[1], 0.0], rim / mantle as f64);
    }
    for (height, sign) in [(low, -1.0), (high, 1.0)] {
        let points = base.interior(share(lid), Sampling::Grid, 0);
        for point in points.iter() {
            out.add(&[point[0], point[1], height], &[0.0, 0.0, sign], lid / points.len() as f64);
        }
    }
}
