//! The part of a body's surface on which a pressure can act, and the force of that pressure.

use nisp_data::DataError;
use nisp_data::export::triangulate;

/// How a pressure turns into a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Along this unit vector, per area at rest.
    Fixed([f64; 3]),
    /// Against the outward normal of the deformed surface, per deformed area.
    Follower,
    /// Along the normal of the deformed surface, per area at rest: of its two sides the one that this unit vector points to. Along the
    /// vector itself where nothing is known of how the surface is deformed.
    Normal([f64; 3]),
}

/// Triangles between points at rest, counterclockwise seen from outside. Lengths are in metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Face {
    /// Coordinates of a point.
    pub dim: usize,
    /// Points in the scene's coordinates, one after the other.
    pub points: Vec<f64>,
    /// Corners of the triangles.
    pub triangles: Vec<[usize; 3]>,
}

impl Face {
    /// Joins points by the Delaunay triangles of their first two coordinates.
    ///
    /// # Errors
    /// Points that are not finite.
    pub fn new(dim: usize, points: Vec<f64>) -> Result<Self, DataError> {
        let plane: Vec<[f64; 2]> = points.chunks_exact(dim.max(2)).map(|point| [point[0], point[1]]).collect();
        Ok(Self { dim, triangles: triangulate(&plane, None)?, points })
    }

    /// The points in space; a plane face rests at z = 0.
    pub fn at_rest(&self) -> Vec<[f64; 3]> {
        let place = |point: &[f64]| std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0));
        self.points.chunks_exact(self.dim.max(1)).map(place).collect()
    }

    /// The area vector that every point stands for where the points are at `places`: a third of those of its triangles,
    /// so that a sum over points integrates what is linear between them.
    pub(crate) fn area_vectors(&self, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut vectors = vec![[0.0; 3]; places.len()];
        for corners in &self.triangles {
            let [p, q, r] = corners.map(|corner| places[corner]);
            let double = cross(minus(q, p), minus(r, p));
            corners.iter().for_each(|&corner| (0..3).for_each(|axis| vectors[corner][axis] += double[axis] / 6.0));
        }
        vectors
    }

    /// The area in square metres that every point stands for where the points are at `places`.
    pub fn areas(&self, places: &[[f64; 3]]) -> Vec<f64> {
        let mut areas = vec![0.0; places.len()];
        for corners in &self.triangles {
            let [p, q, r] = corners.map(|corner| places[corner]);
            let double = length(cross(minus(q, p), minus(r, p)));
            corners.iter().for_each(|&corner| areas[corner] += double / 6.0);
        }
        areas
    }

    /// The force in newtons that one pascal at every point exerts on the body, which has moved the points to `moved`.
    pub fn forces(&self, load: Load, moved: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match load {
            Load::Fixed(direction) => {
                let areas = self.areas(&self.at_rest()).into_iter();
                areas.map(|area| direction.map(|x| area * x)).collect()
            }
            Load::Follower => self.area_vectors(moved).into_iter().map(|vector| vector.map(|x| -x)).collect(),
            Load::Normal(side) => {
                let areas = self.areas(&self.at_rest()).into_iter();
                let along = |(area, vector): (f64, [f64; 3])| match dot(vector, side) {
                    0.0 => [0.0; 3],
                    side => vector.map(|x| x * area * side.signum() / length(vector)),
                };
                areas.zip(self.area_vectors(moved)).map(along).collect()
            }
        }
    }
}

/// The length of a vector.
pub(crate) fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The sum of vectors, each times its weight.
pub(super) fn weighted_sum(weights: &[f64], vectors: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (weight, vector) in weights.iter().zip(vectors) {
        (0..3).for_each(|axis| sum[axis] += weight * vector[axis]);
    }
    sum
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// `n` by `n` nodes on the unit square.
    fn square(n: i32) -> Face {
        let step = 1.0 / f64::from(n - 1);
        Face::new(2, (0..n * n).flat_map(|i| [f64::from(i % n) * step, f64::from(i / n) * step]).collect()).unwrap()
    }

    fn integral(face: &Face, of: impl Fn(&[f64]) -> f64) -> f64 {
        let values: Vec<f64> = face.points.chunks_exact(2).map(of).collect();
        let forces = face.forces(Load::Fixed([0.0, 0.0, -1.0]), &face.at_rest());
        -weighted_sum(&values, &forces)[2]
    }

    #[test]
    fn linear_pressures_integrate_exactly_and_a_dome_nearly() {
        assert!((integral(&square(7), |p| 3.0 + 2.0 * p[0] - p[1]) - 3.5).abs() < 1e-12);
        // The integral of sin(pi x) sin(pi y) is 4 / pi^2; the error is of second order.
        let error = |n| (integral(&square(n), |p| (PI * p[0]).sin() * (PI * p[1]).sin()) - 4.0 / (PI * PI)).abs();
        assert!(error(41) < 1e-3 && (3.5..4.5).contains(&(error(21) / error(41))), "{} {}", error(21), error(41));
    }

    /// A square that has become the half of a cylinder of radius 1 / pi: its area is kept, and a pressure that grows to one
    /// side pushes as its integral along the arc says.
    #[test]
    fn a_follower_presses_against_the_deformed_normal() {
        let face = square(101);
        let radius = 1.0 / PI;
        let bend = |p: &[f64]| [-radius * (PI * p[0]).cos(), p[1], radius * (PI * p[0]).sin()];
        let moved: Vec<[f64; 3]> = face.points.chunks_exact(2).map(bend).collect();
        assert!((face.areas(&moved).iter().sum::<f64>() - 1.0).abs() < 1e-3);
        let forces = face.forces(Load::Follower, &moved);
        let pressure: Vec<f64> = face.points.chunks_exact(2).map(|p| 1.0 - (PI * p[0]).cos()).collect();
        // The normal is (-cos, 0, sin) of pi x. The integrals over x of cos^2 and of sin are 1/2 and 2 / pi.
        let [x, y, z] = weighted_sum(&pressure, &forces);
        assert!((x + 0.5).abs() < 1e-3 && y.abs() < 1e-12 && (z + 2.0 / PI).abs() < 1e-3, "{x} {y} {z}");
        // The area is kept, so that a pressure per area at rest pushes alike; twice as large a cylinder changes nothing then.
        let below = Load::Normal([0.0, 0.0, -1.0]);
        let doubled: Vec<[f64; 3]> = moved.iter().map(|place| place.map(|x| 2.0 * x)).collect();
        for places in [&moved, &doubled] {
            let [own_x, own_y, own_z] = weighted_sum(&pressure, &face.forces(below, places));
            assert!((own_x - x).abs() < 1e-3 && own_y.abs() < 1e-12 && (own_z - z).abs() < 1e-3, "{own_x} {own_z}");
        }
    }
}
