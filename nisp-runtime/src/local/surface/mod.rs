//! Rows of a cloud: how far each of its points is from the surface, across it, beside the noise in that direction.
//!
//! A curve in a plane is a surface in space that goes on alike across the plane.
//!
//! A camera's points are off along its view `v` by a standard deviation `sigma`, and by a share `across` of it in the other
//! directions: their covariance is `sigma^2 S` with `S = v v^T + across^2 (I - v v^T)`. A point's foot is the place at rest whose
//! image it most likely is. From there to the point is the direction `S n` with the surface's normal `n`, and the distance along
//! `n` has the variance `sigma^2 n^T S n`. Feet are found by Newton's method before every step and held during it.
//!
//! A robust loss is minimised by weights that every step renews.

mod feet;

use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::block::Block;
use super::counting::Counting;
use super::group::Group;
use super::heads::Heads;
use super::shape::{Shape, padded, tangents_at};
use crate::facts::CloudFacts;
use crate::nearest::Nearest;
use crate::problem::Bound;
use crate::roughness::middle;
use crate::schema::{self, TermKind};
use crate::solve::vector::spread;

/// Points that are off by so many times the median show nothing of the surface.
const STRAY: f64 = 5.0;
/// Standard deviation of misfits, over that along the view, below which the surface is seen edge on.
pub(super) const EDGE_ON: f64 = 0.05;

/// A cloud of a term, and the feet of its points.
pub(super) struct Surface {
    pub(super) group: usize,
    /// Name of its term.
    pub(super) term: &'static str,
    first: usize,
    /// Components of a point, of which a curve has two.
    components: usize,
    cloud: Vec<Vector3<f64>>,
    /// The direction of view; nothing if points are off alike in all directions.
    view: Option<Vector3<f64>>,
    /// How far points are off in the other directions, as a share of that along the view.
    across: f64,
    inputs: usize,
    /// Places at rest that the surface is known to have, flat, and their directions along it.
    samples: Vec<f64>,
    tangents: Vec<Vec<f64>>,
    rest: Option<Nearest<3>>,
    /// Feet, flat; the sample nearest to each.
    feet: Vec<f64>,
    nearest: Vec<usize>,
    /// Feet this far from all samples have left the surface.
    reach: f64,
    /// False where the foot was lost.
    found: Vec<bool>,
    /// Unit normals of the surface, along which misfits are measured.
    normals: Vec<Vector3<f64>>,
    misfits: Vec<f64>,
    /// How far points are from their feet along the surface, beyond its edge.
    beyond: Vec<f64>,
    /// Standard deviations of the misfits over that along the view.
    spreads: Vec<f64>,
    counting: Counting,
}

/// Feet of a cloud's points; none before the first search.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Feet {
    /// Places at rest, flat.
    pub(super) feet: Vec<f64>,
    /// The sample nearest to each.
    pub(super) nearest: Vec<usize>,
}

impl Surface {
    /// The surfaces of all clouds of a group, on lattices of cells of some size.
    pub(super) fn of(bound: &Bound, at: usize, cell: f64) -> Vec<Self> {
        let schema = bound.problem.scene().schema;
        let terms = schema.groups[at].terms.iter().zip(&bound.clouds[at]).enumerate();
        let clouds = terms.filter(|(_, (term, _))| matches!(term.kind, TermKind::Chamfer { .. }));
        let surface = |(index, (term, cloud)): (usize, (&schema::Term, &Vec<f64>))| {
            let counting =
                Counting::of(term, bound.losses[at][index], bound.sizes[at][index], bound.tolerance(at, term));
            let view = bound.view(at, term.name);
            Self::new(at, term, cloud, view, &bound.coordinates[at], schema.coordinates.len(), (cell, counting))
        };
        clouds.map(surface).collect()
    }

    fn new(
        group: usize,
        term: &schema::Term,
        cloud: &[f64],
        view: Option<[f64; 3]>,
        samples: &[f64],
        inputs: usize,
        (reach, mut counting): (f64, Counting),
    ) -> Self {
        let cloud = in_space(cloud, term.rows);
        let flat: Vec<[f64; 3]> = samples.chunks_exact(inputs).map(padded).collect();
        let rest = Nearest::of(&flat);
        let tangents = flat.iter().zip(samples.chunks_exact(inputs));
        let tangents = tangents.map(|(at, _)| tangents_at(rest.as_ref(), &flat, at, inputs)).collect();
        let count = cloud.len();
        counting.see(&cloud);
        Self {
            group,
            term: term.name,
            first: term.first,
            components: term.rows,
            cloud,
            view: view.map(|v| Vector3::from(v).normalize()),
            across: 0.0,
            inputs,
            samples: samples.to_vec(),
            tangents,
            rest,
            feet: Vec::new(),
            nearest: vec![0; count],
            reach,
            found: vec![false; count],
            normals: vec![Vector3::zeros(); count],
            misfits: vec![0.0; count],
            beyond: vec![0.0; count],
            spreads: vec![1.0; count],
            counting,
        }
    }

    /// Takes over another cloud, whose feet are to be found.
    pub(super) fn renew(&mut self, cloud: &[f64]) {
        self.cloud = in_space(cloud, self.components);
        let count = self.cloud.len();
        self.counting.see(&self.cloud);
        self.feet.clear();
        self.nearest = vec![0; count];
        self.found = vec![false; count];
        self.normals = vec![Vector3::zeros(); count];
        self.misfits = vec![0.0; count];
        self.beyond = vec![0.0; count];
        self.spreads = vec![1.0; count];
    }

    /// Where the feet are, and which samples are nearest to them: where the next search begins.
    pub(super) fn feet(&self) -> Feet {
        Feet { feet: self.feet.clone(), nearest: self.nearest.clone() }
    }

    /// What the verdict is told of the surface; splines do not follow distances below a `resolution`.
    pub(super) fn facts(&self, resolution: f64) -> CloudFacts {
        CloudFacts {
            group: self.group,
            term: self.term,
            points: self.cloud.iter().map(|&point| point.into()).collect(),
            places: self.feet.chunks_exact(self.inputs).map(padded).collect(),
            misfits: self.signed(),
            signed: true,
            resolution,
        }
    }

    /// Whether the surface is near its cloud, so that points far off count for nothing.
    pub(super) fn set_near(&mut self, is_near: bool) {
        self.counting.set_near(is_near);
    }

    /// Puts the feet back.
    pub(super) fn set_feet(&mut self, feet: Feet) {
        (self.feet, self.nearest) = (feet.feet, feet.nearest);
    }

    /// Size of a cell: feet this far from all places at rest have left the surface.
    pub(super) fn cell(&self) -> f64 {
        self.reach
    }

    /// Points of the cloud.
    pub(super) fn len(&self) -> usize {
        self.cloud.len()
    }

    /// How far points are off in other directions than the view, as a share of that along it.
    pub(super) fn set_across(&mut self, across: f64) {
        self.across = across;
    }

    /// Misfits of the points whose feet were found, each as it would be along the view.
    pub(super) fn misfits(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.cloud.len()).filter(|&i| self.found[i]).map(|i| self.distance(i))
    }

    /// The misfit of a point as it would be along the view, with how far it is beyond an edge: in the plane of a side, but beside it,
    /// a point says nothing of where the side is.
    fn distance(&self, i: usize) -> f64 {
        let misfit = self.misfits[i] / self.spreads[i];
        if self.beyond[i] > 0.0 { misfit.hypot(self.beyond[i]).copysign(misfit) } else { misfit }
    }

    /// Misfits across the surface of the points whose feet were found, and how much of their view is across it: the square of the
    /// cosine between both. Nothing without a view.
    pub(super) fn facing(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let all =
            self.view.into_iter().flat_map(|view| self.normals.iter().map(move |normal| normal.dot(&view).powi(2)));
        let all = self.misfits.iter().zip(all).zip(&self.found);
        all.filter(|(_, found)| **found).map(|((misfit, facing), _)| (*misfit, facing))
    }

    /// Places at rest that the surface is known to have.
    pub(super) fn samples(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.samples.chunks_exact(self.inputs).map(padded)
    }

    /// The feet that were found, but for those of points far off.
    pub(super) fn found_places(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let far = STRAY * middle(self.misfits().map(f64::abs).collect());
        let feet = self.feet.chunks_exact(self.inputs).enumerate();
        feet.filter(move |(i, _)| self.found[*i] && self.distance(*i).abs() <= far).map(|(_, foot)| padded(foot))
    }

    /// Signed distances of all points across the surface, with how far they are beyond its edge; nothing where the foot was lost.
    fn signed(&self) -> Vec<Option<f64>> {
        let across = |i: usize| self.misfits[i].hypot(self.beyond[i]).copysign(self.misfits[i]);
        (0..self.cloud.len()).map(|i| self.found[i].then(|| across(i))).collect()
    }

    /// Standard deviation of the points along the view: as declared, or as estimated.
    pub(super) fn sigma(&self, estimated: f64) -> f64 {
        self.within().unwrap_or(estimated)
    }

    /// The declared standard deviation along the view.
    pub(super) fn within(&self) -> Option<f64> {
        self.counting.within()
    }

    /// Sum of the points' losses.
    pub(super) fn loss(&self, sigma: f64) -> f64 {
        self.misfits().map(|misfit| self.counting.rho(misfit, sigma)).sum()
    }

    /// Rows of the term: components of a position.
    fn rows(&self) -> Range<usize> {
        self.first..self.first + self.components
    }

    /// Where the surface has the feet of all points.
    pub(super) fn images(&self, group: &Group, heads: &Heads, theta: &[f64], scalars: &[f64]) -> Vec<Vector3<f64>> {
        let shape = Shape { group, heads, spread: &group.spread(heads, theta), scalars, rows: self.rows() };
        shape.positions(&self.feet, self.inputs)
    }

    /// How far every point goes that is moved by `by` its arm about the middle of the cloud, and the cloud's radius.
    pub(super) fn moved(&self, by: impl Fn(&Vector3<f64>, f64) -> Vector3<f64>) -> Vec<Vector3<f64>> {
        let (middle, radius) = spread(self.cloud.iter().copied());
        self.cloud.iter().map(|point| by(&(point - middle), radius)).collect()
    }

    /// By how much the rows of [`Surface::blocks`] change where the surface at every foot goes so far.
    pub(super) fn changes(&self, moved: &[Vector3<f64>], sigma: f64) -> Vec<f64> {
        let kept = (0..self.cloud.len()).filter(|&i| self.found[i]);
        kept.map(|i| self.normals[i].dot(&moved[i]) * self.root_weight(i, sigma)).collect()
    }

    /// What the row of a point is multiplied by: its weight's root over its standard deviation.
    fn root_weight(&self, i: usize, sigma: f64) -> f64 {
        self.counting.precision(self.distance(i), sigma).sqrt() / self.spreads[i]
    }

    /// Rows of all points with a foot, over `sigma`; those far off count less.
    pub(super) fn blocks(
        &self,
        group: &Group,
        heads: &Heads,
        theta: &[f64],
        scalars: &[f64],
        learned: &[f64],
        sigma: f64,
    ) -> Vec<Block> {
        let sites = group.sites_at(heads, &self.feet);
        let evaluated = group.evaluate_at(&sites, heads, &group.spread(heads, theta), scalars, true);
        let kept: Vec<usize> = (0..self.cloud.len()).filter(|&i| self.found[i]).collect();
        kept.into_par_iter()
            .map(|i| {
                let components = 0..self.components;
                let seed =
                    |bar| components.clone().map(|c| self.normals[i][c] * evaluated.bar(self.first + c, bar, i)).sum();
                let mut block = group.at_point(heads, (&sites, i), learned, self.misfits[i], seed);
                block.divide(std::iter::once(1.0 / self.root_weight(i, sigma)));
                block
            })
            .collect()
    }
}

/// Points in space; of a plane the third component is zero.
fn in_space(cloud: &[f64], components: usize) -> Vec<Vector3<f64>> {
    cloud.chunks_exact(components).map(|point| Vector3::from(padded(point))).collect()
}
