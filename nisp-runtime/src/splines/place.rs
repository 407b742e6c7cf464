//! Where a run stands, and that as plain numbers.

use super::METHOD;
use super::iterate::{Phase, State};
use super::prior::{Course, HIGHEST_NOISY, KINDS, Smoothness};
use crate::shared_noise::Alike;
use crate::solve::fault::Fault;
use crate::solve::state;

/// Logarithm of the evidence by which a kind of smoothness may fall behind and still count.
const NEAR: f64 = 8.0;
/// Which kinds of smoothness sources may be uneven with, one after the other: the likeliest along a course, or the one of an order.
/// Before its roughness may vary a source that steps looks as smooth as what lies between the steps, and its steps are no more than
/// changes that the first order asks nothing for.
const VARIED: [(Course, Option<usize>); 3] =
    [(Course::Steady, None), (Course::Steady, Some(1)), (Course::Fading, None)];
/// How often the roughness of sources along a record is found anew, and the gain of the logarithm of the evidence for which it is.
const MOST_ROUNDS: u64 = 12;
const GAIN: f64 = 0.5;
/// How far differences of the evidence are trusted: all kinds are approximations of what the source is like.
const TRUST: f64 = 0.3;
/// Logarithm of the evidence that noise which rows share has to gain: each row's own, which is its limit, makes so much once in a thousand
/// records.
const SHARED: f64 = 5.0;
/// All kinds of noise that neighbouring rows share.
pub(super) const ALL_SHARED: usize = 2;
/// How much less a kind of smoothness counts than one of an order less, for equal evidence. Orders differ in waves that the data hardly
/// show. The evidence cannot tell a source that steps to and fro from a smooth one, and the bars of smooth ones are then too short by half.
const SMOOTHER: f64 = 0.25;

/// Where a run stands: which kind of smoothness is tried, from which iterate, and what came of those before.
#[derive(Clone)]
pub(super) struct Place {
    /// Indices in [`KINDS`] of those that are still to be tried, the present one first.
    pub(super) kinds: Vec<usize>,
    pub(super) phase: Phase,
    /// Steps of the phase.
    pub(super) since: u64,
    pub(super) state: State,
    pub(super) tried: Vec<Tried>,
    /// Whether the steps have started again, or must not any more.
    pub(super) is_again: bool,
    /// Number in [`VARIED`] of the kind with which the sources' roughness is found anew, how often it was, and the evidence before
    /// the last time.
    varied: usize,
    rounds: u64,
    before: f64,
    /// Whether equations have been as uncertain as their columns, too, or need not be any more.
    pub(super) is_blurred: bool,
    /// How many kinds of noise that neighbouring rows share have been tried, or need not be any more: none, walks, or all.
    pub(super) shared: usize,
    /// Whether one roughness describes all of the record: a part of it has said so.
    pub(super) is_even: bool,
}

/// A kind of smoothness that was tried: its index, its evidence and its iterate.
#[derive(Clone)]
pub(super) struct Tried {
    pub(super) kind: usize,
    pub(super) evidence: f64,
    pub(super) state: State,
}

impl Place {
    /// The start.
    pub(super) fn first(state: State, kinds: Vec<usize>) -> Self {
        Self {
            kinds,
            phase: Phase::Regress,
            since: 0,
            state,
            tried: Vec::new(),
            is_again: false,
            is_blurred: false,
            shared: 0,
            varied: 0,
            rounds: 0,
            before: f64::MIN,
            is_even: false,
        }
    }

    /// Starts again from another state, with all kinds.
    pub(super) fn again(&mut self, state: State, kinds: Vec<usize>) {
        (self.kinds, self.phase, self.since, self.state, self.is_again) = (kinds, Phase::Regress, 0, state, true);
    }

    /// The end whose sources' roughness along the record is to be found anew; nothing where that was done with all kinds.
    pub(super) fn next_uneven(&mut self) -> Option<Tried> {
        while let Some(&(course, order)) = VARIED.get(self.varied).filter(|_| !self.is_even) {
            let is_meant = |kind: Smoothness| kind.course == course && order.is_none_or(|order| kind.order == order);
            let own = self.tried.iter().filter(|tried| is_meant(KINDS[tried.kind]));
            let own = own.max_by(|a, b| a.evidence.total_cmp(&b.evidence)).cloned();
            let best = self.best().map_or(f64::MAX, |best| best.evidence);
            // A source that no kind found uneven has no steps, and a kind that was varied is not varied again.
            let is_any_uneven = self.tried.iter().any(|tried| !tried.state.uneven.is_empty());
            let is_likely = |tried: &Tried| match (course, order) {
                (_, Some(_)) => is_any_uneven && tried.state.uneven.is_empty(),
                (Course::Steady, None) => true,
                (Course::Fading, None) => tried.evidence >= best - NEAR,
            };
            let may_begin = |tried: &Tried| self.rounds == 0 && is_likely(tried);
            let has_gained =
                |tried: &Tried| (1..MOST_ROUNDS).contains(&self.rounds) && tried.evidence > self.before + GAIN;
            if let Some(tried) = own.filter(|tried| may_begin(tried) || has_gained(tried)) {
                return Some(tried);
            }
            self.leave_varied();
        }
        None
    }

    /// Turns to the next kind.
    pub(super) fn leave_varied(&mut self) {
        (self.varied, self.rounds) = (self.varied + 1, 0);
    }

    /// Leaves a round without an end, and its kind.
    pub(super) fn drop_round(&mut self) {
        self.kinds.clear();
        self.leave_varied();
    }

    /// Goes on from an end with a state that is like it.
    pub(super) fn go_on(&mut self, from: &Tried, state: State) {
        (self.kinds, self.phase, self.since) = (vec![from.kind], Phase::Solve, 0);
        self.state = State { step: self.state.step, ..state };
    }

    /// Goes on from an end with sources that are as rough along the record as this state says.
    pub(super) fn vary(&mut self, from: &Tried, state: State) {
        self.go_on(from, state);
        // Another start now would begin with even sources.
        (self.is_again, self.rounds, self.before) = (true, self.rounds + 1, from.evidence);
    }

    /// Keeps the iterate, unless another start of its kind has ended with more evidence, and turns to the next kind. A course that
    /// the evidence rules out is not tried with other orders.
    pub(super) fn next(&mut self, evidence: f64) {
        let kind = self.kinds.remove(0);
        let sort = self.state.sort();
        let is_same = |tried: &Tried| tried.kind == kind && tried.state.sort() == sort;
        if !self.tried.iter().any(|tried| is_same(tried) && tried.evidence >= evidence) {
            self.tried.retain(|tried| !is_same(tried));
            self.tried.push(Tried { kind, evidence, state: self.state.clone() });
        }
        let most = |kinds: &mut dyn Iterator<Item = &Tried>| kinds.map(|tried| tried.evidence).fold(f64::NAN, f64::max);
        let tried = || self.tried.iter().filter(|tried| tried.state.sort() == sort);
        let best = most(&mut tried());
        // Nothing is known of a course that has not been tried.
        self.kinds.retain(|&kind| {
            let is_alike = |tried: &&Tried| KINDS[tried.kind].course == KINDS[kind].course;
            let own = most(&mut tried().filter(is_alike));
            own.is_nan() || own >= best - NEAR
        });
    }

    /// Starts again with equations that know no better than their columns.
    pub(super) fn blur(&mut self, state: State, kinds: Vec<usize>) {
        self.again(state, kinds);
        self.is_blurred = true;
    }

    /// Leaves ends of one sort: those whose equations know no better than their columns, unless the evidence rules these out. A drive
    /// that is as fast as noise is rare, and where the evidence does not tell, noise is what it looks like.
    pub(super) fn choose_blurred(&mut self) {
        let best = |blurred: bool| {
            let own = self.tried.iter().filter(|tried| tried.state.blurred == blurred);
            own.map(|tried| tried.evidence).fold(f64::MIN, f64::max)
        };
        let is_kept = best(true) > f64::MIN && best(true) >= best(false) - NEAR;
        self.tried.retain(|tried| tried.state.blurred == is_kept);
    }

    /// The end with the largest evidence of those whose rows share noise in a way, or not.
    pub(super) fn best_of(&self, sharing: Option<Alike>) -> Option<&Tried> {
        let own = self.tried.iter().filter(|tried| tried.state.sharing == sharing);
        own.max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    fn most(&self, sharing: Option<Alike>) -> Option<f64> {
        self.best_of(sharing).map(|best| best.evidence)
    }

    /// The best end whose rows share noise as walks do, where the evidence has gained anything by it.
    pub(super) fn shares_noise(&self) -> Option<&Tried> {
        let best = self.best_of(Some(Alike::Rough))?;
        Some(best).filter(|best| self.most(None).is_none_or(|without| best.evidence > without + GAIN))
    }

    /// The way in which rows share noise where the evidence is largest; smooth noise has to be likelier than a walk.
    pub(super) fn likeliest_sharing(&self) -> Option<Alike> {
        match (self.most(Some(Alike::Rough)), self.most(Some(Alike::Smooth))) {
            (Some(rough), Some(smooth)) if smooth < rough + GAIN => Some(Alike::Rough),
            (_, Some(_)) => Some(Alike::Smooth),
            (rough, None) => rough.map(|_| Alike::Rough),
        }
    }

    /// Leaves out ends whose rows share noise in a way; false, and none, where there are no others.
    pub(super) fn leave_out(&mut self, sharing: Alike) -> bool {
        let has_others = self.tried.iter().any(|tried| tried.state.sharing != Some(sharing));
        self.tried.retain(|tried| !has_others || tried.state.sharing != Some(sharing));
        has_others
    }

    /// Leaves ends of one sort: those whose rows share noise in the likeliest way, where the evidence gains enough by it.
    pub(super) fn choose_sharing(&mut self) {
        let shared = self.likeliest_sharing();
        let gains = |own: &Alike| match (self.most(Some(*own)), self.most(None)) {
            (Some(with), Some(without)) => with >= without + SHARED,
            _ => true,
        };
        let kept = shared.filter(gains);
        self.tried.retain(|tried| tried.state.sharing == kept);
    }

    /// Whether noise is smooth at the likeliest end: such an answer is doubted, and nothing more is asked of it.
    pub(super) fn is_filtered(&self) -> bool {
        self.best().is_some_and(|best| best.state.sharing == Some(Alike::Smooth))
    }

    /// The kind with the largest evidence.
    pub(super) fn best(&self) -> Option<&Tried> {
        self.tried.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    /// Whether the smoothest kind was asked, and came to rest: only then evidence says which kind a scalar beside sources should be told by.
    pub(super) fn is_weighed(&self) -> bool {
        let order = |tried: &&Tried| KINDS[tried.kind].order;
        self.tried
            .iter()
            .max_by_key(order)
            .is_some_and(|smoothest| KINDS[smoothest.kind].order > HIGHEST_NOISY && smoothest.evidence > f64::MIN)
    }

    /// Kinds that the evidence does not rule out, with their shares of it.
    pub(super) fn likely(&self) -> Vec<(f64, Tried)> {
        let Some(best) = self.best() else { return Vec::new() };
        let near = || self.tried.iter().filter(|tried| tried.evidence >= best.evidence - NEAR);
        let weight = |tried: &Tried| {
            let order = KINDS[tried.kind].order as f64;
            (TRUST * (tried.evidence - best.evidence)).exp() * SMOOTHER.powf(order - 1.0)
        };
        let all: f64 = near().map(weight).sum();
        near().map(|tried| (weight(tried) / all, tried.clone())).collect()
    }

    pub(super) fn save(&self) -> state::State {
        let saved = self.state.save(state::State::new(METHOD), "");
        let kinds: Vec<f64> = self.kinds.iter().map(|&kind| kind as f64).collect();
        let saved = saved
            .with("kinds", &kinds)
            .with_counter("phase", u64::from(self.phase == Phase::Solve))
            .with_counter("since", self.since)
            .with_counter("iterations", self.state.step)
            .with_counter("again", u64::from(self.is_again))
            .with_counter("blurred tried", u64::from(self.is_blurred))
            .with_counter("shared", self.shared as u64)
            .with_counter("even", u64::from(self.is_even))
            .with_counter("varied", self.varied as u64)
            .with_counter("rounds", self.rounds)
            .with("before", &[self.before])
            .with_counter("tried", self.tried.len() as u64);
        self.tried.iter().enumerate().fold(saved, |saved, (at, Tried { kind, evidence, state })| {
            let prefix = format!("tried {at} ");
            let saved = saved.with(&format!("{prefix}evidence"), &[*evidence]);
            state.save(saved.with_counter(&format!("{prefix}kind"), *kind as u64), &prefix)
        })
    }

    /// Takes over what [`Place::save`] gave of the same problem, whose sources have so many functions together.
    pub(super) fn restore(&mut self, saved: &state::State, functions: usize) -> Result<(), Fault> {
        saved.check_method(METHOD)?;
        let known = |kind: &usize| *kind < KINDS.len();
        self.kinds = saved.indices("kinds")?;
        if !self.kinds.iter().all(known) {
            return Err(Fault::state("kinds"));
        }
        for at in 0..saved.counter("tried")? {
            let prefix = format!("tried {at} ");
            let mut state = self.state.clone();
            state.restore(saved, &prefix)?;
            let [evidence] = saved.scalars(&format!("{prefix}evidence"))?;
            let kind = saved.counter(&format!("{prefix}kind"))? as usize;
            self.tried.push(Tried {
                kind: Some(kind).filter(known).ok_or_else(|| Fault::state("kind"))?,
                evidence,
                state,
            });
        }
        self.state.restore(saved, "")?;
        let mut uneven = self.tried.iter().map(|tried| &tried.state).chain([&self.state]).map(|state| &state.uneven);
        if !uneven.all(|own| (own.is_empty() || own.len() == functions) && own.iter().all(|rough| *rough > 0.0)) {
            return Err(Fault::state("uneven"));
        }
        self.since = saved.counter("since")?;
        self.is_blurred = saved.counter("blurred tried")? == 1;
        self.shared = saved.counter("shared")? as usize;
        self.is_even = saved.counter("even")? == 1;
        self.varied = saved.counter("varied")? as usize;
        [self.before] = saved.scalars("before")?;
        self.rounds = saved.counter("rounds")?;
        self.is_again = saved.counter("again")? == 1;
        self.phase = if saved.counter("phase")? == 1 { Phase::Solve } else { Phase::Regress };
        Ok(())
    }
}
