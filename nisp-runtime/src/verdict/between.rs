//! Fields that go far beyond what is measured and stated of them, at places between.

use super::Check;
use crate::ends::ends;
use crate::facts::Answer;
use crate::problem::Bound;
use crate::schema::{Term, TermKind};
use crate::units::Number;

/// The range of a field over its range where it is measured or stated, at most. Of 127 answers the right ones had 1.8 at most, and the wrong
/// ones 5 and more.
const FARTHEST: f64 = 3.0;

/// One check for every measured field over several coordinates, whose values over the domain are `[head][point]` in the engine's units. Where
/// little is stated, equations let a field swing at will between sensors, and a wrong equation then meets all data.
pub(super) fn checks(bound: &Bound, answer: &Answer, values: &[Vec<f64>]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    if schema.coordinates.len() == 1 {
        return Vec::new();
    }
    let observed = schema.observed();
    let fields = (0..schema.heads.len()).filter(|head| observed.contains(head) && !schema.heads[*head].source);
    let check = |head: usize| {
        let told = ends(told(bound, answer, head).into_iter());
        let all = ends(values[head].iter().copied());
        let range = |(low, high): (f64, f64)| high - low;
        if !(range(told) > 0.0 && range(told).is_finite()) {
            return None;
        }
        let (name, unit) = (schema.heads[head].name, &schema.heads[head].unit);
        let outward = bound.system.outward(unit);
        let words = |value: f64| format!("{:.3e}{}", outward.of(Number::engine(value)).as_declared(), unit.behind());
        let said = format!(
            "`{name}` goes from {} to {}, but where it is measured or stated only from {} to {}: nothing holds it in between; check the \
             equations, state how it begins, or measure at more places",
            words(all.0),
            words(all.1),
            words(told.0),
            words(told.1)
        );
        Some(Check::new("between", ("", name), (range(all) / range(told), FARTHEST), said))
    };
    fields.filter_map(check).collect()
}

/// Values of a field where it is measured, and where a condition states it.
fn told(bound: &Bound, answer: &Answer, head: usize) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let conditions = schema.conditions();
    let mut told = Vec::new();
    for (at, (group, facts)) in schema.groups.iter().zip(&answer.facts).enumerate() {
        let tells =
            |term: &&Term| term.kind == TermKind::Observation || conditions.contains(&at) && group.is_of_values(term);
        for term in group.terms.iter().filter(tells) {
            for &jet in term.jets.iter().filter(|&&jet| group.jets[jet].head == head && group.jets[jet].is_value()) {
                told.extend(bound.measured(at, term, &facts.jets[jet * facts.stride..][..facts.points]));
            }
        }
    }
    told
}
