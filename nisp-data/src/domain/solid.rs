//! A body bounded by triangles.

use super::Points;
use super::Sampling;
use super::sequence::unit_cube;
use crate::DataError;
use crate::cloud::Surface;

/// Directions of rays that tell inside from outside. The first that meets no edge decides.
const RAYS: [[f64; 3]; 3] = [[0.913, 0.271, 0.305], [0.187, 0.938, -0.292], [-0.331, 0.224, 0.917]];
/// Share of a triangle's size within which a ray counts as meeting its edge.
const EDGE: f64 = 1e-9;

/// A closed surface of triangles, counterclockwise from outside.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solid {
    corners: Vec<[[f64; 3]; 3]>,
}

impl Solid {
    /// The inside of a surface whose every edge belongs to two triangles.
    pub(super) fn new(surface: &Surface, scale: f64) -> Result<Self, DataError> {
        let open = open_edges(surface);
        if open > 0 {
            return Err(DataError::invalid(format!(
                "the surface is not closed: {open} edges do not belong to two triangles of like sense; repair it where it \
                 was made"
            )));
        }
        let corner = |at: usize| surface.vertices[at].map(|x| x * scale);
        let mut solid = Self { corners: surface.triangles.iter().map(|triangle| triangle.map(corner)).collect() };
        match solid.volume() {
            volume if volume > 0.0 => Ok(solid),
            // Inside out.
            volume if volume < 0.0 => {
                solid.corners.iter_mut().for_each(|corners| corners.reverse());
                Ok(solid)
            }
            _ => Err(DataError::invalid("the surface encloses no volume")),
        }
    }

    /// By the divergence theorem.
    pub(super) fn volume(&self) -> f64 {
        self.corners.iter().map(|[a, b, c]| dot(*a, cross(*b, *c)) / 6.0).sum()
    }

    pub(super) fn area(&self) -> f64 {
        self.corners.iter().map(|corners| size(normal(corners)) / 2.0).sum()
    }

    pub(super) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let all = || self.corners.iter().flatten();
        let pick = |axis: usize, better: fn(f64, f64) -> f64| all().map(|c| c[axis]).reduce(better).unwrap_or(0.0);
        ((0..3).map(|axis| pick(axis, f64::min)).collect(), (0..3).map(|axis| pick(axis, f64::max)).collect())
    }

    /// Counts the triangles that a ray meets.
    pub(super) fn contains(&self, point: [f64; 3]) -> bool {
        RAYS.iter().find_map(|ray| self.crossings(point, *ray)).unwrap_or(0) % 2 == 1
    }

    /// How often a ray leaves or enters; nothing if it meets an edge.
    fn crossings(&self, point: [f64; 3], ray: [f64; 3]) -> Option<usize> {
        let mut count = 0;
        for [a, b, c] in &self.corners {
            // Moeller and Trumbore 1997.
            let (p, q) = (subtract(*b, *a), subtract(*c, *a));
            let across = cross(ray, q);
            let determinant = dot(p, across);
            if determinant == 0.0 {
                continue;
            }
            let from = subtract(point, *a);
            let u = dot(from, across) / determinant;
            let along = cross(from, p);
            let v = dot(ray, along) / determinant;
            let least = u.min(v).min(1.0 - u - v);
            if least < -EDGE || dot(q, along) / determinant <= 0.0 {
                continue;
            }
            if least < EDGE {
                return None;
            }
            count += 1;
        }
        Some(count)
    }

    /// Points spread over the triangles by their area, with normals.
    pub(super) fn boundary(&self, count: usize, out: &mut Points) {
        let areas: Vec<f64> = self.corners.iter().map(|corners| size(normal(corners)) / 2.0).collect();
        let total: f64 = areas.iter().sum();
        let unit = unit_cube(2, count, Sampling::Sobol, 0);
        let (mut triangle, mut before) = (0, 0.0);
        for (index, place) in unit.chunks(2).enumerate() {
            // Steps of equal area along the list of triangles; within one, by the low-discrepancy pair.
            let at = (index as f64 + 0.5) / count as f64 * total;
            while before + areas[triangle] < at && triangle + 1 < areas.len() {
                before += areas[triangle];
                triangle += 1;
            }
            let corners = &self.corners[triangle];
            let (u, v) =
                if place[0] + place[1] > 1.0 { (1.0 - place[0], 1.0 - place[1]) } else { (place[0], place[1]) };
            let point: [f64; 3] =
                std::array::from_fn(|i| corners[0][i] * (1.0 - u - v) + corners[1][i] * u + corners[2][i] * v);
            let normal = normal(corners);
            let length = size(normal);
            out.add(&point, &normal.map(|x| x / length), total / count as f64);
        }
    }
}

/// Edges that are not run through once in either sense.
fn open_edges(surface: &Surface) -> usize {
    let mut edges = std::collections::HashMap::new();
    for [a, b, c] in &surface.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_insert(0_i64) += if from < to { 1 } else { -1 };
        }
    }
    edges.values().filter(|sum| **sum != 0).count()
}

fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    cross(subtract(*b, *a), subtract(*c, *a))
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn size(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
