//! A problem in the engine's units: what carriers read of it, and parts of it.

use super::frame::inward_points;
use super::{Frame, Problem, UnitSystem};
use crate::engine::{Learned, Powers, Scaling, is_exchangeable};
use crate::loss::Loss;
use crate::schema::{self, Origin};
use crate::solve::vector::deviation;
use crate::units::{Number, Scale};

/// A problem in the engine's units, whatever the precision.
#[derive(Clone, Debug)]
pub(crate) struct Bound {
    pub(crate) problem: Problem,
    pub(crate) system: UnitSystem,
    pub(crate) scaling: Scaling,
    pub(crate) scalars: Vec<f64>,
    pub(crate) learned: Vec<Learned>,
    /// Natural size of each term's rows, by group and term.
    pub(crate) sizes: Vec<Vec<f64>>,
    /// How misfits count, by group and term.
    pub(crate) losses: Vec<Vec<Loss>>,
    /// Powers of the learned scalars that the sizes of equations go with, by group and term; see [`super::powers`].
    pub(crate) powers: Vec<Vec<Powers>>,
    /// Coordinates by group, in the engine's units, point by point.
    pub(crate) coordinates: Vec<Vec<f64>>,
    /// Coordinates of their partners, in the same way; empty unless the group is paired.
    pub(crate) partners: Vec<Vec<f64>>,
    /// Columns by group, in the engine's units; NaN where a quantity was not measured.
    pub(crate) columns: Vec<Vec<Vec<f64>>>,
    /// Clouds by group and term, in the engine's units, flat and point by point; empty for other terms.
    pub(crate) clouds: Vec<Vec<Vec<f64>>>,
    /// How noisy the points of an observation are beside each other, by group and row; empty where they are alike.
    pub(crate) noisiness: Vec<Vec<Vec<f64>>>,
}

/// How noisy a value counts as that is left out.
pub(crate) const LEFT_OUT: f64 = 1e6;

/// A [`super::Tolerance`] in the engine's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EngineTolerance {
    pub(crate) size: f64,
    pub(crate) region: f64,
    pub(crate) common: f64,
}

impl Bound {
    /// Columns of a group with zeros where nothing was measured: rows that read those do not count.
    pub(crate) fn filled_columns(&self, group: usize) -> Vec<Vec<f64>> {
        let filled = |column: &Vec<f64>| column.iter().map(|&x| if x.is_nan() { 0.0 } else { x }).collect();
        self.columns[group].iter().map(filled).collect()
    }

    /// How much a column of a group varies, where it was measured.
    pub(crate) fn spread_of(&self, group: usize, column: usize) -> f64 {
        let values = self.columns[group][column].iter().copied();
        deviation(&values.filter(|value| !value.is_nan()).collect::<Vec<f64>>())
    }

    /// Where an observation was measured, point by point; nothing if everywhere.
    pub(crate) fn lacking(&self, group: usize, term: &schema::Term) -> Option<Vec<bool>> {
        let columns = || term.columns.iter().map(|&column| &self.columns[group][column]);
        let points = columns().next()?.len();
        let measured: Vec<bool> = (0..points).map(|p| columns().all(|column| !column[p].is_nan())).collect();
        measured.contains(&false).then_some(measured)
    }

    /// The values at those points of a group at which an observation was measured.
    pub(crate) fn measured<T: Clone>(&self, group: usize, term: &schema::Term, values: &[T]) -> Vec<T> {
        let Some(measured) = self.lacking(group, term) else { return values.to_vec() };
        let each = values.len() / measured.len().max(1);
        let kept = values.chunks_exact(each.max(1)).zip(&measured).filter(|(_, is_there)| **is_there);
        kept.flat_map(|(value, _)| value.to_vec()).collect()
    }

    /// The cloud of a term, in the engine's units, flat.
    pub(crate) fn cloud(&self, group: usize, term: &str) -> &[f64] {
        let terms = self.problem.scene.schema.groups[group].terms.iter();
        terms.zip(&self.clouds[group]).find(|(own, _)| own.name == term).map_or(&[], |(_, cloud)| cloud)
    }

    /// How noisy a row of an observation is at a point, beside its other points.
    pub(crate) fn noisiness_at(&self, (group, row): (usize, usize), point: usize) -> f64 {
        self.noisiness[group][row].get(point).copied().unwrap_or(1.0)
    }

    /// Values of an observation's row where it was measured, each over how noisy it is beside the others.
    pub(crate) fn evened(&self, (group, term): (usize, &schema::Term), row: usize, values: Vec<f64>) -> Vec<f64> {
        let own = &self.noisiness[group][row];
        if own.is_empty() {
            return values;
        }
        values.iter().zip(self.measured(group, term, own)).map(|(value, noisiness)| value / noisiness).collect()
    }

    /// How noisy the measured values of an observation's row are beside each other.
    pub(crate) fn noisiness_of(&self, (group, term): (usize, &schema::Term), row: usize) -> Vec<f64> {
        let points = self.coordinates[group].len() / self.problem.scene.schema.coordinates.len();
        let all: Vec<f64> = (0..points).map(|p| self.noisiness_at((group, row), p)).collect();
        self.measured(group, term, &all)
    }

    /// Takes observations of which it is known how noisy each value is as that: values that are left out were not measured, and a robust loss
    /// has nothing more to leave out.
    pub(crate) fn take_noisiness(&mut self) {
        for (at, group) in self.problem.scene.schema.groups.iter().enumerate() {
            for (number, term) in group.terms.iter().enumerate() {
                let own = &self.noisiness[at][term.first..][..term.rows];
                if own.iter().all(Vec::is_empty) {
                    continue;
                }
                self.losses[at][number] = Loss::Square;
                for (own, &column) in own.iter().zip(term.columns) {
                    if group.may_lack(group.columns[column].name) {
                        let values = self.columns[at][column].iter_mut().zip(own);
                        values
                            .filter(|(_, noisiness)| **noisiness == LEFT_OUT)
                            .for_each(|(value, _)| *value = f64::NAN);
                    }
                }
            }
        }
    }

    /// Keeps of a group what is said of some of its points only.
    pub(crate) fn keep_noisiness(&mut self, group: usize, points: &[usize]) {
        for own in self.noisiness[group].iter_mut().filter(|own| !own.is_empty()) {
            *own = points.iter().map(|&p| own[p]).collect();
        }
    }

    /// The same with a share of the points of groups that may exchange theirs, evenly picked.
    pub(crate) fn thinned(&self, share: f64) -> Self {
        let mut thinned = self.clone();
        let schema = self.problem.scene.schema;
        let inputs = schema.coordinates.len();
        for at in (0..schema.groups.len()).filter(|&at| is_exchangeable(&schema.groups[at])) {
            let all = self.coordinates[at].len() / inputs;
            let count = ((share * all as f64).round() as usize).clamp(1, all);
            let chosen: Vec<usize> = (0..count).map(|i| i * all / count).collect();
            let points = chosen.iter().flat_map(|&p| &self.coordinates[at][p * inputs..(p + 1) * inputs]);
            thinned.coordinates[at] = points.copied().collect();
            for (own, all) in thinned.columns[at].iter_mut().zip(&self.columns[at]) {
                *own = chosen.iter().map(|&p| all[p]).collect();
            }
            thinned.keep_noisiness(at, &chosen);
        }
        thinned
    }

    /// The same with the points of an interval of the only coordinate alone, for scenes without clouds, pairs and weights.
    pub(crate) fn between(&self, low: f64, high: f64) -> Self {
        let mut part = self.clone();
        for (at, all) in self.coordinates.iter().enumerate() {
            let is_inside: Vec<bool> = all.iter().map(|x| (low..=high).contains(x)).collect();
            let inside = |values: &[f64]| -> Vec<f64> {
                values.iter().zip(&is_inside).filter(|(_, inside)| **inside).map(|(x, _)| *x).collect()
            };
            part.coordinates[at] = inside(all);
            part.columns[at] = self.columns[at].iter().map(|column| inside(column)).collect();
            let kept: Vec<usize> = (0..all.len()).filter(|&p| is_inside[p]).collect();
            part.keep_noisiness(at, &kept);
        }
        part
    }

    pub(super) fn raw_weights(&self, group: usize) -> &[f64] {
        self.problem.groups[group].as_ref().map_or(&[], |binding| &binding.points.weights)
    }

    /// Weights of a group's points in the engine's units, if `measure` is theirs; empty if they have none.
    pub(crate) fn weights(&self, group: usize, measure: Option<&schema::Unit>) -> Vec<f64> {
        let inward = measure.map_or(Scale::new(1.0), |measure| self.system.inward(measure));
        self.raw_weights(group).iter().map(|&weight| inward.of(Number::declared(weight)).as_engine()).collect()
    }

    /// Natural size of a head: what its transformation multiplies with, or the network's scale.
    pub(crate) fn head_scale(&self, head: usize) -> f64 {
        let mut slots = self.problem.scene.schema.scalars.iter();
        let slot = slots.position(|scalar| scalar.origin == Origin::HeadScale(head));
        slot.map_or(self.scaling.scale[head], |slot| self.scalars[slot])
    }

    /// The direction from which a term's cloud was seen, if it is known.
    pub(crate) fn view(&self, group: usize, term: &str) -> Option<[f64; 3]> {
        self.problem.groups[group].as_ref()?.view(term)
    }

    /// Whether a cloud may be off over whole regions, which a change of any number would make up for.
    pub(crate) fn is_off_over_regions(&self) -> bool {
        let groups = self.problem.scene.schema.groups.iter().enumerate();
        let mut terms = groups.flat_map(|(at, group)| group.terms.iter().map(move |term| (at, term)));
        terms.any(|(at, term)| self.tolerance(at, term).is_some())
    }

    /// How far a term's cloud may be off over whole regions, if that is known.
    pub(crate) fn tolerance(&self, group: usize, term: &schema::Term) -> Option<EngineTolerance> {
        let declared = self.problem.groups[group].as_ref()?.tolerance(term.name)?;
        let [size, region] = [declared.size, declared.region].map(Number::declared);
        let inward = self.system.inward(&term.unit);
        Some(EngineTolerance {
            size: inward.of(size).as_engine(),
            region: inward.of(region).as_engine(),
            common: declared.common,
        })
    }

    /// Points given in declared units, in the engine's.
    pub(crate) fn inward(&self, points: &[f64]) -> Vec<f64> {
        inward_points(self.problem.scene.schema, &self.system, points)
    }

    /// The scene with its units, scales and scalars, without points and data.
    pub(crate) fn frame(&self) -> Frame {
        Frame {
            scene: self.problem.scene,
            system: self.system,
            scaling: self.scaling.clone(),
            scalars: self.scalars.clone(),
            learned: self.learned.clone(),
        }
    }
}
