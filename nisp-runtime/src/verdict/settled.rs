//! What ended too early: steps that still changed learned scalars or sources, and cells that were too coarse.

use super::Check;
use crate::facts::Answer;
use crate::problem::Bound;

/// How far the next whole step may move a learned scalar's parameter: a hundredth of a value that is positive.
const NEAR: f64 = 1e-2;
/// How far the last step may have moved a source, over its size.
const MOVED: f64 = 0.1;
/// How far cells may hold an answer back.
const STRAINED: f64 = 1.0;
/// How far equations that were held loosely may be off: where no finer cells help, a quarter more is as good.
const LOOSE: f64 = 1.25;
/// How much the last finer cells may have changed an answer to exact measurements.
const REFINED: f64 = 0.05;
/// How far the cells may hold an answer back for which nothing was measured, as a share of its range.
pub(crate) const HELD_BACK: f64 = 2e-3;

/// The checks of an answer whose steps did not come to their end; none of one whose did.
pub(super) fn checks(bound: &Bound, answer: &Answer) -> Vec<Check> {
    let ahead = answer.ahead.filter(|_| !bound.learned.is_empty()).map(|ahead| {
        let said = format!("a step still moved a learned parameter by {:.1} %", 100.0 * ahead);
        (ahead, NEAR, said)
    });
    let moved =
        answer.moved.map(|moved| (moved, MOVED, format!("a step still moved a source by {:.0} %", 100.0 * moved)));
    let strain = answer.strain.map(|strain| {
        (strain, STRAINED, format!("cells were still too coarse for the equations or the data, by {strain:.1} times"))
    });
    let check = |(value, limit, said): (f64, f64, String)| {
        let said = format!("the run ended while {said}: give a larger budget, or more iterations");
        Check::new("settled", ("", ""), (value, limit), said)
    };
    let early = ahead.into_iter().chain(moved).chain(strain).map(check);
    early.chain(answer.loose.map(loose)).chain(refined(bound, answer)).collect()
}

/// Whether equations that had to be held loosely hold by themselves.
fn loose(strain: f64) -> Check {
    let said = format!(
        "the equations had to be held loosely, and are off by {strain:.1} times what may be on the finest cells that helped: data or \
         conditions contradict them somewhere, or what acts there is narrower than these cells"
    );
    Check::new("settled", ("", ""), (strain, LOOSE), said)
}

/// Whether a finer lattice still changed an answer without noise.
fn refined(bound: &Bound, answer: &Answer) -> Option<Check> {
    let refined = answer.refined?;
    let (limit, said) = match (bound.problem.scene().schema.observed().is_empty(), refined.is_finite()) {
        (false, _) => (REFINED, format!("finer cells changed the answer by {:.0} %", 100.0 * refined)),
        (true, true) => (
            HELD_BACK,
            format!("yet finer cells would change the answer by about {:.2} % of its range", 100.0 * refined),
        ),
        (true, false) => (HELD_BACK, "the run ended before finer cells told how far the answer is off".into()),
    };
    let said = format!(
        "{said}: it has layers or corners thinner than cells, or a small error grows along the equations; give a larger budget, more \
         points (--points), or conditions that hold it where it grows"
    );
    Some(Check::new("refined", ("", ""), (refined.min(1.0), limit), said))
}

/// The check that fails where the budget ended an answer before its steps did, after another carrier had failed.
pub(crate) fn unfinished() -> Check {
    let said = "the budget ended this answer before its steps did, and what was tried first failed: give a larger budget, or \
                check the parameters and the data";
    Check::new("settled", ("", ""), (1.0, 0.0), said.into())
}
