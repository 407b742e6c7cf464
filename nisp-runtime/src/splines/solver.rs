//! A problem on its splines: what is set up before any step, and what is read of it after the last.

use std::ops::Range;

use super::cells::{self, Moved};
use super::group::Group;
use super::heads::Heads;
use super::iterate::{Phase, State};
use super::prior::{Course, Prior, Smoothness};
use super::sharing;
use super::straight::Belief;
use super::triangle::Triangle;
use crate::facts::Facts;
use crate::kernel::GroupKernel;
use crate::noise::of_given;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::fault::Fault;

/// How fields are smooth while only data are regressed.
const REGRESS: Smoothness = Smoothness { order: 2, course: Course::Steady };
const LEVEL: Smoothness = Smoothness { order: 1, course: Course::Steady };
/// Cells of a source's shortest wave, before the first step says how smooth it is.
pub(super) const SHORTEST: f64 = 12.0;
/// Cells of the shortest wave that they hold.
const HELD: f64 = 4.0;

/// A problem on its splines.
pub(super) struct Solver<'a> {
    pub(super) bound: &'a Bound,
    pub(super) heads: Heads,
    /// Groups where their rows are asked for.
    pub(super) groups: Vec<Group>,
    /// By group and term, the number of its class.
    pub(super) classes: Vec<Vec<usize>>,
    /// By head, the number of the class of its roughness.
    pub(super) roughness: Vec<usize>,
    /// By head, the number of the class of its amplitude, where it is a source.
    pub(super) amplitude: Vec<Option<usize>>,
    /// By group and term, the number of the class of the length over which its noise may die away.
    pub(super) lengths: Vec<Vec<Option<usize>>>,
    /// By head, its prior: that of sources while everything is solved, that of fields while data are regressed.
    pub(super) priors: Vec<Prior>,
    /// The class of a condition that is left out.
    pub(super) left_out: Option<usize>,
    /// Whether the rows of data count.
    pub(super) is_measured: bool,
    /// Sizes of equations, by group and row.
    pub(super) sizes: Vec<Vec<f64>>,
    /// By group and column, the noise of what equations know.
    pub(super) noise_of_columns: Vec<Vec<f64>>,
    /// By group and row, how far that puts equations off.
    pub(super) blurs: Vec<Vec<f64>>,
    /// By group, row and place, how far what is asked for between places is off around there; nothing of other rows.
    pub(super) between: Vec<Vec<Vec<f64>>>,
    pub(super) scalars: Vec<f64>,
    /// What is believed of the lines that sources keep near to.
    pub(super) belief: Belief,
    /// Length of the domain.
    pub(super) length: f64,
    pub(super) triangle: Triangle,
}

/// What is believed of sources' lines beside what is learned.
fn belief(bound: &Bound) -> Belief {
    if bound.learned.is_empty() { Belief::DRIFT } else { Belief::LEVEL }
}

fn sources(schema: &crate::schema::Scene) -> usize {
    schema.heads.iter().filter(|head| head.source).count()
}

impl<'a> Solver<'a> {
    /// Splines over the cells between breakpoints. The scene must not be refused.
    pub(super) fn over(bound: &'a Bound, breakpoints: &[f64]) -> Self {
        let schema = bound.problem.scene().schema;
        let heads = Heads::new(bound, &cells::degrees(schema).unwrap_or_default(), breakpoints);
        let kernels = bound.problem.scene().double();
        let group = |(at, kernel): (usize, _)| {
            let own = || Moved { places: bound.coordinates[at].clone(), columns: bound.filled_columns(at) };
            let Moved { places, columns } = cells::moved(bound, at, breakpoints).unwrap_or_else(own);
            let group = Group::new(&schema.groups[at], kernel, &heads, &places, &columns);
            if cells::stands_for_interval(bound, at) { group.with_between(&heads, &places, &columns) } else { group }
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
        let lengths = sharing::numbered(bound, next());
        let observed = schema.observed();
        // Fields that are not observed are level at first: conditions are all that is known of them.
        let regressed = |head: usize| if observed.contains(&head) { REGRESS } else { LEVEL };
        let priors = heads.bases.iter().enumerate().map(|(head, basis)| Prior::new(basis, regressed(head))).collect();
        let sizes = schema.groups.iter().map(|group| vec![0.0; group.rows]).collect();
        let blurs = schema.groups.iter().map(|group| vec![0.0; group.rows]).collect();
        let belief = belief(bound);
        let lines = belief.numbers * sources(schema);
        let triangle = Triangle::new(heads.len(), heads.band, bound.learned.len() + lines);
        let scalars = bound.scalars.clone();
        let length = breakpoints[breakpoints.len() - 1] - breakpoints[0];
        Self {
            bound,
            heads,
            groups,
            classes,
            roughness,
            amplitude,
            lengths,
            priors,
            left_out: None,
            is_measured: true,
            sizes,
            noise_of_columns: (0..bound.columns.len()).map(|group| of_given(bound, group)).collect(),
            blurs,
            between: schema.groups.iter().map(|group| vec![Vec::new(); group.rows]).collect(),
            scalars,
            belief,
            length,
            triangle,
        }
    }

    /// The same where sources are small about zero: they keep near to no line.
    pub(super) fn without_lines(self) -> Self {
        let triangle = Triangle::new(self.heads.len(), self.heads.band, self.bound.learned.len());
        Self { belief: Belief::NONE, triangle, ..self }
    }

    /// Bytes that splines over these cells take, about: the triangle and its inverse, a row for every measurement and equation
    /// of a cell, and the splines at all places.
    pub(super) fn bytes(bound: &Bound, breakpoints: &[f64]) -> f64 {
        let schema = bound.problem.scene().schema;
        let degrees = cells::degrees(schema).unwrap_or_default();
        let (cells, shared) =
            ((breakpoints.len() - 1) as f64, (bound.learned.len() + belief(bound).numbers * sources(schema)) as f64);
        // Functions of all heads on a cell: rows and the band are as wide.
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

    /// Functions of all sources together.
    pub(super) fn source_functions(&self) -> usize {
        self.believed(Phase::Solve).into_iter().map(|head| self.heads.bases[head].len()).sum()
    }

    /// True if a source is sought.
    pub(super) fn has_sources(&self) -> bool {
        self.bound.problem.scene().schema.heads.iter().any(|head| head.source)
    }

    /// Takes sources for smooth in this way from now on, and as rough along the record as a state says.
    pub(super) fn set_smoothness(&mut self, kind: Smoothness, state: &State) {
        let mut uneven = &state.uneven[..];
        for head in self.believed(Phase::Solve) {
            let prior = Prior::new(&self.heads.bases[head], kind);
            self.priors[head] = match uneven.split_at_checked(self.heads.bases[head].len()) {
                Some((own, rest)) => {
                    uneven = rest;
                    prior.with(own)
                }
                None => prior,
            };
        }
    }

    /// Takes sources for smooth in another way from now on, with waves as long as a state's.
    pub(super) fn change_smoothness(&mut self, kind: Smoothness, state: &mut State) {
        let before = self.priors.clone();
        self.set_smoothness(kind, state);
        for (head, before) in before.iter().enumerate() {
            let Some(amplitude) = self.amplitude[head] else { continue };
            let [own, rough] = [amplitude, self.roughness[head]].map(|class| state.classes[class].size);
            let cells = before.cells(rough, own);
            let is_wave = (HELD..self.heads.bases[head].cells() as f64).contains(&cells);
            let (own, cells) = if is_wave { (own, cells) } else { (self.length.sqrt(), SHORTEST) };
            state.classes[amplitude].restart(own);
            state.classes[self.roughness[head]].restart(self.priors[head].roughness(own, cells));
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

    /// Scalars that programs read, at parameters of the learned ones.
    pub(super) fn scalars(&mut self, learned: &[f64]) -> &[f64] {
        self.set_learned(learned);
        &self.scalars
    }

    /// Takes over the sizes of equations at a state.
    pub(super) fn size(&mut self, state: &State) {
        self.set_learned(&state.learned);
        self.size_between(state);
        for (at, group) in self.groups.iter().enumerate().filter(|(_, group)| group.len() > 0) {
            let facts = group.facts(&self.heads, &state.theta);
            if state.blurred {
                let noise = &self.noise_of_columns[at];
                self.blurs[at] = facts.blurs(group.kernel.programs, group.schema, &self.scalars, noise);
            }
            let found = facts.sizes(group.kernel.programs, group.schema, &self.scalars, &self.bound.sizes[at]);
            for term in group.schema.terms {
                let rows = term.first..term.first + term.rows;
                let sizes = self.sizes[at][rows.clone()].iter_mut().zip(&found[rows]);
                sizes.for_each(|(size, found)| *size = found / term.weight.sqrt());
            }
        }
    }

    /// The triangle of all rows about a state, those of a condition left out, by its group and term, if one is given; nothing
    /// where the rest leaves unknowns open.
    pub(super) fn root(&mut self, state: &State, without: Option<(usize, usize)>) -> Result<Option<Triangle>, Fault> {
        self.size(state);
        self.left_out = without.map(|(group, term)| self.classes[group][term]);
        let rows = self.rows(state, Phase::Solve);
        self.left_out = None;
        let mut triangle = self.empty(state);
        triangle.add_all(rows?.0.walk());
        Ok(triangle.solve().map(|_| triangle))
    }

    /// A triangle of no rows.
    pub(super) fn empty(&self, state: &State) -> Triangle {
        Triangle::new(self.heads.len(), self.band(state), state.learned.len() + state.lines.len())
    }

    /// Numbers of a source's line, among those of all sources.
    pub(super) fn line(&self, head: usize) -> Range<usize> {
        let first = self.belief.numbers * self.amplitude[..head].iter().flatten().count();
        first..first + self.belief.numbers
    }

    /// Standard deviation of each of them before any measurement, for a source of such a roughness and amplitude.
    pub(super) fn line_deviation(&self, head: usize, (roughness, amplitude): (f64, f64)) -> f64 {
        self.belief.far * self.priors[head].beside(roughness, amplitude)
    }

    /// How rough and how large a source is believed to be; nothing of fields.
    pub(super) fn source_sizes(&self, state: &State, head: usize) -> Option<(f64, f64)> {
        let size = |class: usize| state.classes[class].size;
        self.amplitude[head].map(|amplitude| (size(self.roughness[head]), size(amplitude)))
    }

    /// The heads, and what they say at the points of all groups; of groups that are asked for between their places, also there.
    pub(super) fn into_facts(self, breakpoints: &[f64], theta: &[f64]) -> (Heads, Vec<Facts>, Vec<(usize, Facts)>) {
        let Self { bound, heads, groups, .. } = self;
        let schema = bound.problem.scene().schema;
        let all = groups.iter().enumerate().filter(|(_, group)| group.has_between());
        let between = all.map(|(at, group)| (at, group.facts(&heads, theta))).collect();
        let of = |(at, (own, kernel)): (usize, (Group, GroupKernel<f64>))| {
            if cells::moved(bound, at, breakpoints).is_none() && !own.has_between() {
                return own.facts(&heads, theta);
            }
            let columns = bound.filled_columns(at);
            Group::new(&schema.groups[at], kernel, &heads, &bound.coordinates[at], &columns).facts(&heads, theta)
        };
        let facts = groups.into_iter().zip(bound.problem.scene().double()).enumerate().map(of).collect();
        (heads, facts, between)
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
                let places: Vec<usize> = (0..group.asked(term)).filter(is_there).collect();
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
