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

use super::fit::{Fit, Measure, fit};
use crate::kernel::Precision;
use crate::loss::Loss;
use crate::schema::{self, TermKind};

/// A Chamfer term's cloud and, as last assigned, its rows.
pub(crate) struct Chamfer<E> {
    fit: Box<dyn Fit>,
    dimensions: usize,
    plane: bool,
    points: usize,
    /// `o`, `[coordinate][point]`.
    origin: Vec<E>,
    /// `t`, `[row][point]`.
    goal: Vec<E>,
    /// `R`, `[row][coordinate][point]`, upper triangular.
    root: Vec<E>,
    /// The part of the sum of squared distances that no surface can mend.
    scatter: f64,
}

impl<E: Precision> Chamfer<E> {
    /// The rows of a term at so many points; `cloud` is flat and point by point. Nothing unless the term is a Chamfer
    /// distance in two to four dimensions and the cloud has a point.
    pub(crate) fn new(cloud: &[f64], (term, loss): (&schema::Term, Loss), points: usize) -> Option<Self> {
        let TermKind::Chamfer { symmetric, plane, .. } = term.kind else { return None };
        let dimensions = term.rows;
        let zeros = |count: usize| vec![E::ZERO; count * points];
        Some(Self {
            fit: fit(cloud, dimensions, points, Measure { symmetric, plane, loss })?,
            dimensions,
            plane,
            points,
            origin: zeros(dimensions),
            goal: zeros(dimensions),
            root: zeros(dimensions * dimensions),
            scatter: 0.0,
        })
    }

    /// Number of measurements that the rows stand for.
    pub(crate) fn data(&self) -> usize {
        self.cloud_points() * if self.plane { 1 } else { self.dimensions }
    }

    /// Points of the cloud.
    pub(crate) fn cloud_points(&self) -> usize {
        self.fit.cloud_points()
    }

    pub(crate) fn is_assigned(&self) -> bool {
        self.fit.is_assigned()
    }

    /// How far each point of the cloud is from the surface as last assigned, by coordinate or across it.
    pub(crate) fn misfits(&self) -> Vec<f64> {
        self.fit.misfits()
    }

    /// Length of the scatter row before it is scaled.
    pub(crate) fn scatter(&self) -> f64 {
        self.scatter.sqrt()
    }

    /// The surface to assign next, flat and point by point, to be written.
    pub(crate) fn surface(&mut self) -> &mut [f64] {
        self.fit.surface()
    }

    /// Assigns the cloud to the surface; `size` is what distances are divided by before a robust loss judges them.
    /// Returns true if rows have changed. A surface that is not finite changes nothing.
    pub(crate) fn assign(&mut self, size: f64) -> bool {
        let Some(scatter) = self.fit.refresh(size) else { return false };
        self.scatter = scatter;
        for p in 0..self.points {
            let (origin, goal, root) = self.fit.sum(p);
            for (to, from) in [(&mut self.origin, origin), (&mut self.goal, goal), (&mut self.root, root)] {
                for (i, &x) in from.iter().enumerate() {
                    to[i * self.points + p] = E::from_f64(x);
                }
            }
        }
        true
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
