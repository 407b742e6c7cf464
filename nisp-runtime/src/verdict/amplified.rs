//! Whether an answer is far larger than anything that conditions and equations speak of. Conditions that stand where a motion ends,
//! instead of where it begins, leave the beginning to rounding, and so do equations along which small errors grow.

use super::{Check, root_mean_square};
use crate::facts::{Answer, Facts};
use crate::problem::Bound;
use crate::residual::Programs;
use crate::schema::{self, Term, TermKind};
use crate::units::Number;

/// A field over what is given of it.
const AMPLIFIED: f64 = 1e2;

/// A check of every field that is amplified, of an answer that is off by more than it may be; `values` are those of all heads over the
/// domain. What finer cells do not change may be as large as it is.
pub(super) fn checks(bound: &Bound, answer: &Answer, values: &[Vec<f64>]) -> Vec<Check> {
    let heads = bound.problem.scene().schema.heads.iter().enumerate();
    let fields = heads.filter(|(_, head)| !head.source && !head.transformed);
    let check = |(at, head): (usize, &schema::Head)| {
        let largest = values[at].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let natural = bound.scaling.offset[at].abs() + bound.head_scale(at);
        let given = stated(bound, answer, at).fold(natural, f64::max);
        let outward = |x| bound.system.outward(&head.unit).of(Number::engine(x));
        let said = format!(
            "`{}` is as large as {:.1e}{unit}, where conditions and equations speak of {:.1e}{unit}: a condition stands at the wrong end \
             or is missing (what flows in is given where it enters, what begins where time begins), or small errors grow along the \
             equations",
            head.name,
            outward(largest),
            outward(given),
            unit = head.unit.behind()
        );
        Check::new("amplified", ("", head.name), (largest / given, AMPLIFIED), said)
    };
    fields.map(check).filter(|check| !check.passed).collect()
}

/// The largest value that each condition on a head alone gives it.
fn stated(bound: &Bound, answer: &Answer, head: usize) -> impl Iterator<Item = f64> {
    let schema = bound.problem.scene().schema;
    let kernels = bound.problem.scene().double();
    let groups = schema.groups.iter().zip(&answer.facts).zip(kernels).filter(|((group, _), _)| !group.is_beliefs());
    groups.flat_map(move |((group, facts), kernel)| {
        let is_value = move |term: &&Term| match *term.jets {
            [jet] if term.kind == TermKind::Residual => group.jets[jet].head == head && group.jets[jet].is_value(),
            _ => false,
        };
        let terms = group.terms.iter().filter(is_value);
        let rows = terms.flat_map(|term| (term.first..term.first + term.rows).map(move |row| (term.jets[0], row)));
        rows.map(move |place| largest(facts, kernel.programs, group, (place, &answer.scalars))).collect::<Vec<_>>()
    })
}

/// What is left of a row where its head is zero, at most, over its slope.
fn largest(
    facts: &Facts,
    programs: &dyn Programs<f64>,
    group: &schema::Group,
    ((jet, row), scalars): ((usize, usize), &[f64]),
) -> f64 {
    let slope = root_mean_square(facts.slopes(programs, group, row, scalars)[jet].iter().copied());
    let jets = vec![0.0; facts.jets.len()];
    let rest = facts.rows_with(programs, group, (&jets, &facts.columns), scalars).swap_remove(row);
    let largest = rest.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if slope > 0.0 { largest / slope } else { 0.0 }
}
