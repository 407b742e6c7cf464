//! What a network says at the points of its groups, for the verdict.

use crate::nearest::{Nearest, Neighbour};
use std::num::NonZero;

use super::Engine;
use super::buffers::POINT_LANES;
use crate::facts::{Answer, CloudFacts, Facts};
use crate::given::{SMALL, size};
use crate::schema::TermKind;
use crate::solve::vector::root_mean_square;

impl Engine<f64> {
    /// What the network says, of clouds given by group and term, flat.
    pub(crate) fn answer(&mut self, theta: &[f64], clouds: &[Vec<Vec<f64>>]) -> Answer {
        let facts: Vec<Facts> = (0..self.groups.len()).map(|group| self.facts(group, theta)).collect();
        let mut seen = Vec::new();
        for (group, (bound, clouds)) in self.groups.iter().zip(clouds).enumerate() {
            let rows = || facts[group].rows(bound.programs, bound.schema, &self.scalars);
            for (term, cloud) in bound.schema.terms.iter().zip(clouds) {
                if matches!(term.kind, TermKind::Chamfer { .. }) && (2..=3).contains(&term.rows) {
                    let surface = rows()[term.first..term.first + term.rows].to_vec();
                    seen.extend(beside(group, term.name, &surface, cloud));
                }
            }
        }
        Answer {
            facts,
            between: Vec::new(),
            clouds: seen,
            scalars: self.scalars.clone(),
            scores: Vec::new(),
            told: Vec::new(),
            leaning: Vec::new(),
            ahead: None,
            moved: None,
            left_to_learned: Vec::new(),
            strain: None,
            loose: None,
            is_coarse: false,
            shared: Vec::new(),
            used: 1.0,
            refined: None,
            finer: "more --budget, more --width or another --seed",
        }
    }

    /// By learned scalar, the change of its parameter that is as large as what is left of the equations: the least of all that read it.
    pub(crate) fn left_to_learned(&mut self, theta: &[f64]) -> Vec<f64> {
        let found = self.learned_values(theta);
        let mut least = vec![f64::INFINITY; found.len()];
        if found.is_empty() {
            return least;
        }
        for at in 0..self.groups.len() {
            let facts = self.facts(at, theta);
            let group = &self.groups[at];
            let rows = |scalars: &[f64]| facts.rows(group.programs, group.schema, scalars);
            let own = rows(&self.scalars);
            let equations = group.schema.terms.iter().filter(|term| term.kind == TermKind::Residual);
            let equations: Vec<usize> = equations.flat_map(|term| term.first..term.first + term.rows).collect();
            for ((least, learned), (value, slope)) in least.iter_mut().zip(&self.learned).zip(&found) {
                let by = SMALL * size(*value);
                let mut moved = self.scalars.clone();
                moved[learned.slot] += by;
                let moved = rows(&moved);
                for &row in &equations {
                    let change = moved[row].iter().zip(&own[row]).map(|(moved, own)| (moved - own) / by);
                    let (left, change) = (root_mean_square(own[row].iter().copied()), root_mean_square(change));
                    if change > 0.0 {
                        *least = least.min(left / change / slope.abs());
                    }
                }
            }
        }
        least.into_iter().map(|change| if change.is_finite() { change } else { 0.0 }).collect()
    }

    /// Values and derivatives at the points of a group.
    pub(crate) fn facts(&mut self, group: usize, theta: &[f64]) -> Facts {
        self.set(theta);
        let bound = &self.groups[group];
        let points = bound.points;
        let stride = points.next_multiple_of(POINT_LANES);
        let mut facts = Facts {
            points,
            stride,
            jets: vec![0.0; bound.schema.jets.len() * stride],
            coordinates: vec![0.0; bound.coordinates.len() / points.max(1) * stride],
            columns: vec![0.0; bound.schema.columns.len() * stride],
            means: Vec::new(),
        };
        self.each_tile(group, |tile, buffers| {
            let parts: [(&mut [f64], &[f64]); 3] = [
                (&mut facts.jets, &buffers.jets),
                (&mut facts.coordinates, &buffers.points),
                (&mut facts.columns, &buffers.columns),
            ];
            for (all, own) in parts {
                for (all, own) in all.chunks_exact_mut(stride).zip(own.chunks_exact(tile.stride())) {
                    all[tile.first..tile.first + tile.count].copy_from_slice(&own[..tile.count]);
                    // What vectors read beyond the last point.
                    all[tile.first + tile.count..].fill(own[tile.count - 1]);
                }
            }
        });
        facts
    }
}

/// A cloud beside a surface of points, `[coordinate][point]`: distances to the nearest of them.
fn beside(group: usize, term: &'static str, surface: &[Vec<f64>], cloud: &[f64]) -> Option<CloudFacts> {
    const TWO: NonZero<usize> = NonZero::new(2).unwrap();
    let padded = |of: &dyn Fn(usize) -> f64| std::array::from_fn(|i| if i < surface.len() { of(i) } else { 0.0 });
    let places: Vec<[f64; 3]> = (0..surface[0].len()).map(|p| padded(&|i| surface[i][p])).collect();
    let tree = Nearest::of(&places)?;
    let apart = places.iter().filter_map(|place| tree.some(place, TWO).last().map(|found| found.distance));
    let mut apart: Vec<f64> = apart.collect();
    apart.sort_by(f64::total_cmp);
    let points: Vec<[f64; 3]> = cloud.chunks_exact(surface.len()).map(|point| padded(&|i| point[i])).collect();
    let nearest: Vec<Neighbour> = points.iter().map(|point| tree.one(point)).collect();
    let misfits = nearest.iter().map(|found| Some(found.distance)).collect();
    let feet = nearest.iter().map(|found| places[found.index]).collect();
    let resolution = apart.get(apart.len() / 2).copied().unwrap_or(0.0);
    Some(CloudFacts { group, term, points, places: feet, misfits, signed: false, resolution })
}
