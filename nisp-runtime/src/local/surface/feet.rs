//! The search for the feet of a cloud's points.

use nalgebra::{Vector2, Vector3};

use super::{EDGE_ON, Surface};
use crate::local::group::Group;
use crate::local::heads::Heads;
use crate::local::shape::{Shape, padded};
use crate::nearest::Nearest;

/// Newton steps for the feet, at most.
const STEPS: usize = 8;
/// Feet nearer than this to where they belong stay, as a share of a cell.
const STILL: f64 = 1e-6;

impl Surface {
    /// Finds the feet of all points on the present surface: true where they have come to rest.
    pub(in crate::local) fn find(&mut self, group: &Group, heads: &Heads, theta: &[f64], scalars: &[f64]) -> bool {
        let shape = Shape { group, heads, spread: &group.spread(heads, theta), scalars, rows: self.rows() };
        if self.feet.is_empty() {
            self.begin(&shape);
        }
        let mut moving: Vec<usize> = (0..self.cloud.len()).collect();
        for _ in 0..STEPS {
            let ways = self.look(&shape, &moving);
            moving = self.walk(&moving, &ways);
            if moving.is_empty() {
                return true;
            }
        }
        self.look(&shape, &moving);
        false
    }

    /// Looks around some feet: the normals there, what is left of the points, and how far feet are to move along both tangents.
    fn look(&mut self, shape: &Shape<'_>, moving: &[usize]) -> Vec<Option<Vector2<f64>>> {
        let small = 1e-3 * self.reach;
        let directions = self.inputs.min(2);
        let mut around = Vec::with_capacity((1 + 2 * directions) * self.inputs * moving.len());
        for &i in moving {
            let foot = &self.feet[i * self.inputs..(i + 1) * self.inputs];
            around.extend_from_slice(foot);
            for tangent in self.tangents[self.nearest[i]].chunks_exact(self.inputs) {
                for sign in [small, -small] {
                    around.extend(foot.iter().zip(tangent).map(|(x, t)| x + sign * t));
                }
            }
        }
        let positions = shape.positions(&around, self.inputs);
        let way = |(&i, near): (&usize, &[Vector3<f64>])| {
            let slope = |k: usize| (near[1 + 2 * k] - near[2 + 2 * k]) / (2.0 * small);
            let (a, b) = (slope(0), if directions > 1 { slope(1) } else { Vector3::z() });
            let normal = a.cross(&b);
            let Some(normal) = normal.try_normalize(1e-12 * a.norm() * b.norm()) else {
                self.found[i] = false;
                return None;
            };
            // From the foot to the point, if it is the likeliest: S n.
            let share = self.across * self.across;
            let likely = self.view.map_or(normal, |view| view * (view.dot(&normal) * (1.0 - share)) + normal * share);
            self.spreads[i] = likely.dot(&normal).sqrt();
            // A surface seen edge on says nothing along the view.
            self.found[i] = self.spreads[i] > EDGE_ON;
            self.normals[i] = normal;
            self.misfits[i] = normal.dot(&(near[0] - self.cloud[i]));
            // The gap is a step along the surface and the rest along `likely` (Cramer's rule).
            let (gap, across) = (self.cloud[i] - near[0], b.cross(&likely));
            let along = Vector2::new(gap.dot(&across), a.dot(&gap.cross(&likely)));
            let along = along / a.dot(&across);
            self.beyond[i] = (a * along.x + b * along.y).norm();
            self.found[i].then_some(along)
        };
        moving.iter().zip(positions.chunks_exact(1 + 2 * directions)).map(way).collect()
    }

    /// A step of Newton's method for some feet; returns those that it has moved.
    fn walk(&mut self, moving: &[usize], ways: &[Option<Vector2<f64>>]) -> Vec<usize> {
        let mut moved = Vec::new();
        for (&i, way) in moving.iter().zip(ways) {
            let Some(way) = way else { continue };
            let far = way.norm();
            let scale = if far > self.reach { self.reach / far } else { 1.0 };
            if far > STILL * self.reach && self.step(i, way.x * scale, way.y * scale) {
                moved.push(i);
            }
        }
        moved
    }

    /// Moves a foot along the surface at rest, but not off it: false where it stays.
    fn step(&mut self, i: usize, a: f64, b: f64) -> bool {
        let inputs = self.inputs;
        let tangent = &self.tangents[self.nearest[i]];
        let mut foot = self.feet[i * inputs..(i + 1) * inputs].to_vec();
        for (tangent, far) in tangent.chunks_exact(inputs).zip([a, b]) {
            foot.iter_mut().zip(tangent).for_each(|(x, t)| *x += far * t);
        }
        let Some(tree) = &self.rest else { return false };
        let found = tree.one(&padded(&foot));
        self.nearest[i] = found.index;
        if found.distance > self.reach {
            let at = found.index * inputs;
            foot.copy_from_slice(&self.samples[at..at + inputs]);
        }
        let own = &mut self.feet[i * inputs..(i + 1) * inputs];
        let has_moved = *own != *foot;
        own.copy_from_slice(&foot);
        has_moved
    }

    /// First feet: the samples whose images are nearest, seen along the view.
    fn begin(&mut self, shape: &Shape<'_>) {
        let seen = |x: &Vector3<f64>| self.view.map_or(*x, |view| x - view * view.dot(x));
        let images = shape.positions(&self.samples, self.inputs);
        let images: Vec<[f64; 3]> = images.iter().map(|x| seen(x).into()).collect();
        let Some(tree) = Nearest::of(&images) else { return };
        self.nearest = self.cloud.iter().map(|y| tree.one(&seen(y).into()).index).collect();
        let inputs = self.inputs;
        self.feet = self.nearest.iter().flat_map(|&at| self.samples[at * inputs..(at + 1) * inputs].to_vec()).collect();
    }
}
