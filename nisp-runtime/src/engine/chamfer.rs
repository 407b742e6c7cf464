//! Rows of a surface that passes through a cloud.
//!
//! While each cloud point `y` belongs to a certain surface point `x`, the squared distances of all that belong to `x`
//! add up to a quadratic form in it: `(x - o)^T A (x - o) - 2 b^T (x - o) + c`. Completing the square gives
//! `|R (x - o) - t|^2` and a rest that does not depend on `x`. A surface point of `D` coordinates therefore has `D` rows
//! however many points belong to it, and the rests of all add one row more, the scatter, which keeps the loss honest.
//!
//! - One direction: every cloud point counts once, at the surface point nearest to it.
//! - Symmetric: the cloud point nearest to each surface point counts too, all of them together as much as the cloud.
//! - To the plane: only the distance across the surface counts (along the normal as last assigned), not that along it.
//! - Robust losses of the distance are majorised by quadratic ones where it was last assigned: each point of the cloud
//!   has a weight (iteratively reweighted least squares).

use std::ops::Range;

use super::assign::{self, Cloud};
use crate::real::Real;
use crate::schema::{self, Loss, TermKind};

/// A Chamfer term's cloud and, as last assigned, its rows.
pub(crate) struct Chamfer<E> {
    cloud: Box<dyn Cloud>,
    dimensions: usize,
    symmetric: bool,
    plane: bool,
    loss: Loss,
    points: usize,
    /// `o`, `[coordinate][point]`.
    origin: Vec<E>,
    /// `t`, `[row][point]`.
    goal: Vec<E>,
    /// `R`, `[row][coordinate][point]`, upper triangular.
    root: Vec<E>,
    /// The part of the sum of squared distances that no surface can mend.
    scatter: f64,
    /// The assignment that the rows stand for; empty before the first.
    current: Vec<usize>,
}

/// A sum of squared distances from one surface point, about its origin.
#[derive(Clone, Debug, Default)]
struct Form {
    a: Vec<f64>,
    b: Vec<f64>,
    c: f64,
}

impl<E: Real> Chamfer<E> {
    /// The rows of a term at so many points; `cloud` is flat and point by point. Nothing unless the term is a Chamfer
    /// distance in two to four dimensions and the cloud has a point.
    pub(crate) fn new(cloud: &[f64], term: &schema::Term, points: usize) -> Option<Self> {
        let TermKind::Chamfer { symmetric, plane } = term.kind else { return None };
        let dimensions = term.rows;
        let zeros = |count: usize| vec![E::ZERO; count * points];
        Some(Self {
            cloud: assign::cloud(cloud, dimensions)?,
            dimensions,
            symmetric,
            plane,
            loss: term.loss,
            points,
            origin: zeros(dimensions),
            goal: zeros(dimensions),
            root: zeros(dimensions * dimensions),
            scatter: 0.0,
            current: Vec::new(),
        })
    }

    /// Number of measurements that the rows stand for.
    pub(crate) fn data(&self) -> usize {
        self.cloud.len() * if self.plane { 1 } else { self.dimensions }
    }

    /// Points of the cloud.
    pub(crate) fn cloud_points(&self) -> usize {
        self.cloud.len()
    }

    pub(crate) fn is_assigned(&self) -> bool {
        !self.current.is_empty()
    }

    /// Length of the scatter row before it is scaled.
    pub(crate) fn scatter(&self) -> f64 {
        self.scatter.sqrt()
    }

    /// Assigns the cloud to a surface (flat, point by point); `size` is what distances are divided by before a robust
    /// loss judges them. Returns true if rows have changed. A surface that is not finite changes nothing.
    pub(crate) fn assign(&mut self, surface: &[f64], size: f64) -> bool {
        if surface.iter().any(|x| !x.is_finite()) {
            return false;
        }
        self.cloud.assign(surface);
        let frozen = self.loss == Loss::Square && !self.plane && !self.symmetric;
        if frozen && self.current == self.cloud.nearest() {
            return false;
        }
        self.current.clear();
        self.current.extend_from_slice(self.cloud.nearest());
        self.complete_squares(surface, size);
        true
    }

    /// Rows for the present assignment, about the present surface.
    fn complete_squares(&mut self, surface: &[f64], size: f64) {
        let d = self.dimensions;
        let normals = if self.plane { self.cloud.normals(surface) } else { Vec::new() };
        let empty = Form { a: vec![0.0; d * d], b: vec![0.0; d], c: 0.0 };
        let mut forms = vec![empty; self.points];
        let mut add = |at: usize, datum: usize, weight: f64| {
            let distance: Vec<f64> =
                self.cloud.point(datum).iter().zip(&surface[at * d..]).map(|(y, x)| y - x).collect();
            forms[at].add(&distance, normals.get(at * d..(at + 1) * d), weight, self.loss, size);
        };
        for (datum, &at) in self.current.iter().enumerate() {
            add(at, datum, 1.0);
        }
        if self.symmetric {
            let weight = self.cloud.len() as f64 / self.points as f64;
            for (at, datum) in self.cloud.nearest_of(surface).into_iter().enumerate() {
                add(at, datum, weight);
            }
        }
        self.scatter = 0.0;
        for (p, form) in forms.iter_mut().enumerate() {
            self.scatter += form.complete_square();
            for i in 0..d {
                self.origin[i * self.points + p] = E::from_f64(surface[p * d + i]);
                self.goal[i * self.points + p] = E::from_f64(form.b[i]);
                for k in 0..d {
                    self.root[(i * d + k) * self.points + p] = E::from_f64(form.a[i * d + k]);
                }
            }
        }
    }

    /// Replaces the coordinates of a tile's points (`[coordinate][point]`) by the rows as they count,
    /// `scale (R (x - o) - t)`, and gives half the sum of their squares.
    pub(crate) fn weigh(&self, tile: Range<usize>, stride: usize, scale: E, values: &mut [E]) -> f64 {
        let (d, n) = (self.dimensions, self.points);
        let mut sum = 0.0;
        for (p, point) in tile.enumerate() {
            // Row i reads coordinates from i on, so that rows may take the coordinates' place one by one.
            for i in 0..d {
                let moved = |k: usize| values[k * stride + p] - self.origin[k * n + point];
                let rotated: E = (i..d).map(|k| self.root[(i * d + k) * n + point] * moved(k)).sum();
                let row = (rotated - self.goal[i * n + point]) * scale;
                values[i * stride + p] = row;
                sum += row.to_f64() * row.to_f64();
            }
        }
        sum / 2.0
    }

    /// Adds to the seeds of the coordinates (`[coordinate][point]`) what seeds of row `i` make of them.
    pub(crate) fn seed(&self, i: usize, tile: Range<usize>, stride: usize, row: impl Fn(usize) -> E, seeds: &mut [E]) {
        let (d, n) = (self.dimensions, self.points);
        for (p, point) in tile.enumerate() {
            for k in i..d {
                seeds[k * stride + p] += self.root[(i * d + k) * n + point] * row(p);
            }
        }
    }
}

impl Form {
    /// Adds a datum at `distance` from the origin, measured along `normal` if there is one.
    fn add(&mut self, distance: &[f64], normal: Option<&[f64]>, weight: f64, loss: Loss, size: f64) {
        let d = distance.len();
        let across: Option<f64> = normal.map(|n| n.iter().zip(distance).map(|(n, r)| n * r).sum());
        let square = across.map_or_else(|| distance.iter().map(|r| r * r).sum(), |across| across * across);
        let (slope, rest) = majorant(loss, square / (size * size));
        let weight_at = weight * slope;
        for i in 0..d {
            match (normal, across) {
                (Some(normal), Some(across)) => {
                    (0..d).for_each(|k| self.a[i * d + k] += weight_at * normal[i] * normal[k]);
                    self.b[i] += weight_at * normal[i] * across;
                }
                _ => {
                    self.a[i * d + i] += weight_at;
                    self.b[i] += weight_at * distance[i];
                }
            }
        }
        self.c += weight_at * square + weight * rest * size * size;
    }

    /// Replaces `a` by `R` and `b` by `t`, with `a = R^T R` and `b = R^T t`; returns what is left of `c`. Directions
    /// that nothing determines have rows of zeros.
    fn complete_square(&mut self) -> f64 {
        let d = self.b.len();
        let largest = (0..d).map(|i| self.a[i * d + i]).fold(0.0, f64::max);
        for i in 0..d {
            let pivot = self.a[i * d + i];
            let root = if pivot > 1e-12 * largest { pivot.sqrt() } else { 0.0 };
            let over = |x: f64| if root > 0.0 { x / root } else { 0.0 };
            self.b[i] = over(self.b[i]);
            self.c -= self.b[i] * self.b[i];
            for k in 0..d {
                self.a[i * d + k] = if k < i { 0.0 } else { over(self.a[i * d + k]) };
            }
            for j in i + 1..d {
                let factor = self.a[i * d + j];
                self.b[j] -= factor * self.b[i];
                (j..d).for_each(|k| self.a[j * d + k] -= factor * self.a[i * d + k]);
            }
        }
        self.c.max(0.0)
    }
}

/// `(w, e)` such that `2 rho(u) <= w u^2 + e` for all `u`, with equality at `u^2 = square`.
fn majorant(loss: Loss, square: f64) -> (f64, f64) {
    match loss {
        Loss::Huber(delta) if square > delta * delta => {
            let u = square.sqrt();
            (delta / u, delta * u - delta * delta)
        }
        Loss::Welsch(delta) => {
            let x = square / (2.0 * delta * delta);
            let weight = (-x).exp();
            (weight, -2.0 * delta * delta * (-x).exp_m1() - weight * square)
        }
        Loss::Square | Loss::Huber(_) => (1.0, 0.0),
    }
}
