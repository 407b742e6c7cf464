//! What an answer leaves of equations and conditions, beside what these cannot do without.
//!
//! An equation's residual is compared with the part of it that an unknown source makes up: a balance of large terms that holds
//! to a thousandth says nothing of a source that is a thousandth of them. Without a source the largest part counts. A condition
//! is compared with its own target, and one whose target is zero with what the same quantity is elsewhere.

mod parts;
mod sums;

pub(super) use parts::Sizes;

use super::{Check, root_mean_square};
use crate::facts::{Answer, Facts};
use crate::noise::of_given;
use crate::problem::Bound;
use crate::residual::Programs;
use crate::schema::{self, Term, TermKind};
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
            let message = if value.is_finite() {
                format!(
                    "`{name}.{}` is off by {:.2e}{unit}, where {said} is {:.2e}{unit}: the answer does not solve it; check the \
                     parameters and data that contradict it, or the carrier is too coarse ({})",
                    term.name,
                    outward(rms),
                    outward(scale),
                    self.finer
                )
            } else {
                format!(
                    "`{name}.{}` is not defined where it is to hold: check it, and the numbers that it reads, for a division by zero, a \
                     logarithm or a root of a negative number",
                    term.name
                )
            };
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
        if !read.is_value() || head.transformed || !head.source {
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

    fn row(&self, row: usize, jets: &[f64], columns: &[f64]) -> Vec<f64> {
        self.facts.rows_with(self.programs, self.schema, (jets, columns), self.scalars).swap_remove(row)
    }
}
