//! A problem on its lattices: what is set up once, and what rows are divided by.

use std::borrow::Cow;

use super::between::{ASKED, OTHERS, enough, filled, others, thinned};
use super::clashes::Clashes;
use super::freedom::{Freedom, Unmeasured};
use super::means::{Asked, Means, TESTS, asked_on, with_means};
use super::meshes::{across_pairs, lattices, together};
use super::prior::Prior;
use super::proportions::Proportions;
use super::singular::Singularity;
use super::state::{Phase, State};
use crate::local::LocalError;
use crate::local::group::{Group, Places};
use crate::local::heads::Heads;
use crate::local::normal::Normal;
use crate::local::surface::Surface;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema;
use crate::start;
use crate::tolerance::LOOSE;
use crate::weighed::{Class, Guess, of_terms};

/// How far equations may be off in the end, beside the sum of the magnitudes of their terms: a hundredth of what noise is of the
/// data, and no less than normal equations can hold, which are squares.
const SHARE: f64 = 1e-2;
const STRICTEST: f64 = 1e-5;
const EASIEST: f64 = 1e-3;
/// Least roughness, beside the natural one: below it a head is straight but for rounding.
const STRAIGHT: f64 = 1e-4;

/// Share of the fullest mean's weight that means see at least: there are hardly more of them than unknowns.
const LEAST_MASS: f64 = 1e-6;

/// Numbers of groups, and the problem with their equations at other places, with the means of all groups.
pub(super) type Others = (Vec<usize>, (Bound, Vec<Means>));

/// A problem on its lattices.
pub(super) struct Solver<'a> {
    pub(super) bound: Cow<'a, Bound>,
    /// Measurements of a group at most, and whether it does without some of the noisy ones.
    pub(super) most: usize,
    pub(super) lacks: bool,
    /// Groups of equations at other places than they are asked at, and their numbers.
    pub(super) others: Option<Others>,
    /// By group, how it is asked.
    pub(super) asked: Vec<Asked>,
    /// Where conditions contradict each other.
    pub(super) clashes: Clashes,
    pub(super) heads: Heads,
    pub(super) groups: Vec<Group>,
    pub(super) surfaces: Vec<Surface>,
    /// By group and term, the number of its class.
    pub(super) classes: Vec<Vec<usize>>,
    /// By head, the number of the class of its roughness.
    pub(super) roughness: Vec<usize>,
    pub(super) priors: Vec<Prior>,
    /// By head, what says how many of its numbers are settled; of sources alone.
    pub(super) freedoms: Vec<Option<Freedom>>,
    /// Sizes of equations, by group and row.
    pub(super) sizes: Vec<Vec<f64>>,
    pub(super) normal: Normal,
    pub(super) scalars: Vec<f64>,
    /// How far equations may be off in the end.
    pub(super) tolerance: f64,
}

/// The groups of a problem at its points; some are asked for in the mean.
pub(super) fn groups(bound: &Bound, heads: &Heads, means: &[Means]) -> Vec<Group> {
    let schema = bound.problem.scene().schema;
    let group = |(at, kernel)| {
        let columns = bound.filled_columns(at);
        let lattice = heads.lattices.iter().max_by_key(|lattice| lattice.dimensions()).unwrap_or(&heads.lattices[0]);
        let Means { weights, middles } = means[at].clone();
        let measure = schema.groups[at].terms.iter().find_map(|term| term.measure.as_ref());
        let tested = (!weights.is_empty()).then_some((lattice, TESTS, LEAST_MASS));
        let places = Places {
            points: &bound.coordinates[at],
            partners: &bound.partners[at],
            columns: &columns,
            weights: if tested.is_some() { weights } else { bound.weights(at, measure) },
            noisiness: &bound.noisiness[at],
        };
        let own = (&schema.groups[at], bound.losses[at].as_slice());
        Group::new(own, kernel, heads, places, tested).with_slight((lattice, &bound.coordinates[at]), &middles)
    };
    bound.problem.scene().double().into_iter().take(schema.groups.len()).enumerate().map(group).collect()
}

fn freedom(heads: &Heads, head: usize, prior: &Prior) -> Result<Freedom, LocalError> {
    let (first, end) = (heads.first[head], heads.first[head + 1]);
    Freedom::new(prior, first, end - first).ok_or(LocalError::Factorisation)
}

impl<'a> Solver<'a> {
    /// With equations asked at so many points at least, on lattices of such proportions, as the problem's groups are asked, and with so many measurements of a group at most; with nothing said of these,
    /// with as many as choose a lattice. The scene must not be refused.
    pub(super) fn new(
        problem: &'a Bound,
        (points, proportions): (usize, &Proportions),
        (asked, clashes): &(Vec<Asked>, Clashes),
        noise: &Noise,
        most: Option<usize>,
    ) -> Result<Self, LocalError> {
        let is_noisy = noise.is_there(problem.problem.scene().schema);
        let bound = filled(problem, points).map_or(Cow::Borrowed(problem), Cow::Owned);
        let enough = enough(points, is_noisy);
        let few = thinned(&bound, enough);
        let (lattices, cells) = lattices(few.as_ref().unwrap_or(&bound), proportions, points, asked);
        let asked = asked_on(problem, asked, &cells);
        let few = most.map_or(few, |most| thinned(&bound, most));
        let lacks = few.is_some() && is_noisy;
        let bound = few.map_or(bound, Cow::Owned);
        let schema = bound.problem.scene().schema;
        let heads = Heads::new(&bound, lattices);
        let others = others(&bound).map(|(of, others)| {
            let (with, means) = with_means((&others, &bound), &heads, &asked, OTHERS);
            (of, (with.unwrap_or(others), means))
        });
        let (with, means) = with_means((&bound, &bound), &heads, &asked, ASKED);
        let bound = with.map_or(bound, Cow::Owned);
        let groups = groups(&bound, &heads, &means);
        let cell = heads.lattices.iter().flat_map(|own| (0..own.dimensions()).map(|axis| own.spacing(axis)));
        let cell = cell.fold(0.0, f64::max);
        let surfaces = (0..groups.len()).flat_map(|at| Surface::of(&bound, at, cell)).collect();
        let mut numbers = 0..;
        let mut next = || numbers.next().unwrap_or(0);
        let classes = schema.groups.iter().map(|g| g.terms.iter().map(|_| next()).collect()).collect();
        let roughness = schema.heads.iter().map(|_| next()).collect();
        let priors: Vec<Prior> = (0..schema.heads.len()).map(|head| Prior::straight(&heads, head)).collect();
        let freedom = |(head, prior): (usize, &Prior)| schema.heads[head].source.then(|| freedom(&heads, head, prior));
        let freedoms = priors.iter().enumerate().map(|of| freedom(of).transpose()).collect::<Result<_, _>>()?;
        let sizes = schema.groups.iter().map(|group| vec![0.0; group.rows]).collect();
        let mut together = together(&heads, &cells);
        together.extend(across_pairs(&heads, &bound));
        groups.iter().for_each(|group| together.extend(group.together(&heads)));
        let normal = Normal::new(heads.len(), bound.learned.len(), &together).ok_or(LocalError::Memory)?;
        let shares = noise.observations.iter().map(|found| found.deviation / found.spread.max(found.deviation));
        let tolerance = (SHARE * shares.fold(0.0, f64::max)).clamp(STRICTEST, EASIEST);
        let scalars = bound.scalars.clone();
        Ok(Self {
            others,
            asked,
            clashes: clashes.clone(),
            bound,
            most: most.unwrap_or(enough),
            lacks,
            heads,
            groups,
            surfaces,
            classes,
            roughness,
            priors,
            freedoms,
            sizes,
            normal,
            scalars,
            tolerance,
        })
    }

    /// Judges the answer at all points of a problem.
    pub(super) fn judge_at(&mut self, bound: &Bound) {
        let (with, means) = with_means((bound, bound), &self.heads, &self.asked, ASKED);
        self.groups = groups(with.as_ref().unwrap_or(bound), &self.heads, &means);
    }

    /// Where fields are singular.
    pub(super) fn singular(&self) -> &[Singularity] {
        let uneven = self.asked.iter().find_map(|asked| match asked {
            Asked::OverDomain(uneven) => Some(uneven),
            Asked::AtPoints | Asked::InMean(_) => None,
        });
        uneven.map_or(&[], |uneven| &uneven.singular)
    }

    /// False of a problem that equations and conditions alone solve.
    pub(super) fn is_measured(&self) -> bool {
        !self.schema().observed().is_empty()
    }

    pub(super) fn schema(&self) -> &'static schema::Scene {
        self.bound.problem.scene().schema
    }

    /// Where the solver starts: heads at their offsets, or at another level where equations and data have no value there, and noise
    /// as neighbouring data say.
    pub(super) fn first(&mut self, noise: &Noise) -> State {
        let mut classes = of_terms(&self.bound, noise, None);
        let guess = |natural: f64| Guess { size: 0.0, count: 0.0, yields: false, least: STRAIGHT * natural };
        classes.extend(self.priors.iter().map(|prior| Class::open(prior.natural, guess(prior.natural))));
        let (theta, learned) = (vec![0.0; self.heads.len()], vec![0.0; self.bound.learned.len()]);
        let convex = self.bound.losses.iter().flatten().any(|loss| loss.convex() != *loss);
        let (tolerance, phase) = (LOOSE, Phase::Solve);
        let mut state = State {
            theta,
            learned,
            classes,
            tolerance,
            strictest: self.tolerance,
            convex,
            phase,
            step: 0,
            since: 0,
            unmeasured: Unmeasured::default(),
            earlier: None,
        };
        self.level(&mut state);
        State { phase: Phase::Regress, ..state }
    }

    /// Begins where equations and data have a value, unless they have one at the state.
    pub(super) fn come_back(&mut self, state: &mut State) {
        if !self.has_value(state) {
            self.level(state);
        }
    }

    fn level(&mut self, state: &mut State) {
        let level = start::level(|level| {
            state.theta.fill(level);
            self.has_value(state)
        });
        state.theta.fill(level);
    }

    fn has_value(&mut self, state: &State) -> bool {
        self.size(state);
        self.set_sigmas(state);
        self.loss(state).is_finite()
    }

    /// Believes from now on that sources change little, instead of bending little, and begins the search for how little anew.
    pub(super) fn doubt(&mut self, state: &mut State) -> Result<(), LocalError> {
        for head in self.judged(Phase::Solve) {
            self.priors[head] = Prior::flat(&self.heads, head);
            self.freedoms[head] = Some(freedom(&self.heads, head, &self.priors[head])?);
            state.classes[self.roughness[head]].restart(self.priors[head].natural);
        }
        state.unmeasured = Unmeasured::default();
        Ok(())
    }

    /// Looks for sources once more, with equations as loose as they were at first, and from then on: cells that are too coarse for strict
    /// ones miss the measurements, which then count as noise, beside which no source is left.
    pub(super) fn loosen(&self, state: &mut State) {
        (state.phase, state.since, state.tolerance, state.strictest) = (Phase::Explain, 0, LOOSE, LOOSE);
        for head in self.judged(Phase::Explain) {
            state.classes[self.roughness[head]].restart(self.priors[head].natural);
        }
    }

    /// Takes over learned scalars; returns their derivatives by their parameters.
    pub(super) fn set_learned(&mut self, parameters: &[f64]) -> Vec<f64> {
        let found = self.bound.learned.iter().zip(parameters).map(|(learned, &parameter)| learned.map.at(parameter));
        let found: Vec<(f64, f64)> = found.collect();
        for (learned, (value, _)) in self.bound.learned.iter().zip(&found) {
            self.scalars[learned.slot] = *value;
        }
        found.into_iter().map(|(_, slope)| slope).collect()
    }

    /// Finds the feet of all clouds on the surface of a state.
    pub(super) fn find_feet(&mut self, state: &State) {
        for surface in &mut self.surfaces {
            surface.set_near(state.phase == Phase::Solve && !state.convex);
            surface.find(&self.groups[surface.group], &self.heads, &state.theta, &self.scalars);
        }
    }
}
