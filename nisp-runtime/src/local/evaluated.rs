//! Values of a group's rows at points, and their derivatives by the jets that they read.

use rayon::prelude::*;

use super::group::Group;
use super::heads::Heads;
use super::lattice::{Exponents, contracted};
use super::rows::Evaluated;
use super::sites::Sites;
use crate::bounds::{Across, Limits, Slopes};
use crate::facts::Facts;
use crate::residual::Points;
use crate::simd::Isa;

impl Group {
    /// Jets at points, `[jet][point]`, from [`Group::spread`]; of bounded heads what programs read, and by tower and point how it
    /// follows the head.
    pub(super) fn jets_at(&self, sites: &Sites, heads: &Heads, spread: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<Slopes>>) {
        let stride = sites.stride;
        let count = self.schema.jets.len();
        let mut jets = vec![0.0; count * stride];
        jets.par_chunks_mut(stride).enumerate().for_each(|(at, jets)| {
            let (jet, operator) = (&self.schema.jets[at], &self.operators[at]);
            let (splines, lattice) = (&sites.splines[self.slots[at]], &heads.lattices[jet.head]);
            let lines = lattice.lines();
            let mut across = Vec::new();
            for (p, out) in jets.iter_mut().enumerate().take(sites.count) {
                let cell = &spread[jet.head][lattice.first(&splines.places[p])..];
                let term = |(exponents, coefficient): &(Exponents, f64)| {
                    let along = splines.factors(p, exponents, &mut across);
                    coefficient * contracted(cell, &lines, &across, along)
                };
                let offset = if jet.is_value() { heads.offset[jet.head] } else { 0.0 };
                *out = offset + heads.scale[jet.head] * operator.iter().map(term).sum::<f64>();
            }
        });
        let bounded = self.towers.iter().filter_map(|tower| Some((tower, heads.limits[tower.head]?)));
        let read = |(tower, limits): (&Across, Limits)| {
            let of = |p: usize| tower.read(limits, heads.scale[tower.head], &mut jets, |jet| jet * stride + p);
            (0..sites.count).map(of).collect()
        };
        let bounded = bounded.map(read).collect();
        jets.chunks_exact_mut(stride).for_each(|jets| {
            let last = jets[sites.count - 1];
            jets[sites.count..].fill(last);
        });
        (jets, bounded)
    }

    /// Coefficients of the heads that the group reads, by the full numbers of their functions.
    pub(super) fn spread(&self, heads: &Heads, theta: &[f64]) -> Vec<Vec<f64>> {
        let count = heads.lattices.len();
        let is_read = |head: usize| self.highest.iter().skip(head).step_by(count).any(Option::is_some);
        (0..count).map(|head| if is_read(head) { heads.spread(head, theta) } else { Vec::new() }).collect()
    }

    /// Rows of the group at other points, from [`Group::spread`], and their derivatives if `slopes`.
    pub(super) fn evaluate_at(
        &self,
        sites: &Sites,
        heads: &Heads,
        spread: &[Vec<f64>],
        scalars: &[f64],
        slopes: bool,
    ) -> Evaluated {
        let stride = sites.stride;
        let count = self.schema.jets.len();
        let (jets, bounded) = self.jets_at(sites, heads, spread);
        let points = Points {
            count: sites.count,
            stride,
            jets: &jets,
            coordinates: &sites.coordinates,
            columns: &sites.columns,
            scalars,
            seeds: &[],
        };
        let mut rows = vec![0.0; self.schema.rows * stride];
        self.kernel.programs.residual(Isa::detect(), points, &mut rows);
        let straight = bounded.iter().flatten().all(|slopes| slopes.rest == 0.0);
        if !slopes && straight {
            return Evaluated { stride, rows, bars: Vec::new() };
        }
        let mut bars: Vec<Vec<f64>> = (0..self.schema.rows)
            .into_par_iter()
            .map(|row| {
                let mut seeds = vec![0.0; self.schema.rows * stride];
                seeds[row * stride..][..stride].fill(1.0);
                let mut bars = vec![0.0; (count + scalars.len()) * stride];
                self.kernel.programs.adjoint(Isa::detect(), Points { seeds: &seeds, ..points }, &mut bars);
                bars
            })
            .collect();
        for (tower, bounded) in self.towers.iter().zip(&bounded) {
            for (row, bars) in bars.iter_mut().enumerate() {
                for (p, slopes) in bounded.iter().enumerate() {
                    rows[row * stride + p] += slopes.rest * tower.pull(slopes, &jets, bars, |jet| jet * stride + p);
                }
            }
        }
        for ((row, bars), growth) in bars.iter_mut().enumerate().zip(&self.growth) {
            for (by_learned, growth) in bars[count * stride..].chunks_exact_mut(stride).zip(growth) {
                let values = &rows[row * stride..][..stride];
                by_learned.iter_mut().zip(values).for_each(|(by, value)| *by -= value * growth);
            }
        }
        Evaluated { stride, rows, bars }
    }

    /// What the heads say at the group's own points.
    pub(super) fn facts(&self, heads: &Heads, theta: &[f64]) -> Facts {
        Facts {
            points: self.sites.count,
            stride: self.sites.stride,
            jets: self.jets_at(&self.sites, heads, &self.spread(heads, theta)).0,
            coordinates: self.sites.coordinates.clone(),
            columns: self.sites.columns.clone(),
            means: self.means(),
        }
    }

    /// Rows of the group at its own points, and their derivatives if `slopes`.
    pub(super) fn evaluate(&self, heads: &Heads, theta: &[f64], scalars: &[f64], slopes: bool) -> Evaluated {
        self.evaluate_at(&self.sites, heads, &self.spread(heads, theta), scalars, slopes)
    }
}
