//! How large the parts are that a row adds up.

use super::{FEW_POINTS, Judged, NOTHING, root_mean_square};
use crate::ends::ends;
use crate::schema::Term;

/// Network output that puts a bounded quantity on its bound.
const ON_BOUND: f64 = -40.0;

/// Typical values of every head in an answer.
pub(in crate::verdict) struct Sizes {
    /// Mean over the points of all groups.
    mean: Vec<f64>,
    /// Half of its range there.
    spread: Vec<f64>,
}

impl Sizes {
    /// Of values in the engine's units, `[head][point]`.
    pub(in crate::verdict) fn of(values: &[Vec<f64>]) -> Self {
        let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let half = |values: &Vec<f64>| {
            let (low, high) = ends(values.iter().copied());
            (high - low).max(0.0) / 2.0
        };
        Self { mean: values.iter().map(mean).collect(), spread: values.iter().map(half).collect() }
    }
}

pub(super) struct Parts {
    /// The smallest part that a source makes up, if the term reads one.
    pub(super) source: Option<f64>,
    pub(super) largest: f64,
    /// True for a condition on one quantity, which nothing else can balance.
    pub(super) stated: bool,
}

impl Judged<'_> {
    /// Sizes of the parts of a row.
    pub(super) fn parts(&self, term: &Term, row: usize) -> Parts {
        let heads = &self.bound.problem.scene().schema.heads;
        let slopes = self.facts.slopes(self.programs, self.schema, row, self.scalars);
        let is_bounded = |at: usize| {
            let jet = &self.schema.jets[at];
            jet.is_value() && heads[jet.head].transformed && !heads[jet.head].hard
        };
        // On its bound a quantity has no slope, and is read all the same.
        let is_read = |jet: &usize| match is_bounded(*jet) {
            true => self.slope_within_bounds(*jet, row) != 0.0,
            false => slopes[*jet].iter().any(|slope| *slope != 0.0),
        };
        let read: Vec<usize> = term.jets.iter().copied().filter(is_read).collect();
        let whole = self.row(row, &self.facts.jets, &self.facts.columns);
        let part = |jets: &[f64], columns: &[f64]| {
            let rest = self.row(row, jets, columns);
            root_mean_square(whole.iter().zip(&rest).map(|(whole, rest)| whole - rest).filter(|x| x.is_finite()))
        };
        let mut largest = 0.0f64;
        let mut source: Option<f64> = None;
        for head in 0..heads.len() {
            let own: Vec<usize> = read.iter().copied().filter(|&jet| self.schema.jets[jet].head == head).collect();
            if own.is_empty() {
                continue;
            }
            if heads[head].source {
                let size = part(&self.without(&own), &self.facts.columns);
                source = Some(source.map_or(size, |other| other.min(size)));
                largest = largest.max(size);
                continue;
            }
            for &jet in &own {
                largest = largest.max(part(&self.without(&[jet]), &self.facts.columns));
            }
        }
        let nothing = self.without(&read);
        let constant = self.row(row, &nothing, &self.facts.columns);
        let mut given = root_mean_square(constant.into_iter().filter(|x| x.is_finite()));
        if !self.facts.columns.is_empty() {
            given = given.max(part(&self.facts.jets, &vec![0.0; self.facts.columns.len()]));
        }
        largest = largest.max(given);
        let is_low = self.is_low(&read);
        // A quantity that is to vanish is all of its own residual.
        let vanishes = read.len() == 1 && given == 0.0;
        if is_low || vanishes || self.facts.points <= FEW_POINTS {
            largest = largest.max(self.elsewhere(&read, &slopes, row));
        }
        // A term of sources alone is no balance.
        let balance = read.iter().any(|&jet| !heads[self.schema.jets[jet].head].source);
        let value = |&jet: &usize| self.schema.jets[jet].head;
        // Where a layer makes a higher derivative large, its size elsewhere is a guess.
        let stated = self.facts.points <= FEW_POINTS && is_low
            || !balance
            || read.windows(2).all(|two| value(&two[0]) == value(&two[1]));
        Parts { source: source.filter(|_| balance), largest, stated }
    }

    /// True for a condition on values and slopes: where its target is zero, only elsewhere says how large they are. Of higher
    /// derivatives that is a guess.
    fn is_low(&self, read: &[usize]) -> bool {
        let order = |jet: usize| self.schema.jets[jet].degree.iter().map(|&degree| u32::from(degree)).sum::<u32>();
        read.iter().all(|&jet| order(jet) <= 1)
    }

    /// The size of a row if its quantity were as large as elsewhere.
    fn elsewhere(&self, read: &[usize], slopes: &[Vec<f64>], row: usize) -> f64 {
        let half = &self.bound.scaling.half;
        // A bounded field's number runs away near the bound, and its derivatives more so: the parts alone say how large they are.
        let head = |at: usize| self.schema.jets[at].head;
        let is_derived = |at: usize| {
            let mut own = read.iter().filter(|&&other| head(other) == head(at));
            self.bound.problem.scene().schema.heads[head(at)].transformed
                && own.any(|&other| !self.schema.jets[other].is_value())
        };
        let sizes = read.iter().filter(|&&at| !is_derived(at)).map(|&at| {
            let jet = &self.schema.jets[at];
            let head = &self.bound.problem.scene().schema.heads[jet.head];
            let over: f64 = jet.degree.iter().zip(half).map(|(&degree, half)| half.powi(i32::from(degree))).product();
            let slope = if head.transformed && !head.hard && jet.is_value() {
                self.slope_within_bounds(at, row)
            } else {
                root_mean_square(slopes[at].iter().copied())
            };
            let natural = if head.source { NOTHING * self.bound.head_scale(jet.head) } else { 0.0 };
            slope * self.sizes.spread[jet.head].max(natural) / over
        });
        sizes.fold(0.0, f64::max)
    }

    /// Mean derivative of a row by the value of a bounded head, from its bound inwards.
    fn slope_within_bounds(&self, at: usize, row: usize) -> f64 {
        let head = self.schema.jets[at].head;
        let declared = &self.bound.problem.scene().schema.heads[head];
        let with = |value: f64| {
            let mut jets = self.facts.jets.clone();
            jets[at * self.facts.stride..][..self.facts.stride].fill(value);
            self.row(row, &jets, &self.facts.columns)
        };
        let change = with(0.0).into_iter().zip(with(ON_BOUND)).map(|(inside, bound)| inside - bound);
        let size = self.bound.system.size(&declared.unit);
        // A network output of zero: softplus is the logarithm of two, a sigmoid one half.
        let moved = match (declared.lower, declared.upper) {
            (Some(lower), Some(upper)) => size.back(upper - lower).as_engine() / 2.0,
            _ => std::f64::consts::LN_2 * self.bound.head_scale(head),
        };
        root_mean_square(change) / moved
    }

    /// The jets, with some of them taken out: derivatives zero, sources zero or on their bound, fields at their mean.
    fn without(&self, taken: &[usize]) -> Vec<f64> {
        let heads = &self.bound.problem.scene().schema.heads;
        let mut jets = self.facts.jets.clone();
        for &at in taken {
            let jet = &self.schema.jets[at];
            let head = &heads[jet.head];
            let value = match (jet.is_value(), head.source) {
                (true, _) if head.transformed && !head.hard => ON_BOUND,
                (true, false) => self.sizes.mean[jet.head],
                _ => 0.0,
            };
            jets[at * self.facts.stride..][..self.facts.stride].fill(value);
        }
        jets
    }
}
