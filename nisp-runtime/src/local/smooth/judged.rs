//! What an answer on a lattice says: deviations, misfits, and what the verdict is made from.

use super::belief::BorneOut;
use super::between::stating;
use super::means::Asked;
use super::solver::{Others, Solver, groups};
use super::state::{Phase, State};
use super::{edges, short};
use crate::correlation;
use crate::facts::{Answer, MORE_POINTS, OTHER_THAN_SPLINES};
use crate::local::draws::{Deviations, Draws};
use crate::local::group::Group;
use crate::local::misfits::Misfits;
use crate::noise::{Noise, ObservationNoise};
use crate::problem::Bound;
use crate::reads::where_read;
use crate::schema::{self, TermKind};
use crate::solve::vector::{farthest, root_mean_square};

/// Equations that are left over by this much beside their tolerance are held back by the cells of the lattice.
const TENSE: f64 = 0.2;
/// Distances to a cloud that splines do not follow, as a share of a cell: they are of high degree.
const UNRESOLVED: f64 = 3e-3;
/// What may be left of an equation between the points that it was asked at, over its size; and where nothing is noisy, so that only
/// the cells keep an answer from being exact.
const BETWEEN: f64 = 0.03;
const EXACT: f64 = 1e-3;
/// Noise that is found, beside what neighbouring measurements say, from which on these are missed.
pub(super) const MISSED: f64 = 1.3;
/// The same ratio above which the cells are taken to be too coarse for what is measured.
pub(super) const FAR: f64 = 4.0;
/// Correlation of neighbouring misfits in its own deviations, and the least that matters.
const ALIKE: f64 = 5.0;
const SLIGHT: f64 = 0.05;
/// Steps to an answer under another belief.
const DOUBTS: u64 = 4;

impl Solver<'_> {
    /// Deviations of all unknowns from an answer, and by coefficient the deviation of what the cells cannot hold. How an answer
    /// changes with what is believed of its sources is unknown as well: draws are from the posterior under another belief, about the
    /// answer under that one.
    pub(super) fn doubted(&mut self, state: &State) -> Option<(Deviations, Vec<f64>)> {
        let mut beyond = vec![0.0; state.theta.len()];
        let (mut other, mut eases) = (state.clone(), false);
        if !self.judged(Phase::Solve).is_empty() {
            let bends = self.evidence_of_belief(state);
            let draws = self.deviations(state)?.coefficients;
            self.doubt(&mut other).ok()?;
            for _ in 0..DOUBTS {
                other = self.step(&other).ok()?.next;
            }
            let borne_out = BorneOut::by(bends, self.evidence_of_belief(&other));
            match borne_out {
                BorneOut::Edges => other = self.as_rough_as_likely(&other)?,
                BorneOut::Bends => eases = true,
                BorneOut::Unknown => {}
            }
            for head in self.judged(Phase::Solve) {
                let own = self.heads.first[head]..self.heads.first[head + 1];
                let size = |state: &State| state.classes[self.roughness[head]].size;
                let likely = |draw: &Vec<f64>| own.clone().map(|at| state.theta[at] + draw[at]).collect();
                let short = match borne_out {
                    BorneOut::Bends => 0.0,
                    BorneOut::Edges => edges::unresolved(&self.heads, head, size(&other)),
                    BorneOut::Unknown => {
                        let likely: Vec<Vec<f64>> = draws.iter().map(likely).collect();
                        short::unresolved(&self.heads, head, &likely, size(state))
                    }
                };
                beyond[own].fill(short);
            }
        }
        // Bars of a smooth source are drawn under loose equations: strict ones rule out short waves only because the cells cannot follow them.
        let about = if eases { self.eased(&other) } else { other.clone() };
        self.set_sigmas(&about);
        let mut deviations = self.deviations(&about)?;
        let add = |draws: &mut [Vec<f64>], ours: &[f64], theirs: &[f64]| {
            // Signs in turns, so that draws stay draws about nothing.
            for (draw, sign) in draws.iter_mut().zip([1.0, -1.0].into_iter().cycle()) {
                draw.iter_mut()
                    .zip(ours.iter().zip(theirs))
                    .for_each(|(x, (ours, theirs))| *x += sign * (theirs - ours));
            }
        };
        add(&mut deviations.coefficients, &state.theta, &other.theta);
        add(&mut deviations.learned, &state.learned, &other.learned);
        Some((deviations, beyond))
    }

    /// Deviations of all unknowns, drawn from the posterior about a state.
    fn deviations(&mut self, state: &State) -> Option<Deviations> {
        let slopes = self.set_learned(&state.learned);
        self.normal.draws = Some(Draws::new(state.theta.len(), state.learned.len()));
        let assembled = self.assemble(state, &slopes);
        let draws = self.normal.draws.take()?;
        assembled.ok()?;
        self.normal.factor()?.deviations(&draws)
    }

    /// How far the cells of the lattice hold an answer back, over what may be: equations and conditions that are left over beside
    /// their tolerance, and measurements that are missed by more than their noise.
    pub(super) fn strain(&mut self, state: &State, noise: &Noise) -> f64 {
        let left = self.left_of_equations(state, noise);
        left.max(self.missed(state, noise) / MISSED).max(self.alike(state, noise))
    }

    /// How far the cells hold equations and conditions back, over what may be; measurements do not count.
    pub(super) fn left_of_equations(&mut self, state: &State, noise: &Noise) -> f64 {
        self.set_learned(&state.learned);
        self.size(state);
        self.set_sigmas(state);
        // What is left of a group's equations, each row over what may be.
        let left = |group: &Group, may_be: &dyn Fn(usize) -> f64| {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            let of_row = |row: usize| {
                let is_known = |misfit: &f64| !misfit.is_nan();
                let misfits = group.asked(&found, row).into_iter().filter(is_known);
                root_mean_square(misfits.map(|misfit| misfit / may_be(row)))
            };
            let is_equation = |term: &&schema::Term| term.kind == TermKind::Residual && term.within.is_none();
            let equations = group.schema.terms.iter().filter(is_equation);
            equations.flat_map(|term| term.first..term.first + term.rows).map(of_row).fold(0.0, f64::max)
        };
        let share = if noise.is_there(self.schema()) { BETWEEN } else { EXACT };
        let asked = self.groups.iter().enumerate().map(|(at, group)| match self.asked[at] {
            // Cells meet conditions that contradict each other as closely as they can.
            Asked::InMean(_) => left(group, &|row| share * self.sizes[at][row]),
            _ => left(group, &|row| TENSE * group.sigma[row]),
        });
        let of_others = |(of, (bound, means)): &Others| {
            let groups = groups(bound, &self.heads, means);
            let left = of.iter().map(|&at| left(&groups[at], &|row| share * self.sizes[at][row]));
            left.fold(0.0, f64::max)
        };
        let between = self.others.as_ref().map_or(0.0, of_others);
        asked.chain([between]).fold(0.0, f64::max)
    }

    /// How much more neighbouring misfits of noisy measurements are alike than those of noise may be, at most: so they are where cells are
    /// too coarse for the measurements, or an equation does not fit these. The state's learned scalars are set.
    pub(super) fn alike(&self, state: &State, noise: &Noise) -> f64 {
        let of = |found: &ObservationNoise| {
            let group = &self.groups[found.group];
            let term = &group.schema.terms[found.term];
            let evaluated = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            let places = self.bound.measured(found.group, term, &self.bound.coordinates[found.group]);
            let row = |row: usize| {
                let misfits: Vec<f64> = (0..group.sites.count).map(|p| evaluated.row(row, p)).collect();
                let misfits = self.bound.measured(found.group, term, &misfits);
                let (correlation, deviations) =
                    correlation::over_coordinates(&places, self.schema().coordinates.len(), &misfits);
                if correlation > SLIGHT { deviations / ALIKE } else { 0.0 }
            };
            (term.first..term.first + term.rows).map(row).fold(0.0, f64::max)
        };
        let is_robust = |found: &&ObservationNoise| self.bound.losses[found.group][found.term].is_robust();
        let is_cloud = |found: &&ObservationNoise| {
            self.schema().groups[found.group].terms[found.term].kind != TermKind::Observation
        };
        let all = noise.observations.iter().filter(|found| !found.is_exact());
        all.filter(|found| !is_cloud(found) && !is_robust(found)).map(of).fold(0.0, f64::max)
    }

    /// How far an answer is from one on another lattice, at most: heads at the points of equations and data over their size, or learned
    /// scalars. Where nothing is measured heads count wherever they differ most, over their range, also at places that neither was asked
    /// at.
    pub(super) fn apart(&self, state: &State, other: &Solver<'_>, before: &State) -> f64 {
        let schema = self.schema();
        // Points with what is read there, `[head][point]`.
        let at_points = |(at, groups, bound): (usize, &[Group], &Bound)| {
            let facts = groups[at].facts(&self.heads, &state.theta);
            let known = (schema.heads.len(), &*self.scalars);
            (bound.coordinates[at].clone(), where_read(&facts, groups[at].kernel.programs, &schema.groups[at], known))
        };
        let mut points: Vec<_> = (0..self.groups.len()).map(|at| at_points((at, &self.groups, &self.bound))).collect();
        if let Some((of, (others, means))) = self.others.as_ref().filter(|_| !self.is_measured()) {
            let groups = groups(others, &self.heads, means);
            points.extend(of.iter().map(|&at| at_points((at, &groups, others))));
        }
        let of = |head: usize| {
            let own = points.iter().flat_map(|(points, read)| {
                points.chunks_exact(schema.coordinates.len()).zip(&read[head]).filter(|(_, read)| **read)
            });
            let points: Vec<f64> = own.flat_map(|(point, _)| point).copied().collect();
            let (own, others) =
                (self.heads.values(head, &points, &state.theta), other.heads.values(head, &points, &before.theta));
            if !self.is_measured() {
                return farthest(&own, &others, self.heads.scale[head]);
            }
            let change = root_mean_square(own.iter().zip(&others).map(|(a, b)| a - b));
            if change > 0.0 { change / root_mean_square(own) } else { 0.0 }
        };
        let value = |at: usize, state: &State| self.bound.learned[at].map.at(state.learned[at]).0;
        let learned = (0..self.bound.learned.len()).map(|at| (value(at, before) / value(at, state) - 1.0).abs());
        (0..schema.heads.len()).map(of).chain(learned).fold(0.0, f64::max)
    }

    /// How much larger the measurements' noise is, as found here, than that which neighbouring ones say, at most.
    pub(super) fn missed(&self, state: &State, noise: &Noise) -> f64 {
        let size = |found: &ObservationNoise| state.classes[self.classes[found.group][found.term]].size;
        let inexact = noise.observations.iter().filter(|found| !found.is_exact());
        inexact.map(|found| size(found) / found.deviation).fold(0.0, f64::max)
    }

    /// Whether the points of equations are drawn in a domain, as many as the user likes.
    fn is_drawn(&self) -> bool {
        stating(&self.bound).into_iter().any(|at| self.groups[at].schema.place.is_some())
    }

    /// Cells of the lattice along the coordinate that has most.
    pub(super) fn cells(&self) -> usize {
        self.heads.lattices.iter().flat_map(|lattice| &lattice.cells).copied().max().unwrap_or(0)
    }

    /// What a state says, for the verdict.
    pub(super) fn answer(&mut self, state: &State) -> Answer {
        self.set_learned(&state.learned);
        self.find_feet(state);
        let facts = self.groups.iter().map(|group| group.facts(&self.heads, &state.theta)).collect();
        let of_others = |(of, (bound, means)): &Others| {
            let groups = groups(bound, &self.heads, means);
            of.iter().map(|&at| (at, groups[at].facts(&self.heads, &state.theta))).collect()
        };
        let between = self.others.as_ref().map_or_else(Vec::new, of_others);
        Answer {
            facts,
            between,
            clouds: self.surfaces.iter().map(|surface| surface.facts(UNRESOLVED * surface.cell())).collect(),
            scalars: self.scalars.clone(),
            scores: Vec::new(),
            told: Vec::new(),
            leaning: Vec::new(),
            ahead: None,
            moved: None,
            left_to_learned: Vec::new(),
            strain: None,
            loose: None,
            shared: Vec::new(),
            used: 1.0,
            refined: None,
            is_coarse: false,
            finer: if self.is_drawn() { MORE_POINTS } else { OTHER_THAN_SPLINES },
        }
    }

    /// Misfits of all terms, by group, and the noise of observations.
    pub(super) fn misfits(&mut self, state: &State) -> Vec<Vec<Misfits>> {
        self.set_learned(&state.learned);
        self.find_feet(state);
        let of = |(at, group): (usize, &Group)| {
            let found = group.evaluate(&self.heads, &state.theta, &self.scalars, false);
            let counts = self.counts(at, Phase::Solve);
            let term = |(number, term): (usize, &schema::Term)| {
                if let Some(cloud) = self.surfaces.iter().find(|own| (own.group, own.term) == (at, term.name)) {
                    return (cloud.misfits().collect(), Some(self.sigma(state, cloud)));
                }
                let places = |row: usize| {
                    let asked = group.asked(&found, row).into_iter().zip(&counts[row]);
                    asked.filter(|(_, counts)| **counts).map(|(misfit, _)| misfit).collect::<Vec<f64>>()
                };
                let is_data = term.kind == TermKind::Observation;
                let noise = is_data.then(|| state.classes[self.classes[at][number]].size);
                ((term.first..term.first + term.rows).flat_map(places).collect(), noise)
            };
            group.schema.terms.iter().enumerate().map(term).collect()
        };
        self.groups.iter().enumerate().map(of).collect()
    }
}
