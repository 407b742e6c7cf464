//! What a source is along conditions that surround a domain.

use super::Solution;
use super::over_domain::some;
use crate::ends::{ends, ranges};
use crate::schema::{Term, TermKind};
use crate::verdict::{Check, edges};

/// A place, and how large a source is there.
type Sized<'a> = (&'a [f64], f64);

impl Solution {
    /// Checks of sources that crowd along what is stated of a field all around, from what [`Solution::values_over_domain`] gives. On one side
    /// alone, or where a record begins, a source may well be largest: light is absorbed where it comes in.
    pub(super) fn edges(&self, values: &[Vec<f64>]) -> Vec<Check> {
        let (schema, inputs) = (self.scene(), self.scene().coordinates.len());
        let is_source = |head: &usize| schema.heads[*head].source && schema.axes(*head).len() == inputs;
        let mut checks = Vec::new();
        for (name, places) in self.stated_around() {
            for head in (0..schema.heads.len()).filter(is_source) {
                let sizes = self.beside_and_elsewhere(&self.sizes(&values[head], head), &places);
                checks.extend(edges::check(schema.heads[head].name, name, sizes));
            }
        }
        checks
    }

    /// Names of fields whose values are stated on both sides along every coordinate but time, and where.
    fn stated_around(&self) -> Vec<(&'static str, Vec<&[f64]>)> {
        /// Share of the range within which a place is on a side.
        const CLOSE: f64 = 0.05;
        /// Places that say what is along them, at most.
        const MOST: usize = 200;
        let schema = self.scene();
        let inputs = schema.coordinates.len();
        let ranges = ranges(&self.bound.coordinates, inputs);
        let in_space: Vec<usize> = (0..inputs).filter(|&at| !schema.coordinates[at].unit.is_time()).collect();
        let fields = schema.heads.iter().enumerate().filter(|(_, head)| !head.source);
        let stated = fields.map(|(head, field)| {
            let states = |at: &usize| {
                let group = &schema.groups[*at];
                let reads = |term: &Term| term.jets.iter().any(|&jet| group.jets[jet].head == head);
                let is_of_values = |term: &Term| term.kind == TermKind::Residual && group.is_of_values(term);
                group.terms.iter().any(|term| is_of_values(term) && reads(term)) && !self.is_beginning(*at)
            };
            let groups = schema.conditions().into_iter().filter(states);
            let places: Vec<&[f64]> = groups.flat_map(|at| some(&self.bound.coordinates[at], inputs)).collect();
            let every = places.len().div_ceil(MOST).max(1) | 1;
            (field.name, places.into_iter().step_by(every).collect::<Vec<&[f64]>>())
        });
        let is_around = |(_, places): &(&str, Vec<&[f64]>)| {
            let reaches = |&at: &usize| {
                let ((low, high), whole) = (ends(places.iter().map(|place| place[at])), ranges[at]);
                let close = CLOSE * (whole.1 - whole.0);
                low < whole.0 + close && high > whole.1 - close
            };
            !places.is_empty() && !in_space.is_empty() && in_space.iter().all(reaches)
        };
        stated.filter(is_around).collect()
    }

    /// Whether the places of a group are all at one time.
    fn is_beginning(&self, group: usize) -> bool {
        let (coordinates, points) = (self.scene().coordinates, &self.bound.coordinates[group]);
        let mut times = (0..coordinates.len()).filter(|&at| coordinates[at].unit.is_time());
        times.any(|at| points.chunks_exact(coordinates.len()).all(|point| point[at] == points[at]))
    }

    /// A source's sizes where equations read it.
    fn sizes(&self, values: &[f64], head: usize) -> Vec<Sized<'_>> {
        let (schema, conditions) = (self.scene(), self.scene().conditions());
        let (mut first, mut all) = (0, Vec::new());
        for (at, (group, points)) in schema.groups.iter().zip(&self.bound.coordinates).enumerate() {
            let own = some(points, schema.coordinates.len()).zip(&values[first..]);
            let own: Vec<Sized<'_>> = own.map(|(place, value)| (place, value.abs())).collect();
            first += own.len();
            if !conditions.contains(&at) && group.jets.iter().any(|jet| jet.head == head) {
                all.extend(own);
            }
        }
        all
    }

    /// How large a source is next to places, and far from all of them, as far as coordinates range.
    fn beside_and_elsewhere(&self, all: &[Sized<'_>], places: &[&[f64]]) -> (Vec<f64>, Vec<f64>) {
        /// Shares of half the range that are far.
        const FAR: f64 = 0.2;
        let half = &self.bound.scaling.half;
        let apart = |a: &[f64], b: &[f64]| -> f64 {
            let along = a.iter().zip(b).zip(half);
            along.map(|((a, b), half)| ((a - b) / half).powi(2)).sum()
        };
        let nearest = |place: &&[f64]| all.iter().min_by(|a, b| apart(a.0, place).total_cmp(&apart(b.0, place)));
        let is_far = |point: &[f64]| places.iter().all(|place| apart(point, place) > FAR.powi(2));
        let beside = places.iter().filter_map(nearest).map(|(_, size)| *size);
        (beside.collect(), all.iter().filter(|(point, _)| is_far(point)).map(|(_, size)| *size).collect())
    }
}
