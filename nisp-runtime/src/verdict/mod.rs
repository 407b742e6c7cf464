//! Whether an answer deserves to be called right, judged from the problem and the data alone.
//!
//! A solver knows how its steps went. That says little about the answer: a loss can be at its minimum while a condition is
//! ignored or the equations do not describe the data. The checks here see only what the answer leaves of every equation,
//! condition, observation and cloud, whatever carries the answer and whatever found it.

mod amplified;
mod believed;
mod between;
mod blurred;
mod clouds;
mod contradicted;
pub(crate) mod edges;
mod equations;
pub(crate) mod faint;
mod filtered;
mod free;
mod gathered;
mod interpolated;
mod jolts;
pub(crate) mod jumps;
pub(crate) mod known;
mod lasting;
pub(crate) mod leaning;
mod leaps;
mod learned;
mod left_out;
mod misfits;
mod moving;
mod observations;
pub(crate) mod outliers;
mod outside;
mod parts;
mod patterns;
mod repeated;
mod scaled;
pub(crate) mod settled;
mod slow;
mod smooth;

mod stretches;
mod taken;
mod told;

use crate::facts::Answer;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::solve::vector::root_mean_square;

/// What is left of an equation that is held firmly, as a share of what may be left.
const FIRM: f64 = 0.25;

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What was looked at: `equation`, `condition`, `stated`, `sum`, `tolerance`, `misfit`, `noise`, `pattern`, `stretch`,
    /// `rhythm`, `filtered`, `repeated`, `polled`, `jolt`, `edge`, `outliers`, `held`, `left`, `outside`, `between`, `settled`, `given`, `told`,
    /// `distance`, `seen`, `patch`, `faint`, `determined`, `leaning`, `believed`, `known`, `contradicted`, `refined`, `amplified`, `agreed` or `range`.
    pub check: &'static str,
    /// The group of points; empty for learned scalars and for the answer as a whole.
    pub group: &'static str,
    /// The term, or the learned scalar; empty for the answer as a whole.
    pub term: &'static str,
    /// What was found, without unit.
    pub value: f64,
    /// The largest value that passes.
    pub limit: f64,
    /// Whether it passes. A value that is not finite does not.
    pub passed: bool,
    /// What was found, and what to do where it does not pass.
    pub message: String,
}

/// All checks of an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// In the order of groups and terms.
    pub checks: Vec<Check>,
}

impl Verdict {
    /// True if every check passes.
    pub fn passed(&self) -> bool {
        self.checks.iter().all(|check| check.passed)
    }

    /// True where an answer holds its equations firmly and misses the data: these equations do not describe the data, and another
    /// answer could only fit them by bending the equations. Also where the data leave a source or a learned scalar open, and where they are not as
    /// they were measured: so does any other answer.
    pub(crate) fn contradicts(&self) -> bool {
        if self.failed().any(|check| {
            matches!(
                check.check,
                "determined" | "leaning" | "believed" | "filtered" | "repeated" | "polled" | "held" | "jolt" | "edge"
            )
        }) {
            return true;
        }
        let misses = |check: &Check| {
            matches!(check.check, "misfit" | "pattern" | "stretch" | "rhythm" | "given" | "contradicted")
        };
        self.failed().any(misses) && self.is_firm()
    }

    /// True where an answer holds its equations firmly.
    pub(crate) fn is_firm(&self) -> bool {
        let mut equations = self.checks.iter().filter(|check| check.check == "equation");
        equations.all(|check| check.value <= FIRM * check.limit)
    }

    /// By how much a check is missed, at most.
    pub(crate) fn worst(&self) -> f64 {
        self.failed().map(|check| check.value / check.limit).fold(0.0, f64::max)
    }

    /// The checks that do not pass.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| !check.passed)
    }
}

impl Check {
    fn new(check: &'static str, place: (&'static str, &'static str), (value, limit): (f64, f64), said: String) -> Self {
        let (group, term) = place;
        let passed = value <= limit;
        let message = if passed { format!("it passed: {value:.2e} of at most {limit:.2e}") } else { said };
        Self { check, group, term, value, limit, passed, message }
    }
}

/// Judges an answer, whose heads have these values over the domain, `[head][point]` in the engine's units.
pub(crate) fn judge(bound: &Bound, answer: &Answer, values: &[Vec<f64>], noise: &Noise) -> Verdict {
    let schema = bound.problem.scene().schema;
    let sizes = equations::Sizes::of(values);
    let kernels = bound.problem.scene().double();
    // What is given wrongly leaves its traces everywhere: the likely cause comes first.
    let taken = known::Values { scalars: &answer.scalars, clouds: &answer.clouds };
    let mut checks: Vec<Check> = known::check(bound, &answer.scores, taken).into_iter().collect();
    let doubts = bound.problem.doubts.iter();
    checks.extend(doubts.map(|own| Check::new("given", ("", own.of), (own.value, own.limit), own.message.clone())));
    for (at, (group, facts)) in schema.groups.iter().zip(&answer.facts).enumerate() {
        let programs = kernels[at].programs;
        let rows = facts.rows(programs, group, &answer.scalars);
        if group.is_beliefs() {
            checks.extend(believed::checks(bound, group, &rows));
            continue;
        }
        checks.extend(equations::checks(bound, at, (facts, &rows), programs, (&sizes, answer)));
        checks.extend(blurred::checks(bound, at, (facts, &rows), programs, &answer.scalars));
        // Equations hold between their points as well, but for those that read what is known at these alone.
        for (_, facts) in answer.between.iter().filter(|(of, _)| *of == at) {
            let rows = facts.rows(programs, group, &answer.scalars);
            let is_known = |check: &Check| group.terms.iter().any(|term| term.name == check.term && term.known);
            let all = equations::checks(bound, at, (facts, &rows), programs, (&sizes, answer));
            for between in all.into_iter().filter(|check| !is_known(check)) {
                let place = (between.check, between.group, between.term);
                match checks.iter_mut().find(|check| (check.check, check.group, check.term) == place) {
                    Some(check) if between.value > check.value => *check = between,
                    Some(_) => {}
                    None => checks.push(between),
                }
            }
        }
        checks.extend(observations::checks(bound, at, (&rows, noise), answer));
    }
    checks.extend(outside::checks(bound));
    checks.extend(between::checks(bound, answer, values));
    let settled = settled::checks(bound, answer);
    let is_off = settled.iter().any(|check| check.check == "refined" && !check.passed);
    checks.extend(if is_off { amplified::checks(bound, answer, values) } else { Vec::new() });
    checks.extend(settled);
    let free = free::sources(bound);
    checks.extend(free::check(&free));
    // The size of a source that may have any course says nothing.
    checks.extend(told::checks(bound, &answer.told).into_iter().filter(|check| !free.contains(&check.term)));
    checks.extend(answer.clouds.iter().flat_map(|cloud| clouds::checks(bound, cloud)));
    checks.extend(learned::checks(bound, &answer.scalars));
    checks.extend(learned::held(bound, &answer.left_to_learned));
    checks.extend(leaning::checks(bound, &answer.leaning));
    // What coarse cells leave looks like what a wrong number does. Where something else fails anyway no number is accused.
    if answer.is_coarse && checks.iter().any(|check| !check.passed && check.check != "given") {
        checks.retain(|check| check.check != "given");
    }
    Verdict { checks }
}

/// Whether another carrier's answer, found by itself and `off` by itself, is the same but for a share `apart` of the range.
pub(crate) fn agreed(apart: f64, off: f64) -> Check {
    /// What two answers may differ by, each of them a little off.
    const SAME: f64 = 1e-2;
    /// By how much more one may be off than finer cells say, and how far off it may be at most to be followed.
    const DOUBT: f64 = 2.0;
    const MOST: f64 = 0.1;
    let said = format!(
        "splines and a network hold the equations, and their answers are {:.1} % of the range apart: a small error grows along the \
         equations; give conditions that hold it where it grows, or a larger --budget",
        100.0 * apart
    );
    Check::new("agreed", ("", ""), (apart, (DOUBT * off).clamp(SAME, MOST)), said)
}

/// That nothing is left open, where `open` says what is.
pub(crate) fn determined(name: &'static str, open: String) -> Check {
    Check::new("determined", ("", name), (1.0, 0.0), open)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(equation: f64, misfit: f64) -> Verdict {
        let check = |kind, value| Check::new(kind, ("", ""), (value, 0.2), String::new());
        Verdict { checks: vec![check("equation", equation), check("misfit", misfit)] }
    }

    #[test]
    fn equations_that_are_held_and_data_that_are_missed_contradict_each_other() {
        assert!(verdict(1e-6, 0.9).contradicts());
        // An answer that did not hold its equations is no witness, and neither is one that fits.
        assert!(!verdict(0.1, 0.9).contradicts() && !verdict(1e-6, 0.1).contradicts());
    }
}
