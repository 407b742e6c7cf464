//! What learned scalars lean on, where a source stands beside them: how far they move where sources may be rougher. One that the
//! measurements tell stays where it was. One of which no more is known than that it leaves sources smooth follows them.

use super::run::Clock;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::facts::{LARGER, Leaning};
use crate::local::KeptLattices;
use crate::solve::vector::root_mean_square;

/// Steps with rougher sources, at most.
const STEPS: usize = 10;
/// Change of a coefficient or parameter that no longer matters.
const SETTLED: f64 = 1e-3;

/// How far a scalar's parameter moves, and its deviation before.
type Rougher = (f64, f64);

impl Solver<'_> {
    /// By learned scalar, how far its parameter moves from an end where sources may be [`LARGER`] times as rough, and its deviation at the
    /// end; nothing without sources or scalars, and where steps of so many seconds leave no time for all.
    pub(super) fn rougher(&mut self, end: &State, clock: &Clock, seconds: f64) -> Option<Vec<Rougher>> {
        if !self.is_beside_sources() || !self.is_measured() || !clock.has_time(STEPS as f64 * seconds) {
            return None;
        }
        let factor = self.step(end).ok()?.factor;
        let mut state = end.clone();
        for head in self.judged(Phase::Solve) {
            state.classes[self.roughness[head]].size *= LARGER;
        }
        for _ in 0..STEPS {
            let found = self.step(&state).ok()?;
            state = State { classes: state.classes, ..found.next };
            if found.change < SETTLED {
                break;
            }
        }
        let of = |at: usize| {
            let moved = (state.learned[at] - end.learned[at]).abs();
            Some((moved, factor.learned_variance(at)?.max(0.0).sqrt()))
        };
        (0..end.learned.len()).map(of).collect()
    }

    /// Whether scalars are learned beside sources.
    pub(super) fn is_beside_sources(&self) -> bool {
        !self.bound.learned.is_empty() && self.schema().heads.iter().any(|head| head.source)
    }
}

/// What is known of learned scalars, by scalar, of an answer in which they stand beside sources. Draws are from another belief, under
/// which a scalar may be better known: the larger deviation counts.
pub(super) fn facts(kept: &KeptLattices, rougher: Option<&[Rougher]>) -> Vec<Leaning> {
    let draws = &kept.draws.learned;
    let of = |at: usize| {
        let drawn = (!draws.is_empty()).then(|| root_mean_square(draws.iter().map(|draw| draw[at])));
        let deviation = drawn.map(|drawn| rougher.map_or(drawn, |all| drawn.max(all[at].1)));
        Leaning { moved: rougher.map(|all| all[at].0), deviation, is_weighed: false }
    };
    (0..kept.learned.len()).map(of).collect()
}
