//! What learned scalars lean on, where a source stands beside them: how far they move where sources may be rougher. One that the
//! measurements tell stays where it was. One of which no more is known than that it leaves sources smooth follows them.

use super::run::Clock;
use super::solver::Solver;
use super::state::{Phase, State};
use crate::facts::{LARGER, Leaning, by_prior};
use crate::local::KeptLattices;
use crate::local::normal::factor::Factor;
use crate::solve::vector::root_mean_square;

/// Steps with rougher sources, at most.
const STEPS: usize = 10;
/// Change of a coefficient or parameter that no longer matters.
const SETTLED: f64 = 1e-3;

/// What a scalar's parameter is where sources may be rougher.
#[derive(Clone, Copy)]
pub(super) struct Rougher {
    /// How far it moves.
    moved: f64,
    /// Its deviation before.
    deviation: f64,
    /// Share of what is known of it that the sources' prior says: how its variance grows with theirs.
    by_prior: f64,
}

impl Solver<'_> {
    /// By learned scalar, how far its parameter moves from an end where sources may be [`LARGER`] times as rough, and its deviation at the
    /// end; nothing without sources or scalars, and where steps of so many seconds leave no time for all.
    pub(super) fn rougher(&mut self, end: &State, clock: &Clock, seconds: f64) -> Option<Vec<Rougher>> {
        if !self.is_beside_sources() || !self.is_measured() || !clock.has_time(STEPS as f64 * seconds) {
            return None;
        }
        let factor = self.step(end).ok()?.factor;
        let variances = |factor: &Factor| -> Option<Vec<f64>> {
            (0..end.learned.len()).map(|at| Some(factor.learned_variance(at)?.max(0.0))).collect()
        };
        let (own, mut wide) = (variances(&factor)?, None);
        let mut state = end.clone();
        for head in self.judged(Phase::Solve) {
            state.classes[self.roughness[head]].size *= LARGER;
        }
        for _ in 0..STEPS {
            let found = self.step(&state).ok()?;
            wide = variances(&found.factor);
            state = State { classes: state.classes, ..found.next };
            if found.change < SETTLED {
                break;
            }
        }
        let of = |(at, (own, wide)): (usize, (f64, f64))| Rougher {
            moved: (state.learned[at] - end.learned[at]).abs(),
            deviation: own.sqrt(),
            by_prior: by_prior(own, wide),
        };
        Some(own.into_iter().zip(wide?).enumerate().map(of).collect())
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
        let rougher = rougher.map(|all| all[at]);
        let deviation = drawn.map(|drawn| rougher.map_or(drawn, |own| drawn.max(own.deviation)));
        let (moved, by_prior) = (rougher.map(|own| own.moved), rougher.map(|own| own.by_prior));
        Leaning { moved, deviation, by_prior, is_weighed: false }
    };
    (0..kept.learned.len()).map(of).collect()
}
