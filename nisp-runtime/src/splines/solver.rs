//! Gauss-Newton steps on banded rows, while the evidence finds how noisy the data and how rough the sources are.

use super::cells;
use super::group::Group;
use super::heads::Heads;
use super::prior::{Prior, Smoothness};
use super::rows::{Counted, Rows};
use super::triangle::{Covariance, Row, Triangle};
use super::weighed::{Class, Guess, Tally, renew, restore_classes, save_classes};
use crate::facts::Facts;
use crate::kernel::GroupKernel;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::fault::Fault;
use crate::solve::state;

/// How far equations may be off in the end, beside the sum of the magnitudes of their terms.
pub(super) const TOLERANCE: f64 = 1e-6;
/// The same in the first step, and its fall from step to step: a state that is far off finds its way along loose equations.
const LOOSE: f64 = 1e-2;
const TIGHTER: f64 = 0.1;
/// What coefficients are multiplied by in rows that keep those bounded that nothing else speaks of.
pub(super) const RIDGE: f64 = 1e-6;
/// Standard deviation of the learned scalars' parameters before any row is seen.
const LEARNED: f64 = 10.0;
/// How fields are smooth while only data are regressed.
const REGRESS: Smoothness = Smoothness { order: 2, stretched: false };
/// Cells of a source's shortest wave, before the first step says how smooth it is.
const SHORTEST: f64 = 12.0;
/// Rows that the noise's estimate from differences is worth.
const NOISE_COUNT: f64 = 2.0;
/// Least noise, as a share of the spread of the data: rounding.
const LEAST_NOISE: f64 = 1e-10;
/// Least roughness, and least amplitude of a source beside its natural size.
const LEAST_ROUGHNESS: f64 = 1e-12;
const LEAST_AMPLITUDE: f64 = 1e-6;
/// Logarithm of the evidence that a larger source may cost and still be possible, and how many numbers must be told of a source
/// for the evidence to know its size.
const DOUBT: f64 = 2.0;
const TELLING: f64 = 2.0;
/// Largest change of a learned parameter in a step.
const FARTHEST: f64 = 1.0;
/// A step is halved so often before it is given up.
const HALVINGS: u32 = 8;

/// An iterate.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    pub(super) classes: Vec<Class>,
    /// Tolerance of the equations.
    pub(super) tolerance: f64,
    pub(super) step: u64,
}

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Data under a prior of the fields' roughness.
    Regress,
    /// Everything under a prior of the sources' roughness.
    Solve,
}

/// A problem on its splines.
pub(super) struct Solver<'a> {
    pub(super) bound: &'a Bound,
    pub(super) heads: Heads,
    /// Groups where their rows are asked for.
    pub(super) groups: Vec<Group>,
    /// By group and term, the number of its class.
    classes: Vec<Vec<usize>>,
    /// By head, the number of the class of its roughness.
    roughness: Vec<usize>,
    /// By head, the number of the class of its amplitude, where it is a source.
    amplitude: Vec<Option<usize>>,
    /// By head, its prior: that of sources while everything is solved, that of fields while data are regressed.
    priors: Vec<Prior>,
    /// The class of a condition that is left out.
    left_out: Option<usize>,
    /// Sizes of equations, by group and row.
    sizes: Vec<Vec<f64>>,
    scalars: Vec<f64>,
    /// Length of the domain.
    length: f64,
    triangle: Triangle,
}

/// What a step found.
pub(super) struct Found {
    pub(super) next: State,
    /// Half the sum of squares of all rows before the step.
    pub(super) loss: f64,
    /// Largest change of a coefficient or parameter.
    pub(super) change: f64,
    /// Logarithm of the evidence, up to a constant.
    pub(super) evidence: f64,
    pub(super) covariance: Covariance,
    /// By head, how many numbers rows other than its prior say of a source.
    told: Vec<f64>,
}

impl<'a> Solver<'a> {
    /// Splines over the cells between breakpoints. The scene must not be refused.
    pub(super) fn over(bound: &'a Bound, breakpoints: &[f64]) -> Self {
        let schema = bound.problem.scene().schema;
        let heads = Heads::new(bound, &cells::degrees(schema).unwrap_or_default(), breakpoints);
        let kernels = bound.problem.scene().double();
        let group = |(at, kernel)| {
            let moved = cells::places(bound, at, breakpoints);
            let places = moved.as_deref().unwrap_or(&bound.coordinates[at]);
            Group::new(&schema.groups[at], kernel, &heads, places, &bound.filled_columns(at))
        };
        let groups: Vec<Group> = kernels.into_iter().take(schema.groups.len()).enumerate().map(group).collect();
        let mut count = 0;
        let mut next = || {
            count += 1;
            count - 1
        };
        let classes = schema.groups.iter().map(|g| g.terms.iter().map(|_| next()).collect()).collect();
        let roughness = schema.heads.iter().map(|_| next()).collect();
        let amplitude = schema.heads.iter().map(|head| head.source.then(&mut next)).collect();
        let priors = heads.bases.iter().map(|basis| Prior::new(basis, REGRESS)).collect();
        let sizes = schema.groups.iter().map(|group| vec![0.0; group.rows]).collect();
        let triangle = Triangle::new(heads.len(), heads.band, bound.learned.len());
        let scalars = bound.scalars.clone();
        let length = breakpoints[breakpoints.len() - 1] - breakpoints[0];
        Self {
            bound,
            heads,
            groups,
            classes,
            roughness,
            amplitude,
            priors,
            left_out: None,
            sizes,
            scalars,
            length,
            triangle,
        }
    }

    /// Bytes that splines over these cells take, about: the triangle and its inverse, a row for every measurement and equation
    /// of a cell, and the splines at all places.
    pub(super) fn bytes(bound: &Bound, breakpoints: &[f64]) -> f64 {
        let schema = bound.problem.scene().schema;
        let degrees = cells::degrees(schema).unwrap_or_default();
        let (cells, shared) = ((breakpoints.len() - 1) as f64, bound.learned.len() as f64);
        // Of all heads on a cell: as many as rows and the band are wide.
        let functions = degrees.iter().map(|degree| (degree + 1) as f64).sum::<f64>();
        let triangles = 3.0 * cells * degrees.len() as f64 * (functions + shared);
        let groups = schema.groups.iter().zip(&bound.coordinates).map(|(group, points)| {
            let is_measured = !group.columns.is_empty();
            let places = if is_measured { points.len() as f64 } else { cells };
            let own = if is_measured { functions / degrees.len() as f64 } else { functions };
            let lines = group.jets.iter().map(|jet| (degrees[jet.head] + 1) as f64).sum::<f64>();
            places * (lines + group.rows as f64 * (1.25 * own + group.jets.len() as f64 + shared + 4.0))
        });
        size_of::<f64>() as f64 * (triangles + groups.sum::<f64>())
    }

    /// True if a source is sought.
    pub(super) fn has_sources(&self) -> bool {
        self.bound.problem.scene().schema.heads.iter().any(|head| head.source)
    }

    /// Takes sources for smooth in this way from now on.
    pub(super) fn set_smoothness(&mut self, kind: Smoothness) {
        for head in self.believed(Phase::Solve).collect::<Vec<usize>>() {
            self.priors[head] = Prior::new(&self.heads.bases[head], kind);
        }
    }

    /// Takes sources for smooth in another way from now on, with waves as long as a state's.
    pub(super) fn change_smoothness(&mut self, kind: Smoothness, state: &mut State) {
        let before = self.priors.clone();
        self.set_smoothness(kind);
        for (head, before) in before.iter().enumerate() {
            let Some(amplitude) = self.amplitude[head] else { continue };
            let [own, rough] = [amplitude, self.roughness[head]].map(|class| state.classes[class].size);
            let cells = before.cells(rough, own);
            let is_wave = cells < self.heads.bases[head].cells() as f64;
            let (own, cells) = if is_wave { (own, cells) } else { (self.length.sqrt(), SHORTEST) };
            state.classes[amplitude].restart(own);
            state.classes[self.roughness[head]].restart(self.priors[head].roughness(own, cells));
        }
    }

    /// Where the solver starts: heads at their offsets, noise as differences of the data say.
    pub(super) fn first(&self, noise: &Noise) -> State {
        let schema = self.bound.problem.scene().schema;
        let mut classes = Vec::new();
        for (at, group) in schema.groups.iter().enumerate() {
            for (term, declared) in group.terms.iter().enumerate() {
                let known = self.bound.sizes[at][term] / declared.weight.sqrt();
                classes.push(match noise.of(at, term) {
                    Some(found) if declared.within.is_none() => {
                        let least = LEAST_NOISE * found.spread.max(f64::MIN_POSITIVE);
                        let size = found.deviation.max(least);
                        Class::open(size, Guess { size, count: NOISE_COUNT, least })
                    }
                    None if declared.within.is_none() && declared.kind == TermKind::Observation => {
                        let size = 1e-2 * known;
                        Class::open(size, Guess { size, count: NOISE_COUNT, least: 1e-9 * known })
                    }
                    _ => Class::known(known),
                });
            }
        }
        let open = |size: f64, least: f64| Class::open(size, Guess { size: 0.0, count: 0.0, least });
        let natural = self.length.sqrt();
        // Fields are rougher than anything that the cells can hold, until the first step says how rough.
        let field = |prior: &Prior| prior.roughness(natural, 1.0).max(1e9);
        let rough = schema.heads.iter().zip(&self.priors).map(|(head, prior)| {
            open(if head.source { prior.roughness(natural, SHORTEST) } else { field(prior) }, LEAST_ROUGHNESS)
        });
        classes.extend(rough);
        classes.extend(self.amplitude.iter().flatten().map(|_| open(natural, LEAST_AMPLITUDE * natural)));
        State {
            theta: vec![0.0; self.heads.len()],
            learned: vec![0.0; self.bound.learned.len()],
            classes,
            tolerance: LOOSE,
            step: 0,
        }
    }

    /// Takes over learned scalars; returns their derivatives by their parameters.
    fn set_learned(&mut self, parameters: &[f64]) -> Vec<f64> {
        let found = self.bound.learned.iter().zip(parameters).map(|(learned, &parameter)| learned.map.at(parameter));
        let found: Vec<(f64, f64)> = found.collect();
        for (learned, (value, _)) in self.bound.learned.iter().zip(&found) {
            self.scalars[learned.slot] = *value;
        }
        found.into_iter().map(|(_, slope)| slope).collect()
    }

    /// Scalars that programs read, at parameters of the learned ones.
    pub(super) fn scalars(&mut self, learned: &[f64]) -> &[f64] {
        self.set_learned(learned);
        &self.scalars
    }

    /// Sizes of equations as the sum of the magnitudes of their terms at a state; what units and data say where that is zero.
    fn size(&mut self, state: &State) {
        self.set_learned(&state.learned);
        for (at, group) in self.groups.iter().enumerate().filter(|(_, group)| group.len() > 0) {
            let magnitudes = group.magnitudes(&self.heads, &state.theta, &self.scalars);
            for (term, &natural) in group.schema.terms.iter().zip(&self.bound.sizes[at]) {
                for (row, magnitudes) in magnitudes.iter().enumerate().skip(term.first).take(term.rows) {
                    let squares = magnitudes.iter().map(|x| x * x).sum::<f64>();
                    let size = (squares / group.len() as f64).sqrt();
                    let is_size = size.is_finite() && size > 1e-9 * natural && term.within.is_none();
                    self.sizes[at][row] =
                        if is_size { size / term.weight.sqrt() } else { natural / term.weight.sqrt() };
                }
            }
        }
    }

    /// What a row of a group is divided by.
    pub(super) fn sigma(&self, state: &State, group: usize, term: usize, row: usize) -> f64 {
        let declared = &self.groups[group].schema.terms[term];
        match declared.kind {
            TermKind::Observation => state.classes[self.classes[group][term]].size,
            _ if declared.within.is_some() => self.sizes[group][row],
            _ => state.tolerance * self.sizes[group][row],
        }
    }

    /// Rows about a state with their classes, in the order of their unknowns, and what [`Solver::loss`] makes of them; what is
    /// not finite is a fault.
    fn rows(&mut self, state: &State, phase: Phase) -> Result<(Rows, f64), Fault> {
        let slopes = self.set_learned(&state.learned);
        let shared = slopes.len();
        let mut rows = Rows::new(shared);
        let mut cost = 0.0;
        for (at, group) in self.groups.iter().enumerate() {
            let takes_part = |term: &crate::schema::Term| phase == Phase::Solve || term.kind == TermKind::Observation;
            if group.len() == 0 || !group.schema.terms.iter().any(takes_part) {
                continue;
            }
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, Some(shared));
            for (number, term) in group.schema.terms.iter().enumerate().filter(|(_, term)| takes_part(term)) {
                if self.left_out == Some(self.classes[at][number]) {
                    continue;
                }
                let loss = self.bound.losses[at][number];
                let lacking = self.bound.lacking(at, term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                for row in term.first..term.first + term.rows {
                    let sigma = self.sigma(state, at, number, row);
                    for (cell, places) in group.by_cell(|p| is_there(&p)) {
                        let mut own = group.bundle(&self.heads, cell, shared);
                        for p in places {
                            let misfit = found.row(row, p);
                            if !misfit.is_finite() {
                                let name = format!("{}.{}", group.schema.name, term.name);
                                return Err(Fault::residual(name, Some(p)));
                            }
                            cost += loss.rho(misfit / sigma);
                            let factor = loss.weight(misfit / sigma).sqrt() / sigma;
                            group.add_row(&self.heads, (&found, row, p), &slopes, factor, &mut own);
                        }
                        rows.push_all(&own, self.classes[at][number]);
                    }
                }
            }
        }
        let known = state.classes.len();
        let none = vec![0.0; shared];
        cost += self.add_priors(state, phase, &mut |row, class| rows.push(row, class));
        for head in 0..self.heads.bases.len() {
            for &number in self.heads.numbers(head, 0) {
                let value = RIDGE * state.theta[number];
                rows.push(Row { first: number, slopes: &[RIDGE], shared: &none, value }, known);
            }
        }
        rows.sort();
        for (at, parameter) in state.learned.iter().enumerate() {
            let mut shared = none.clone();
            shared[at] = LEARNED.recip();
            rows.push(Row { first: 0, slopes: &[], shared: &shared, value: parameter / LEARNED }, known);
        }
        Ok((rows, cost))
    }

    /// The heads that have a prior in a phase: sources, or fields while only data are regressed.
    fn believed(&self, phase: Phase) -> impl Iterator<Item = usize> + '_ {
        let heads = self.bound.problem.scene().schema.heads.iter().enumerate();
        heads.filter(move |(_, head)| head.source == (phase == Phase::Solve)).map(|(head, _)| head)
    }

    /// Gives the rows that keep sources small and smooth, or fields smooth while only data are regressed, with their classes;
    /// returns half the sum of their squares.
    fn add_priors(&self, state: &State, phase: Phase, take: &mut dyn FnMut(Row<'_>, usize)) -> f64 {
        let none = vec![0.0; state.learned.len()];
        let mut slopes = Vec::new();
        let mut cost = 0.0;
        for head in self.believed(phase) {
            let (prior, class) = (&self.priors[head], self.roughness[head]);
            for (first, factors) in prior.smooth(state.classes[class].size) {
                let numbers = &self.heads.numbers(head, first)[..prior.width()];
                let mut value = 0.0;
                slopes.clear();
                slopes.resize(numbers[prior.width() - 1] + 1 - numbers[0], 0.0);
                for (&number, factor) in numbers.iter().zip(&factors) {
                    slopes[number - numbers[0]] = *factor;
                    value += factor * state.theta[number];
                }
                cost += 0.5 * value * value;
                take(Row { first: numbers[0], slopes: &slopes, shared: &none, value }, class);
            }
            let Some(class) = self.amplitude[head] else { continue };
            for (&number, factor) in self.heads.numbers(head, 0).iter().zip(prior.small(state.classes[class].size)) {
                let value = factor * state.theta[number];
                cost += 0.5 * value * value;
                take(Row { first: number, slopes: &[factor], shared: &none, value }, class);
            }
        }
        cost
    }

    /// Half the sum of squares of all rows, robust ones by what they cost.
    fn loss(&mut self, state: &State, phase: Phase) -> f64 {
        self.set_learned(&state.learned);
        let mut sum = 0.0;
        for (at, group) in self.groups.iter().enumerate().filter(|(_, group)| group.len() > 0) {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, None);
            for (number, term) in group.schema.terms.iter().enumerate() {
                if phase == Phase::Regress && term.kind != TermKind::Observation {
                    continue;
                }
                let loss = self.bound.losses[at][number];
                let lacking = self.bound.lacking(at, term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                for row in term.first..term.first + term.rows {
                    let sigma = self.sigma(state, at, number, row);
                    sum += (0..group.len()).filter(is_there).map(|p| loss.rho(found.row(row, p) / sigma)).sum::<f64>();
                }
            }
        }
        sum + self.add_priors(state, phase, &mut |_, _| {})
    }

    /// The triangle of all rows about a state, those of a condition left out, by its group and term, if one is given; nothing
    /// where the rest leaves unknowns open.
    pub(super) fn root(&mut self, state: &State, without: Option<(usize, usize)>) -> Result<Option<Triangle>, Fault> {
        self.size(state);
        self.left_out = without.map(|(group, term)| self.classes[group][term]);
        let rows = self.rows(state, Phase::Solve);
        self.left_out = None;
        let mut triangle = Triangle::new(self.heads.len(), self.heads.band, state.learned.len());
        triangle.add_all(rows?.0.walk());
        Ok(triangle.solve().map(|_| triangle))
    }

    /// One step.
    pub(super) fn step(&mut self, state: &State, phase: Phase) -> Result<Option<Found>, Fault> {
        self.size(state);
        let (rows, before) = self.rows(state, phase)?;
        self.triangle.clear();
        self.triangle.add_all(rows.walk());
        let Some((step, shared)) = self.triangle.solve() else { return Ok(None) };
        let covariance = self.triangle.covariance();
        let is_equation = self.equations();
        let mut tallies = vec![Tally::default(); state.classes.len() + 1];
        let mut loss = 0.0;
        let mut walk = rows.walk();
        while let Some(Counted { row, class, count }) = walk.step() {
            let tally = &mut tallies[class];
            let along: f64 = row.slopes.iter().zip(&step[row.first..]).map(|(a, x)| a * x).sum();
            let beside: f64 = row.shared.iter().zip(&shared).map(|(a, x)| a * x).sum();
            tally.squares += (row.value + along + beside).powi(2);
            tally.count += count as f64;
            // Equations are so much stricter than anything else that each settles an unknown.
            if !is_equation[class] {
                tally.used += covariance.of(row.first, row.slopes, row.shared).max(0.0);
            }
            loss += 0.5 * row.value.powi(2);
        }
        let worth = self.count_priors(state, &mut tallies, phase);
        let squares: f64 = tallies.iter().map(|tally| tally.squares).sum();
        let evidence = -0.5 * squares - self.log_sizes(state, &tallies) + worth - self.triangle.log_determinant();
        let mut share = shared.iter().fold(1.0, |share: f64, x| share.min(FARTHEST / x.abs().max(1e-300)));
        let mut next = state.clone();
        for _ in 0..HALVINGS {
            next.theta = state.theta.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            next.learned = state.learned.iter().zip(&shared).map(|(x, s)| x + share * s).collect();
            let after = self.loss(&next, phase);
            if after.is_finite() && after <= before * (1.0 + 1e-9) + 1e-12 {
                break;
            }
            share *= 0.5;
        }
        let change = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let change = change(&state.theta, &next.theta).max(change(&state.learned, &next.learned));
        // While equations are loose, they need no source.
        let is_loose = phase == Phase::Solve && state.tolerance > TOLERANCE;
        let is_prior = |class| self.roughness.contains(&class) || self.amplitude.contains(&Some(class));
        renew(&mut next.classes, &tallies, |class| is_loose && is_prior(class));
        if phase == Phase::Solve {
            next.tolerance = (state.tolerance * TIGHTER).max(TOLERANCE);
        }
        next.step += 1;
        let left = |class: usize| tallies[class].count - tallies[class].used;
        let told = self.roughness.iter().zip(&self.amplitude);
        let told = told.map(|(&rough, amplitude)| amplitude.map_or(0.0, |class| left(rough) + left(class))).collect();
        Ok(Some(Found { next, loss, change, evidence, covariance, told }))
    }

    /// By class, whether its rows are those of an equation; one more for what is known beforehand.
    fn equations(&self) -> Vec<bool> {
        let terms = self.groups.iter().flat_map(|group| group.schema.terms);
        let priors = self.roughness.len() + self.amplitude.iter().flatten().count();
        terms.map(|term| term.kind == TermKind::Residual).chain(vec![false; priors + 1]).collect()
    }

    /// How rough and how large a source is believed to be; nothing of fields.
    pub(super) fn source_sizes(&self, state: &State, head: usize) -> Option<(f64, f64)> {
        let size = |class: usize| state.classes[class].size;
        self.amplitude[head].map(|amplitude| (size(self.roughness[head]), size(amplitude)))
    }

    /// Sum of the logarithms of what rows are divided by, those of priors aside.
    fn log_sizes(&self, state: &State, tallies: &[Tally]) -> f64 {
        let mut sum = 0.0;
        for (at, group) in self.groups.iter().enumerate() {
            for (number, term) in group.schema.terms.iter().enumerate() {
                let rows = term.first..term.first + term.rows;
                let logs: f64 = rows.map(|row| self.sigma(state, at, number, row).ln()).sum();
                let count = tallies[self.classes[at][number]].count;
                // Terms without rows have no size.
                sum += if count > 0.0 { count * logs / term.rows as f64 } else { 0.0 };
            }
        }
        sum
    }

    /// What error bars are taken from, and the step about it: sources as rough as a wave over the domain at least, and where
    /// hardly anything is told of them, as large as the evidence does not speak against. Where the evidence takes a source for
    /// nothing, or for a polynomial, error bars should not.
    pub(super) fn doubted(&mut self, mut state: State) -> Result<Option<(State, Found)>, Fault> {
        let Some(mut found) = self.step(&state, Phase::Solve)? else { return Ok(None) };
        let (least, natural) = (found.evidence - DOUBT, self.length.sqrt());
        for head in 0..self.roughness.len() {
            let Some(amplitude) = self.amplitude[head] else { continue };
            loop {
                let mut doubted = state.clone();
                let [own, rough] = [amplitude, self.roughness[head]].map(|class| state.classes[class].size);
                let own = if found.told[head] < TELLING { own.max((2.0 * own).min(natural)) } else { own };
                let wave = self.priors[head].roughness(own, self.heads.bases[head].cells() as f64);
                doubted.classes[amplitude].size = own;
                doubted.classes[self.roughness[head]].size = rough.max(wave);
                if doubted.classes == state.classes {
                    break;
                }
                match self.step(&doubted, Phase::Solve)? {
                    Some(next) if next.evidence > least => (state, found) = (doubted, next),
                    _ => break,
                }
            }
        }
        Ok(Some((state, found)))
    }

    /// What priors use up, and what they are worth; returns the logarithm of the determinant of their rows.
    ///
    /// What roughness uses up is what everything else leaves of all unknowns: summed row by row it would be a small difference of
    /// large numbers where cells are much finer than the source.
    fn count_priors(&self, state: &State, tallies: &mut [Tally], phase: Phase) -> f64 {
        let mut log_determinant = 0.0;
        for head in self.believed(phase) {
            let (rough, Some(amplitude)) = (self.roughness[head], self.amplitude[head]) else { continue };
            let worth = self.priors[head].worth(state.classes[rough].size, state.classes[amplitude].size);
            log_determinant += worth.log_determinant;
            // Rounding where waves are much longer than cells.
            let small = worth.amplitude.clamp(0.0, tallies[amplitude].count);
            tallies[rough].count = tallies[amplitude].count - small;
            tallies[amplitude].count = small;
        }
        let unknowns = (self.heads.len() + self.bound.learned.len()) as f64;
        let is_rough = |class: usize| self.roughness.contains(&class);
        let is_equation = self.equations();
        tallies.iter_mut().zip(&is_equation).filter(|(_, is)| **is).for_each(|(tally, _)| tally.used = tally.count);
        let used: f64 =
            tallies.iter().enumerate().filter(|&(class, _)| !is_rough(class)).map(|(_, tally)| tally.used).sum();
        let rough = || self.roughness.iter().copied();
        let by_rows: f64 = rough().map(|class| tallies[class].used.clamp(0.0, tallies[class].count)).sum();
        let count: f64 = rough().map(|class| tallies[class].count).sum();
        let left = (unknowns - used).clamp(0.0, count);
        for class in rough() {
            let own = tallies[class].used.clamp(0.0, tallies[class].count);
            let share = if by_rows > 0.0 { own / by_rows } else { tallies[class].count / count.max(1.0) };
            tallies[class].used = (left * share).min(tallies[class].count);
        }
        log_determinant
    }

    /// The heads, and what they say at the points of all groups.
    pub(super) fn into_facts(self, breakpoints: &[f64], theta: &[f64]) -> (Heads, Vec<Facts>) {
        let Self { bound, heads, groups, .. } = self;
        let schema = bound.problem.scene().schema;
        let of = |(at, (own, kernel)): (usize, (Group, GroupKernel<f64>))| {
            if cells::places(bound, at, breakpoints).is_none() {
                return own.facts(&heads, theta);
            }
            let columns = bound.filled_columns(at);
            Group::new(&schema.groups[at], kernel, &heads, &bound.coordinates[at], &columns).facts(&heads, theta)
        };
        let facts = groups.into_iter().zip(bound.problem.scene().double()).enumerate().map(of).collect();
        (heads, facts)
    }

    /// Misfits of all terms at their places, by group, and the noise of observations.
    pub(super) fn misfits(&mut self, state: &State) -> Vec<Vec<(Vec<f64>, Option<f64>)>> {
        self.set_learned(&state.learned);
        let of = |(at, group): (usize, &Group)| {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, None);
            let terms = group.schema.terms.iter().enumerate().map(|(number, term)| {
                let rows = term.first..term.first + term.rows;
                let lacking = self.bound.lacking(at, term);
                let is_there = |p: &usize| lacking.as_ref().is_none_or(|measured| measured[*p]);
                let places: Vec<usize> = (0..group.len()).filter(is_there).collect();
                let misfits =
                    rows.flat_map(|row| places.iter().map(move |&p| (row, p))).map(|(row, p)| found.row(row, p));
                let is_data = term.kind == TermKind::Observation;
                (misfits.collect(), is_data.then(|| state.classes[self.classes[at][number]].size))
            });
            terms.collect()
        };
        self.groups.iter().enumerate().map(of).collect()
    }
}

impl State {
    pub(super) fn save(&self, saved: state::State, prefix: &str) -> state::State {
        save_classes(&self.classes, saved, prefix)
            .with(&format!("{prefix}theta"), &self.theta)
            .with(&format!("{prefix}learned"), &self.learned)
            .with(&format!("{prefix}tolerance"), &[self.tolerance])
            .with_counter(&format!("{prefix}step"), self.step)
    }

    /// Takes over what [`State::save`] gave of the same problem.
    pub(super) fn restore(&mut self, saved: &state::State, prefix: &str) -> Result<(), Fault> {
        restore_classes(&mut self.classes, saved, prefix)?;
        self.theta = saved.sized(&format!("{prefix}theta"), self.theta.len())?;
        self.learned = saved.sized(&format!("{prefix}learned"), self.learned.len())?;
        [self.tolerance] = saved.scalars(&format!("{prefix}tolerance"))?;
        self.step = saved.counter(&format!("{prefix}step"))?;
        Ok(())
    }
}
