//! What an answer leaves of equations and conditions, beside what these cannot do without.
//!
//! An equation's residual is compared with the part of it that an unknown source makes up: a balance of large terms that holds
//! to a thousandth says nothing of a source that is a thousandth of them. Without a source the largest part counts. A condition
//! is compared with its own target, and one whose target is zero with what the same quantity is elsewhere.

use super::{Check, root_mean_square};
use crate::facts::{Answer, Facts};
use crate::noise::of_given;
use crate::problem::Bound;
use crate::residual::Programs;
use crate::schema::{self, Jet, Term, TermKind};
use crate::units::Number;

/// Limit of a residual over its source. Where nothing is measured the limit is [`PART`], since equations alone say what the source is.
const SOURCE: f64 = 0.3;
/// Residual of a balance without a source over its largest part.
const BALANCE: f64 = 0.2;
/// Residual of a condition over its target, or over what the same quantity is elsewhere.
const PART: f64 = 0.03;
/// The same, of equations and of conditions, where nothing is measured and nothing is sought, and no finer cells tell how far the answer
/// is off: what is left of the equations is all that does. Where finer cells do, equations are held to what conditions are.
const STRICT: f64 = 3e-4;
/// Parts over their natural size below which an equation is at rest, and what is left of it is rounding.
const REST: f64 = 1e-4;
/// A source smaller than this share of an equation's largest part, or of its own natural size, counts as so large: next to
/// nothing acts.
const NOTHING: f64 = 0.05;
/// What a condition states over the size that equations and data speak of.
const STATED: f64 = 1e2;
/// Points of a condition at most; more of them are held to an equation.
const FEW_POINTS: usize = 8;
/// Misfit over a declared tolerance.
const TOLERANCE: f64 = 3.0;
/// Network output that puts a bounded quantity on its bound.
const ON_BOUND: f64 = -40.0;

/// Typical values of every head in an answer.
pub(super) struct Sizes {
    /// Mean over the points of all groups.
    mean: Vec<f64>,
    /// Half of its range there.
    spread: Vec<f64>,
}

impl Sizes {
    /// Of values in the engine's units, `[head][point]`.
    pub(super) fn of(values: &[Vec<f64>]) -> Self {
        let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let half = |values: &Vec<f64>| {
            let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
            (ends.1 - ends.0).max(0.0) / 2.0
        };
        Self { mean: values.iter().map(mean).collect(), spread: values.iter().map(half).collect() }
    }
}

fn is_value(jet: &Jet) -> bool {
    jet.degree.iter().all(|&degree| degree == 0)
}

/// A group under judgement.
struct Judged<'a> {
    bound: &'a Bound,
    group: usize,
    schema: &'static schema::Group,
    facts: &'a Facts,
    programs: &'a dyn Programs<f64>,
    sizes: &'a Sizes,
    scalars: &'a [f64],
    finer: &'static str,
    /// Limit of a residual without a source, over its largest part.
    balance: f64,
    /// Limit of a residual with a source, over its source.
    source: f64,
}

/// Checks of the equations and conditions of a group.
pub(super) fn checks(
    bound: &Bound,
    group: usize,
    (facts, rows): (&Facts, &[Vec<f64>]),
    programs: &dyn Programs<f64>,
    (sizes, answer): (&Sizes, &Answer),
) -> Vec<Check> {
    let scene = bound.problem.scene().schema;
    let schema = &scene.groups[group];
    let is_strict = scene.observed().is_empty() && scene.heads.iter().all(|head| !head.source);
    let balance = match (is_strict, answer.refined) {
        (false, _) => BALANCE,
        (true, Some(_)) => PART,
        (true, None) => STRICT,
    };
    let source = if scene.observed().is_empty() { PART } else { SOURCE };
    let (scalars, finer) = (&answer.scalars, answer.finer);
    let judged = Judged { bound, group, schema, facts, programs, sizes, scalars, finer, balance, source };
    let mut checks = Vec::new();
    for (term, natural) in schema.terms.iter().zip(&bound.sizes[group]) {
        match term.kind {
            TermKind::Residual => checks.extend(judged.residual((term, *natural), rows)),
            TermKind::Integral => checks.extend(judged.sums(group, term)),
            _ => {}
        }
    }
    checks
}

impl Judged<'_> {
    fn residual(&self, (term, natural): (&'static Term, f64), rows: &[Vec<f64>]) -> Vec<Check> {
        let name = self.schema.name;
        let outward = |x| self.bound.system.outward(&term.unit).of(Number::engine(x));
        let unit = term.unit.behind();
        let condition = self.facts.points <= FEW_POINTS;
        let mut worst: Option<Check> = None;
        let noise = of_given(self.bound, self.group);
        let blurs = self.facts.blurs(self.programs, self.schema, self.scalars, &noise);
        let beyond = (term.first..term.first + term.rows).filter(|_| condition).find_map(|row| self.beyond(term, row));
        for (row, values) in rows.iter().enumerate().skip(term.first).take(term.rows) {
            let rms = root_mean_square(values.iter().copied());
            let (kind, scale, limit, said) = if let Some(within) = term.within {
                let within = self.bound.system.size(&term.unit).back(within).as_engine();
                ("tolerance", within, TOLERANCE, "its declared tolerance")
            } else {
                let parts = self.parts(term, row);
                let kind = if condition { "condition" } else { "equation" };
                match parts.source {
                    Some(source) if !condition => {
                        (kind, source.max(NOTHING * parts.largest), self.source, "its source")
                    }
                    _ => {
                        let limit = if parts.stated { PART.min(self.balance) } else { self.balance };
                        (kind, parts.largest.max(REST * natural), limit, "its largest part")
                    }
                }
            };
            // What the noise of its columns makes of an equation is not left by the answer.
            let beside = if rms <= blurs[row] { 0.0 } else { (rms * rms - blurs[row] * blurs[row]).sqrt() };
            let value = if beside == 0.0 { 0.0 } else { beside / scale };
            let message = format!(
                "`{name}.{}` is off by {:.2e}{unit}, where {said} is {:.2e}{unit}: the answer does not solve it; check the \
                 parameters and data that contradict it, or the carrier is too coarse ({})",
                term.name,
                outward(rms),
                outward(scale),
                self.finer
            );
            let check = Check::new(kind, (name, term.name), (value, limit), message);
            if worst.as_ref().is_none_or(|worst| check.value.total_cmp(&worst.value).is_gt()) {
                worst = Some(check);
            }
        }
        worst.into_iter().chain(beyond).collect()
    }

    /// A value that a condition states where it is far beyond what equations and data speak of: its unit or its value is off,
    /// or another part of the problem is.
    fn beyond(&self, term: &'static Term, row: usize) -> Option<Check> {
        let [jet] = *term.jets else { return None };
        let read = &self.schema.jets[jet];
        let head = &self.bound.problem.scene().schema.heads[read.head];
        // Equations hold a field to what it is stated to be, and data to what it becomes; a source may be anything next to it.
        if !is_value(read) || head.transformed || !head.source {
            return None;
        }
        let slopes = self.facts.slopes(self.programs, self.schema, row, self.scalars);
        let natural = self.bound.scaling.offset[read.head].abs() + self.bound.head_scale(read.head);
        let natural = root_mean_square(slopes[jet].iter().copied()) * natural;
        let mut jets = self.facts.jets.clone();
        jets[jet * self.facts.stride..][..self.facts.stride].fill(0.0);
        let stated = root_mean_square(self.row(row, &jets, &self.facts.columns));
        let outward = |x| self.bound.system.outward(&term.unit).of(Number::engine(x));
        let said = format!(
            "`{}.{}` states {:.2e}{unit}, where the equations and the data speak of {:.2e}{unit}: check its value and the units \
             of the data",
            self.schema.name,
            term.name,
            outward(stated),
            outward(natural),
            unit = term.unit.behind()
        );
        let check = Check::new("stated", (self.schema.name, term.name), (stated / natural, STATED), said);
        Some(check).filter(|check| !check.passed)
    }

    /// Sizes of the parts of a row.
    fn parts(&self, term: &Term, row: usize) -> Parts {
        let heads = &self.bound.problem.scene().schema.heads;
        let slopes = self.facts.slopes(self.programs, self.schema, row, self.scalars);
        let is_bounded = |at: usize| {
            let jet = &self.schema.jets[at];
            is_value(jet) && heads[jet.head].transformed && !heads[jet.head].hard
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
                && own.any(|&other| !is_value(&self.schema.jets[other]))
        };
        let sizes = read.iter().filter(|&&at| !is_derived(at)).map(|&at| {
            let jet = &self.schema.jets[at];
            let head = &self.bound.problem.scene().schema.heads[jet.head];
            let over: f64 = jet.degree.iter().zip(half).map(|(&degree, half)| half.powi(i32::from(degree))).product();
            let slope = if head.transformed && !head.hard && is_value(jet) {
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

    fn row(&self, row: usize, jets: &[f64], columns: &[f64]) -> Vec<f64> {
        self.facts.rows_with(self.programs, self.schema, (jets, columns), self.scalars).swap_remove(row)
    }

    /// The jets, with some of them taken out: derivatives zero, sources zero or on their bound, fields at their mean.
    fn without(&self, taken: &[usize]) -> Vec<f64> {
        let heads = &self.bound.problem.scene().schema.heads;
        let mut jets = self.facts.jets.clone();
        for &at in taken {
            let jet = &self.schema.jets[at];
            let head = &heads[jet.head];
            let value = match (is_value(jet), head.source) {
                (true, _) if head.transformed && !head.hard => ON_BOUND,
                (true, false) => self.sizes.mean[jet.head],
                _ => 0.0,
            };
            jets[at * self.facts.stride..][..self.facts.stride].fill(value);
        }
        jets
    }

    /// Weighted sums beside their targets.
    fn sums(&self, group: usize, term: &'static Term) -> Vec<Check> {
        let mut targets = vec![0.0; self.schema.rows];
        self.programs.target(self.scalars, &mut targets);
        let weights = self.bound.weights(group, term.measure.as_ref());
        let outward = |x| self.bound.system.outward(&term.unit).of(Number::engine(x));
        let whole = self.facts.plain_rows(self.programs, self.schema, self.scalars);
        let mut checks = Vec::new();
        for row in term.first..term.first + term.rows {
            let parts = whole[row].iter().enumerate().map(|(p, x)| x * weights.get(p).copied().unwrap_or(1.0));
            let (sum, size) = parts.fold((0.0, 0.0f64), |(sum, size), x| (sum + x, size + x.abs()));
            let off = (sum - targets[row]).abs();
            let (scale, limit) = match term.within {
                Some(within) => (self.bound.system.size(&term.unit).back(within).as_engine(), TOLERANCE),
                None => (size.max(targets[row].abs()), PART),
            };
            let said = format!(
                "`{}.{}` sums to {:.3e}{} where {:.3e} is wanted: the answer does not meet it; check what is given against the \
                 other data",
                self.schema.name,
                term.name,
                outward(sum),
                term.unit.behind(),
                outward(targets[row])
            );
            let value = if off == 0.0 { 0.0 } else { off / scale };
            checks.push(Check::new("sum", (self.schema.name, term.name), (value, limit), said));
        }
        checks
    }
}

struct Parts {
    /// The smallest part that a source makes up, if the term reads one.
    source: Option<f64>,
    largest: f64,
    /// True for a condition on one quantity, which nothing else can balance.
    stated: bool,
}
