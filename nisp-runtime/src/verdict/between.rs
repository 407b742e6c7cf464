//! Fields that go far beyond what is measured and stated of them, at places between.

use super::Check;
use crate::ends::ends;
use crate::facts::{Answer, Facts};
use crate::problem::Bound;
use crate::schema::{Term, TermKind};
use crate::units::Number;

/// The range of a field over its range where it is measured or stated, at most. Of 127 answers the right ones had 1.8 at most, and the wrong
/// ones 5 and more.
const FARTHEST: f64 = 3.0;
/// Share of the domain, at either end of the values, that does not count.
const FEW: f64 = 0.01;

/// One check for every measured field over several coordinates, whose values over the domain are `[head][point]` in the engine's units. Where
/// little is stated, equations let a field swing at will between sensors, and a wrong equation then meets all data.
pub(super) fn checks(bound: &Bound, answer: &Answer, values: &[Vec<f64>]) -> Vec<Check> {
    let schema = bound.problem.scene().schema;
    if schema.coordinates.len() == 1 {
        return Vec::new();
    }
    let shown = |head: &usize| {
        let is_shown = |term: &&Term| matches!(term.kind, TermKind::Chamfer { .. });
        let mut terms = schema.groups.iter().flat_map(|group| group.terms.iter().map(move |term| (group, term)));
        terms.any(|(group, term)| is_shown(&term) && term.jets.iter().any(|&jet| group.jets[jet].head == *head))
    };
    let observed = schema.observed();
    let is_asked = |head: &usize| observed.contains(head) && !schema.heads[*head].source && !shown(head);
    let fields = (0..schema.heads.len()).filter(is_asked);
    let check = |head: usize| {
        let told = ends(told(bound, answer, head));
        let all = most(&values[head]);
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

/// The ends of values without the farthest few: a corner that nothing holds may be far off.
fn most(values: &[f64]) -> (f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let few = (FEW * values.len() as f64) as usize;
    ends(sorted[few..values.len() - few].iter().copied())
}

/// Values of a field where it is measured, and where a condition states it.
fn told(bound: &Bound, answer: &Answer, head: usize) -> Vec<f64> {
    let schema = bound.problem.scene().schema;
    let (conditions, kernels) = (schema.conditions(), bound.problem.scene().double());
    let mut told = Vec::new();
    for (at, (group, facts)) in schema.groups.iter().zip(&answer.facts).enumerate() {
        let rows = |facts: &Facts| facts.plain_rows(kernels[at].programs, group, &answer.scalars);
        let values = (0..group.jets.len()).filter(|&jet| group.jets[jet].head == head && group.jets[jet].is_value());
        for jet in values {
            let own = &facts.jets[jet * facts.stride..][..facts.points];
            let terms = || group.terms.iter().filter(|term| term.jets.contains(&jet));
            for term in terms().filter(|term| term.kind == TermKind::Observation) {
                told.extend(bound.measured(at, term, own));
            }
            let mut stating = terms().filter(|term| conditions.contains(&at) && group.is_of_values(term)).peekable();
            if stating.peek().is_none() {
                continue;
            }
            // A factor that is zero on one side of a domain states nothing there.
            let mut moved = facts.clone();
            moved.jets[jet * facts.stride..][..facts.points].iter_mut().for_each(|value| *value += 1.0);
            let (before, after) = (rows(facts), rows(&moved));
            let stated: Vec<usize> = stating.flat_map(|term| term.first..term.first + term.rows).collect();
            let is_stated = |p: &usize| stated.iter().any(|&row| before[row][*p] != after[row][*p]);
            told.extend((0..facts.points).filter(is_stated).map(|p| own[p]));
        }
    }
    told
}
