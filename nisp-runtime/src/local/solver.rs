//! Gauss-Newton on sparse rows, with the prior of the sources majorised anew before every step.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use super::block::Block;
use super::draws::Draws;
use super::group::Group;
use super::heads::Heads;
use super::lattice::Lattice;
use super::meshes::{base, lattice, together};
use super::normal::{Factor, Normal};
use super::place::{Place, State};
use super::prior::Sparse;
use super::refuse::refuse_what_networks_do;
use super::surface::{Feet, Surface};
use super::{Local, LocalError, Progress, Stage};
use crate::engine::Learned;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::driver::{Flow, Status, Warning, WarningKind};
use crate::solve::fault::Fault;
use crate::solve::method::FAULTS_IN_A_ROW;
use crate::solve::state;

/// How far equations may be off, as a share of their natural size: about the error of splines on their lattice. Held to less,
/// they would take that error for a load.
const TOLERANCE: f64 = 1e-2;
/// Stiffness of coefficients, and of their differences, for those that rows hardly see: functions at the edge of the domain.
const RIDGE: f64 = 1e-6;
const STIFFNESS: f64 = 1e-3;
/// The same where nothing but values is wanted.
const NEGLIGIBLE: f64 = 1e-9;
/// Stiffness of differences in the first step, which only regresses the data: so much that noise cannot crease the state.
const ROUGH: f64 = 1000.0;
/// Noise that clouds are credited with at least, as a share of a cell: what splines cannot follow.
const LEAST_NOISE: f64 = 1e-2;
/// Steps before the penalty of small sources ends at their level.
const CONVEX_STEPS: u64 = 6;
/// How many of them are left to a state from a coarser lattice.
const WARM_STEPS: u64 = 3;
/// Largest change of a field in one step, in its natural sizes.
const FARTHEST: f64 = 5.0;
/// What error bars take, in steps.
const BARS: f64 = 2.0;
/// Root mean square of the rows, in tolerances, above which there is no solution to speak of.
const MOST_OFF: f64 = 5.0;
/// Random vectors for the trace of the influence matrix (Hutchinson).
const PROBES: usize = 2;
/// Stiffness of a parameter that is held.
const HELD: f64 = 1e30;
/// Relative change of the coefficients at which the answer counts as converged.
const CONVERGED: f64 = 2e-2;
/// Change of the logarithm of the probability, by rows, at which the answer counts as converged too if learned scalars rest:
/// a pressure that the data hardly determine may wander for long.
const SETTLED: f64 = 1e-3;
/// Change of the parameters of learned scalars that rest.
const RESTING: f64 = 1e-3;
/// The same as [`CONVERGED`] on a coarse lattice, whose solution is only where the fine one starts, and after how many steps at least.
const ROUGHLY: f64 = 0.1;
const COARSE_STEPS: u64 = 4;
/// Share of a step that is tried where the whole led to numbers that are not finite.
const RETREAT: f64 = 0.25;

/// A problem on its lattices.
pub(super) struct Solver<'a> {
    bound: &'a Bound,
    settings: &'a Local,
    pub(super) heads: Heads,
    groups: Vec<Group>,
    surfaces: Vec<Surface>,
    normal: Normal,
    scalars: Vec<f64>,
    /// Size of the base lattice's cells, the largest.
    cell: f64,
}

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Data and pointwise conditions.
    Regress,
    /// Everything, with a penalty of small sources that does not end at their level; learned scalars may be held.
    Convex { held: bool },
    /// Everything.
    Concave,
}

impl Phase {
    fn of(iteration: u64, coarse: bool) -> Self {
        match iteration {
            0 => Self::Regress,
            1..CONVEX_STEPS => Self::Convex { held: true },
            _ if coarse || iteration == CONVEX_STEPS => Self::Convex { held: false },
            _ => Self::Concave,
        }
    }
}

/// How a run ended.
pub(super) struct End {
    pub(super) state: State,
    pub(super) status: Status,
    pub(super) iterations: u64,
    pub(super) loss: f64,
    /// What the last step left open; empty if nothing.
    pub(super) warnings: Vec<Warning>,
    pub(super) factor: Option<Factor>,
    /// The state before the last step, which whoever goes on from it repeats.
    pub(super) checkpoint: state::State,
}

impl<'a> Solver<'a> {
    pub(super) fn new(bound: &'a Bound, settings: &'a Local, cells: usize) -> Result<Self, LocalError> {
        let schema = bound.problem.scene().schema;
        let inputs = schema.coordinates.len();
        refuse_what_networks_do(schema, settings)?;
        let base = base(bound, cells, settings.tests);
        let mut lattices: Vec<Lattice> =
            (0..schema.heads.len()).map(|head| lattice(bound, settings, &base, head)).collect();
        for (head, lattice) in lattices.iter_mut().enumerate() {
            let seen = schema.groups.iter().enumerate().filter(|(_, g)| g.jets.iter().any(|jet| jet.head == head));
            let points = seen.flat_map(|(at, _)| bound.coordinates[at].chunks_exact(inputs));
            let places: Vec<_> = points.map(|point| lattice.place(point)).collect();
            lattice.keep(places.into_iter(), if schema.heads[head].source { 2e-2 } else { 1e-4 });
        }
        let heads = Heads::new(bound, lattices);
        let kernels = bound.problem.scene().double();
        let mut groups = Vec::new();
        let mut surfaces = Vec::new();
        let cell = (0..inputs).map(|axis| base.spacing(axis)).fold(0.0, f64::max);
        for (at, (kernel, schema)) in kernels.into_iter().zip(schema.groups).enumerate() {
            let flat = &bound.coordinates[at];
            let points = (flat.as_slice(), bound.columns[at].as_slice());
            let measure = schema.terms.iter().find_map(|term| term.measure.as_ref());
            let weights = bound.weights(at, measure);
            let mut group = Group::new(schema, kernel, &heads, points, weights, (&base, settings.tests));
            for (term, size) in schema.terms.iter().zip(&bound.sizes[at]) {
                let tolerance = if term.within.is_some() { 1.0 } else { TOLERANCE };
                group.sigma[term.first..term.first + term.rows].fill(tolerance * size / term.weight.sqrt());
            }
            for (term, cloud) in schema.terms.iter().zip(&bound.clouds[at]) {
                if !matches!(term.kind, TermKind::Chamfer { .. }) {
                    continue;
                }
                let view = bound.view(at, term.name);
                surfaces.push(Surface::new(at, term, cloud, view, flat, inputs, cell));
            }
            groups.push(group);
        }
        let together = together(&heads, &base, settings.tests, bound);
        let normal = Normal::new(heads.len(), bound.learned.len(), &together).ok_or(LocalError::Memory)?;
        Ok(Self { bound, settings, heads, groups, surfaces, normal, scalars: bound.scalars.clone(), cell })
    }

    /// Where the solver starts: all heads at their offsets.
    pub(super) fn first(&self) -> Place {
        let state = State {
            theta: vec![0.0; self.heads.len()],
            learned: vec![0.0; self.bound.learned.len()],
            noise: self.cell,
            used: 0.0,
        };
        self.place(&state, 0)
    }

    /// Takes over learned scalars; returns their derivatives by their parameters.
    fn set_learned(&mut self, parameters: &[f64]) -> Vec<f64> {
        let set = |(learned, &parameter): (&Learned, &f64)| {
            let (value, slope) = learned.map.at(parameter);
            self.scalars[learned.slot] = value;
            slope
        };
        self.bound.learned.iter().zip(parameters).map(set).collect()
    }

    /// The state of another lattice on this one: its values at all points, by least squares.
    pub(super) fn taken_over(&mut self, other: &Heads, state: &State) -> Result<Place, LocalError> {
        let inputs = self.heads.lattices[0].dimensions();
        let learned = state.learned.len();
        self.normal.clear();
        let mut rows = Vec::new();
        for (group, points) in self.bound.problem.scene().schema.groups.iter().zip(&self.bound.coordinates) {
            for head in 0..self.heads.lattices.len() {
                for point in points.chunks_exact(inputs).filter(|_| group.jets.iter().any(|jet| jet.head == head)) {
                    rows.push(self.heads.difference(head, point, other, &state.theta, learned));
                }
            }
        }
        self.normal.add_all(&rows);
        for at in 0..self.heads.len() {
            self.normal.add_stiffness(at, NEGLIGIBLE);
        }
        (0..learned).for_each(|at| self.normal.add_learned(at, 1.0, 0.0));
        let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
        let (theta, _) = self.normal.step(&factor).ok_or(LocalError::Factorisation)?;
        // Who comes with a state needs no regression, and few steps before the penalty may end at its level.
        Ok(Place { skipped: CONVEX_STEPS - WARM_STEPS, ..self.place(&State { theta, ..state.clone() }, 0) })
    }

    /// Repeats steps until they change nothing, or steps or time are spent.
    pub(super) fn run(&mut self, from: Place, coarse: bool, stage: &mut Stage<'_>) -> Result<End, LocalError> {
        let Place { mut state, step: mut iteration, skipped, feet } = from;
        self.set_feet(feet);
        let mut good = self.place(&state, iteration);
        let mut loss = f64::INFINITY;
        let mut rows = 0;
        let mut status = Status::Budget;
        let mut factor = None;
        let mut faults = Vec::new();
        let mut longest = 0.0f64;
        while factor.is_none() || stage.before + iteration < stage.limits.iterations {
            let began = stage.start.elapsed().as_secs_f64();
            let budget = stage.limits.budget.map_or(f64::INFINITY, |budget| budget.as_secs_f64());
            let wanted = if coarse { longest } else { (1.0 + BARS) * longest };
            if began + wanted > budget && factor.is_some() {
                break;
            }
            let place = self.place(&state, iteration);
            let (next, found) = match self.step(&state, iteration + skipped, coarse) {
                Ok(found) => found,
                // The step that led here was too long: it is taken back, and a part of it is tried.
                Err(LocalError::Fault(fault)) if factor.is_some() => {
                    faults.push(fault);
                    self.set_feet(good.feet.clone());
                    if faults.len() >= FAULTS_IN_A_ROW as usize {
                        (state, status) = (good.state.clone(), Status::NotConverged);
                        break;
                    }
                    state = good.state.towards(&state, RETREAT);
                    continue;
                }
                Err(error) => return Err(error),
            };
            good = place;
            faults.clear();
            let (change, gain) = (self.change(&state, &next), found.gain);
            let before = std::mem::replace(&mut state, next);
            (loss, rows) = (found.loss, found.rows);
            factor = Some(found.factor);
            iteration += 1;
            let elapsed_s = stage.start.elapsed().as_secs_f64();
            longest = longest.max(elapsed_s - began);
            let (steps_before, lattice) = (stage.before, stage.lattice);
            let checkpoint = &|| good.save(steps_before, lattice);
            if (stage.monitor)(Progress { iteration: steps_before + iteration, elapsed_s, loss, checkpoint })
                == Flow::Stop
            {
                status = Status::Interrupted;
                break;
            }
            let (steps, small) = if coarse { (COARSE_STEPS, ROUGHLY) } else { (CONVEX_STEPS + 1, CONVERGED) };
            let resting = learned_change(&before, &state) < RESTING;
            let settled = !coarse && resting && gain.abs() < SETTLED * rows as f64;
            if iteration + skipped > steps && (change < small || settled) {
                status = Status::Converged;
                break;
            }
        }
        let mut warnings = self.doubts(loss, rows);
        if !warnings.is_empty() && status != Status::Interrupted {
            status = Status::NotConverged;
        }
        let fault = faults.pop().filter(|_| status == Status::NotConverged);
        warnings.extend(fault.map(|fault| Warning { message: fault.to_string(), kind: WarningKind::Fault(fault) }));
        let checkpoint = good.save(stage.before, stage.lattice);
        Ok(End { state, status, iterations: stage.before + iteration, loss, warnings, factor, checkpoint })
    }

    fn set_feet(&mut self, feet: Vec<Feet>) {
        self.surfaces.iter_mut().zip(feet).for_each(|(surface, feet)| surface.set_feet(feet));
    }

    /// A place of which every step is still to be taken.
    fn place(&self, state: &State, step: u64) -> Place {
        let feet = self.surfaces.iter().map(Surface::feet).collect();
        Place { state: state.clone(), step, skipped: 0, feet }
    }

    /// Where a saved run stood on this lattice.
    pub(super) fn restore(&self, saved: &state::State) -> Result<Place, Fault> {
        let mut place = self.first();
        place.restore(saved)?;
        place.skipped = if saved.counter("lattice")? > 0 { CONVEX_STEPS - WARM_STEPS } else { 0 };
        Ok(place)
    }

    /// What speaks against an answer: equations that do not hold, or a surface that is nowhere near the cloud.
    fn doubts(&self, loss: f64, rows: usize) -> Vec<Warning> {
        let mut doubts = Vec::new();
        let off = (2.0 * loss / rows.max(1) as f64).sqrt();
        if off > MOST_OFF {
            doubts.push(format!(
                "rows are off by {off:.0} times their tolerance: the steps did not reach a solution of the equations; give \
                 more --budget, and check the parameters"
            ));
        }
        let all: usize = self.surfaces.iter().map(Surface::len).sum();
        let lost = all - self.surfaces.iter().map(|surface| surface.misfits().count()).sum::<usize>();
        if 2 * lost > all {
            doubts.push(format!(
                "{lost} of the cloud's {all} points are not near the surface: is it a cloud of this body, in its frame?"
            ));
        }
        doubts.into_iter().map(|message| Warning { kind: WarningKind::Stagnation, message }).collect()
    }

    /// One step; also what it found on its way.
    fn step(&mut self, state: &State, iteration: u64, coarse: bool) -> Result<(State, Found), LocalError> {
        let regress = iteration == 0;
        self.find_feet(&state.theta, &state.learned);
        let noise = if regress { state.noise } else { self.noise(state.used) };
        let (loss, rows, probes) = self.assemble(state, noise, Phase::of(iteration, coarse))?;
        let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
        let used: f64 = probes.iter().map(|probe| factor.inner(probe)).sum::<f64>() / probes.len() as f64;
        let (step, shared) = self.normal.step(&factor).ok_or(LocalError::Factorisation)?;
        // The model holds no farther than a few natural sizes of the state; the first, of data alone, is exact.
        let fields = self.fields().flat_map(|range| &step[range]);
        let largest = fields.map(|x| x.abs()).fold(0.0, f64::max);
        let share = if regress { 1.0 } else { (FARTHEST / largest).min(1.0) };
        let mut next = State { noise, used, ..state.clone() };
        next.theta.iter_mut().zip(&step).for_each(|(x, s)| *x += share * s);
        next.learned.iter_mut().zip(&shared).for_each(|(x, s)| *x += share * s.clamp(-0.5, 0.5));
        let concave = Phase::of(iteration, coarse) == Phase::Concave;
        let before = loss + self.penalty(state, noise, concave);
        let after = self.loss(&next, noise) + self.penalty(&next, noise, concave);
        Ok((next, Found { loss, gain: before - after, rows, factor }))
    }

    /// Finds the feet of all clouds on the present surface.
    fn find_feet(&mut self, theta: &[f64], learned: &[f64]) {
        self.set_learned(learned);
        for surface in &mut self.surfaces {
            surface.find(&self.groups[surface.group], &self.heads, theta, &self.scalars);
        }
    }

    /// What priors add to the loss, but for a constant.
    fn penalty(&self, state: &State, noise: f64, concave: bool) -> f64 {
        let schema = self.bound.problem.scene().schema;
        let sources = schema.heads.iter().enumerate().filter(|(_, head)| head.source);
        let of_sources: f64 = sources
            .filter_map(|(head, _)| {
                let sparse = sparse(self.bound, self.settings, &self.heads, head, noise / self.cell)?;
                Some(sparse.value(&state.theta, concave))
            })
            .sum();
        of_sources + state.learned.iter().map(|x| 0.5e-2 * x * x).sum::<f64>()
    }

    /// Half the sum of squares of all rows.
    fn loss(&mut self, state: &State, noise: f64) -> f64 {
        self.find_feet(&state.theta, &state.learned);
        let groups = self.groups.iter().map(|group| group.loss(&self.heads, &state.theta, &self.scalars));
        groups.sum::<f64>() + self.surfaces.iter().map(|surface| surface.loss(noise)).sum::<f64>()
    }

    /// The normal equations about a state whose feet are found; also the loss, how many rows there are, and random
    /// combinations of the clouds' rows.
    fn assemble(&mut self, state: &State, noise: f64, phase: Phase) -> Result<(f64, usize, Vec<Vec<f64>>), LocalError> {
        let slopes = self.set_learned(&state.learned);
        let theta = &state.theta;
        let regress = phase == Phase::Regress;
        let mut probes = vec![vec![0.0; theta.len()]; PROBES];
        let mut random = StdRng::seed_from_u64(0);
        self.normal.clear();
        let (mut loss, mut rows) = (0.0, 0);
        for group in &self.groups {
            // The first step regresses data and pointwise conditions; equations come after.
            if regress && !group.weights.is_empty() {
                continue;
            }
            if !group.has_rows() {
                continue;
            }
            let evaluated = group.evaluate(&self.heads, theta, &self.scalars, true);
            let blocks = group.blocks(&self.heads, &evaluated, &slopes);
            for block in &blocks {
                loss += half_square(block, |at| {
                    Fault::residual(group.name(at), group.first_without_value(&evaluated, at))
                })?;
                rows += block.misfits.len();
            }
            self.normal.add_all(&blocks);
            if regress {
                continue;
            }
            for integral in group.integrals(&self.heads, &evaluated, &self.scalars) {
                loss += 0.5 * (integral.misfit / integral.sigma).powi(2);
                self.normal.add_dense(&integral.slopes, integral.misfit, integral.sigma);
            }
        }
        for surface in &self.surfaces {
            let group = &self.groups[surface.group];
            let blocks = surface.blocks(group, &self.heads, theta, &self.scalars, &slopes, noise);
            for block in &blocks {
                let term = || format!("{}.{}", group.schema.name, surface.term);
                half_square(block, |_| Fault::residual(term(), None))?;
                for probe in &mut probes {
                    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
                    block.kept().for_each(|(at, dof)| probe[dof as usize] += sign * block.slopes[at]);
                }
            }
            self.normal.add_all(&blocks);
            rows += surface.misfits().count();
            loss += surface.loss(noise);
        }
        for at in 0..theta.len() {
            self.normal.add_stiffness(at, RIDGE);
        }
        for (at, parameter) in state.learned.iter().enumerate() {
            // Parameters wait until the state is one of the equations' solutions. Their own scale is of the order of one.
            let stiffness = if matches!(phase, Phase::Regress | Phase::Convex { held: true }) { HELD } else { 1e-2 };
            self.normal.add_learned(at, stiffness, 1e-2 * parameter);
        }
        self.add_priors(theta, noise, regress, phase == Phase::Concave);
        Ok((loss, rows, probes))
    }

    /// Deviations of the coefficients, drawn from the posterior about a state. The patch is taken as it is: what the prior
    /// holds at zero stays there.
    pub(super) fn deviations(&mut self, state: &State) -> Option<Vec<Vec<f64>>> {
        self.find_feet(&state.theta, &state.learned);
        self.normal.draws = Some(Draws::new(state.theta.len(), state.learned.len()));
        let assembled = self.assemble(state, state.noise, Phase::Concave);
        let draws = self.normal.draws.take()?;
        assembled.ok()?;
        self.normal.factor()?.deviations(&draws)
    }

    /// Priors of sources, or of all heads' roughness while only data are regressed.
    fn add_priors(&mut self, theta: &[f64], noise: f64, regress: bool, concave: bool) {
        let schema = self.bound.problem.scene().schema;
        for (head, declared) in schema.heads.iter().enumerate() {
            let first = self.heads.first[head];
            let stiffness = if regress { ROUGH } else { STIFFNESS };
            for axis in (0..schema.coordinates.len()).filter(|_| regress || !declared.source) {
                for (a, b) in self.heads.lattices[head].neighbours(axis) {
                    let (i, j) = (first + a as usize, first + b as usize);
                    self.normal.add_difference([i, j], stiffness, theta[j] - theta[i]);
                }
            }
            if regress {
                continue;
            }
            let Some(sparse) = sparse(self.bound, self.settings, &self.heads, head, noise / self.cell) else {
                continue;
            };
            sparse.add(&mut self.normal, theta, concave);
        }
    }

    /// Ranges of the coefficients of fields.
    fn fields(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let heads = self.bound.problem.scene().schema.heads.iter().enumerate().filter(|(_, head)| !head.source);
        heads.map(|(at, _)| self.heads.first[at]..self.heads.first[at + 1])
    }

    /// Largest change of a field's coefficient or a learned parameter; sources may flicker at their edges for long.
    fn change(&self, before: &State, after: &State) -> f64 {
        let fields = self.fields().flat_map(|range| range.map(|at| (before.theta[at], after.theta[at])));
        fields.map(|(a, b)| (a - b).abs()).fold(learned_change(before, after), f64::max)
    }

    /// Standard deviation of the clouds about the surface, outliers counted for little.
    fn noise(&self, used: f64) -> f64 {
        let misfits: Vec<f64> = self.surfaces.iter().flat_map(Surface::misfits).collect();
        let mut magnitudes: Vec<f64> = misfits.iter().map(|m| m.abs()).collect();
        magnitudes.sort_by(f64::total_cmp);
        let middle = magnitudes.get(magnitudes.len() / 2).copied().unwrap_or(0.0) * 1.4826;
        let (mut sum, mut count) = (0.0, 0.0f64);
        for misfit in magnitudes.iter().filter(|m| **m <= 4.0 * middle) {
            sum += misfit * misfit;
            count += 1.0;
        }
        (sum / (count - used).max(0.2 * count).max(1.0)).sqrt().max(LEAST_NOISE * self.cell)
    }
}

/// The prior of a head where the clouds are off by `noise` cells; none of a field, or where nothing is known.
fn sparse<'a>(bound: &Bound, settings: &Local, heads: &'a Heads, head: usize, noise: f64) -> Option<Sparse<'a>> {
    let declared = &bound.problem.scene().schema.heads[head];
    let prior = settings.patches.filter(|_| declared.source)?;
    let sign = heads.bound[head].map_or(1.0, |(sign, _)| sign);
    let level = prior.level * bound.system.inward(&declared.unit) / heads.scale[head] * sign;
    Some(Sparse { heads, head, prior, level, finer: settings.finer, dimensions: settings.source_dimensions, noise })
}

/// Largest change of a learned scalar's parameter.
fn learned_change(before: &State, after: &State) -> f64 {
    before.learned.iter().zip(&after.learned).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The loss before a step, from so many rows, what the step gained, and the factorised matrix.
struct Found {
    loss: f64,
    gain: f64,
    rows: usize,
    factor: Factor,
}

/// Half the sum of a block's squares; `fault` says of a row that it is not finite.
fn half_square(block: &Block, fault: impl Fn(usize) -> Fault) -> Result<f64, LocalError> {
    match block.misfits.iter().position(|misfit| !misfit.is_finite()) {
        Some(row) => Err(LocalError::Fault(fault(row))),
        None => Ok(block.misfits.iter().map(|misfit| 0.5 * misfit * misfit).sum()),
    }
}
