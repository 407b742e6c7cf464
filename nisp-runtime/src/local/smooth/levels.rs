//! How large fields are, and how much they vary. The level of a temperature in kelvins says nothing of what is sought.

use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::index::sample;

use super::solver::Solver;
use super::state::State;
use crate::noise::deviation;
use crate::schema::{self, Term, TermKind};
use crate::solve::vector::root_mean_square;

/// Points that are looked at, at most.
const MOST: usize = 500;
/// Least share of a field's natural size that it is taken to vary by: beside stiffer conditions rounding would hold all else.
const LEAST: f64 = 1e-3;
/// Variation of a field over its natural size up to which it is at rest.
const REST: f64 = 1e-5;

impl Solver<'_> {
    /// Takes the level of fields out of the sizes of conditions on their values: these hold as firmly in kelvins as in degrees Celsius.
    pub(super) fn leave_out_levels(&mut self, state: &State) {
        let share = |head: usize| {
            let points = self.some_points(head);
            let size = root_mean_square(self.heads.values(head, &points, &state.theta));
            (self.variation(state, head, &points) / size.max(f64::MIN_POSITIVE)).clamp(LEAST, 1.0)
        };
        let shares: Vec<f64> = (0..self.schema().heads.len()).map(share).collect();
        for (own, group) in self.sizes.iter_mut().zip(&self.groups) {
            let is_condition = |term: &&Term| {
                term.kind == TermKind::Residual && term.within.is_none() && group.schema.is_of_values(term)
            };
            for term in group.schema.terms.iter().filter(is_condition) {
                let share = term.jets.iter().map(|&jet| shares[group.schema.jets[jet].head]).fold(0.0, f64::max);
                own[term.first..term.first + term.rows].iter_mut().for_each(|size| *size *= share);
            }
        }
    }

    /// Some points of the largest group that differentiates a head, or else reads it, flat: elsewhere the head may be anything. Every so
    /// many of points that fill a domain evenly may all lie in one corner of it: they are picked at random.
    pub(super) fn some_points(&self, head: usize) -> Vec<f64> {
        let inputs = self.schema().coordinates.len();
        let groups = self.schema().groups.iter().zip(&self.bound.coordinates);
        let degree = |jet: &schema::Jet| jet.degree.iter().map(|&degree| usize::from(degree)).sum::<usize>();
        let highest = |group: &schema::Group| group.jets.iter().filter(|jet| jet.head == head).map(degree).max();
        let reading = groups.filter_map(|(group, points)| Some((highest(group)? > 0, points)));
        let largest =
            reading.max_by_key(|(differentiates, points)| (*differentiates, points.len())).map(|(_, own)| own);
        let points = largest.map_or(&[][..], |points| points.as_slice());
        let count = points.len() / inputs;
        let chosen = sample(&mut StdRng::seed_from_u64(0), count, count.min(MOST));
        chosen.into_iter().flat_map(|at| &points[at * inputs..][..inputs]).copied().collect()
    }

    /// How much a head varies over points, no less than [`LEAST`]; its natural size where it is the same everywhere.
    pub(super) fn variation(&self, state: &State, head: usize, points: &[f64]) -> f64 {
        let (values, natural) = (self.heads.values(head, points, &state.theta), self.heads.scale[head]);
        let varies = deviation(&values);
        if varies > REST * natural { varies.max(LEAST * natural) } else { natural }
    }
}
