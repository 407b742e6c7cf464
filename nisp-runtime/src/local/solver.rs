//! A problem on its lattices: what is set up once, before any step.

use super::group::{Group, Places};
use super::heads::Heads;
use super::lattice::Lattice;
use super::meshes::{base, lattice, together};
use super::normal::Normal;
use super::place::{Place, State};
use super::refuse::refuse_what_networks_do;
use super::surface::{Feet, Surface};
use super::{Local, LocalError};
use crate::problem::Bound;
use crate::schema::{Term, TermKind};
use crate::solve::vector::root_mean_square;

/// Tests that see less than this share of the fullest one's weight are left out: they say next to nothing.
const LEAST_MASS: f64 = 0.05;

/// How far equations may be off, as a share of their natural size: about the error of splines on their lattice. Held to less,
/// they would take that error for a load.
const TOLERANCE: f64 = 1e-2;

/// How far they may be off as a share of what a source adds to them where it is not zero. Of a fifth a bubble was doubted whose modulus was known
/// to a third.
const OFF: f64 = 1.0 / 3.0;

/// Least stiffness against a step of every field's coefficient, in tolerances over natural sizes: what rows tell is hardly
/// slowed by it.
pub(super) const LEAST_DAMPING: f64 = 1e-3;

/// A problem on its lattices.
pub(super) struct Solver {
    pub(super) bound: Bound,
    pub(super) settings: Local,
    pub(super) heads: Heads,
    pub(super) groups: Vec<Group>,
    pub(super) surfaces: Vec<Surface>,
    /// By head, lines of functions from outermost ones inwards of which little is seen.
    pub(super) outer: Vec<Vec<Vec<u32>>>,
    pub(super) normal: Normal,
    pub(super) scalars: Vec<f64>,
    /// Size of the base lattice's cells, the largest.
    pub(super) cell: f64,
    /// By group and term, the size of which an equation may be off by [`TOLERANCE`].
    sizes: Vec<Vec<f64>>,
    /// Coefficients, learned parameters and [`State::across`] whose feet are found for good.
    settled: Option<(Vec<f64>, Vec<f64>, f64)>,
}

/// Share of the most that is seen of a field's function below which it goes on from others.
const FAINT: f64 = 1e-2;

impl Solver {
    pub(super) fn new(bound: &Bound, settings: &Local, cells: usize) -> Result<Self, LocalError> {
        let schema = bound.problem.scene().schema;
        let inputs = schema.coordinates.len();
        refuse_what_networks_do(schema, settings)?;
        let base = base(bound, &vec![cells as f64; inputs], settings.tests);
        let mut lattices: Vec<Lattice> =
            (0..schema.heads.len()).map(|head| lattice(bound, settings, &base, head)).collect();
        let mut outer = Vec::new();
        for (head, lattice) in lattices.iter_mut().enumerate() {
            let seen = schema.groups.iter().enumerate().filter(|(_, g)| g.jets.iter().any(|jet| jet.head == head));
            let points = seen.flat_map(|(at, _)| bound.coordinates[at].chunks_exact(inputs));
            let places: Vec<_> = points.map(|point| lattice.place(point)).collect();
            let is_source = schema.heads[head].source;
            let seen = lattice.keep(places.into_iter(), if is_source { 2e-2 } else { 1e-4 });
            let is_faint = |line: &Vec<u32>| !is_source && seen[line[0] as usize] < FAINT;
            outer.push(lattice.ends().filter(is_faint).collect());
        }
        let heads = Heads::new(bound, lattices);
        let kernels = bound.problem.scene().double();
        let mut groups = Vec::new();
        let mut surfaces = Vec::new();
        let cell = (0..inputs).map(|axis| base.spacing(axis)).fold(0.0, f64::max);
        for (at, (kernel, schema)) in kernels.into_iter().zip(schema.groups).enumerate() {
            let measure = schema.terms.iter().find_map(|term| term.measure.as_ref());
            let weights = bound.weights(at, measure);
            let points = &bound.coordinates[at];
            let places = Places { points, columns: &bound.columns[at], weights, ..Places::default() };
            let losses = &bound.losses[at];
            let group = Group::new((schema, losses), kernel, &heads, places, Some((&base, settings.tests, LEAST_MASS)));
            surfaces.extend(Surface::of(bound, at, cell));
            groups.push(group);
        }
        let together = together(&heads, &base, settings.tests, bound);
        let normal = Normal::new(heads.len(), bound.learned.len(), &together).ok_or(LocalError::Memory)?;
        let scalars = bound.scalars.clone();
        let learned = vec![0.0; bound.learned.len()];
        let (bound, settings) = (bound.clone(), *settings);
        let mut solver = Self {
            bound,
            settings,
            heads,
            outer,
            groups,
            surfaces,
            normal,
            scalars,
            cell,
            sizes: Vec::new(),
            settled: None,
        };
        solver.sizes = solver.sizes_beside_sources();
        solver.set_learned(&learned);
        Ok(solver)
    }

    /// By group and term, the size of which an equation may be off by [`TOLERANCE`]: its natural size, or a smaller one where that would be more than
    /// [`OFF`] of what the least of a source adds to the equation. Natural sizes are those of the steepest answer that is expected. For a membrane
    /// that is hardly bulged they are a hundred times the pressure that touches it, and an equation that is off by a share of them says nothing of it.
    fn sizes_beside_sources(&self) -> Vec<Vec<f64>> {
        let mut sizes = self.bound.sizes.clone();
        let Some(prior) = self.settings.patches else { return sizes };
        let heads = &self.bound.problem.scene().schema.heads;
        for (group, sizes) in self.groups.iter().zip(&mut sizes).filter(|(group, _)| !group.tests.is_empty()) {
            let jets = group.schema.jets;
            let is_source = |jet: &usize| heads[jets[*jet].head].source && jets[*jet].is_value();
            let least = |jet: usize| prior.least(&self.bound, jets[jet].head);
            let mut facts = group.facts(&self.heads, &vec![0.0; self.heads.len()]);
            // At its bound a source has hardly a slope.
            for jet in (0..jets.len()).filter(is_source) {
                facts.jets[jet * facts.stride..][..facts.stride].fill(least(jet));
            }
            let equations = group.schema.terms.iter().zip(sizes);
            let is_equation = |term: &Term| term.kind == TermKind::Residual && term.within.is_none();
            for (term, size) in equations.filter(|(term, _)| is_equation(term)) {
                let slopes = facts.slopes(group.kernel.programs, group.schema, term.first, &self.scalars);
                let sources = term.jets.iter().copied().filter(is_source);
                let added: f64 = sources.map(|jet| root_mean_square(slopes[jet].iter().copied()) * least(jet)).sum();
                if added > 0.0 {
                    *size = size.min(OFF / TOLERANCE * added);
                }
            }
        }
        sizes
    }

    /// Takes over the clouds and given parameters of a problem that is the same otherwise.
    pub(super) fn renew(&mut self, bound: Bound) {
        for surface in &mut self.surfaces {
            surface.renew(bound.cloud(surface.group, surface.term));
        }
        self.scalars.clone_from(&bound.scalars);
        self.bound = bound;
        self.settled = None;
    }

    /// Where the solver starts: all heads at their offsets.
    pub(super) fn first(&self) -> Place {
        let state = State {
            theta: vec![0.0; self.heads.len()],
            learned: vec![0.0; self.bound.learned.len()],
            noise: self.cell,
            across: 0.0,
            used: 0.0,
            damping: LEAST_DAMPING,
            lowest: f64::INFINITY,
            free: vec![true; self.heads.len()],
        };
        self.place(&state, 0)
    }

    /// A place of which every step is still to be taken.
    pub(super) fn place(&self, state: &State, step: u64) -> Place {
        let feet = self.surfaces.iter().map(Surface::feet).collect();
        Place { state: state.clone(), step, skipped: 0, feet }
    }

    /// Finds the feet of all clouds on the surface of a state.
    pub(super) fn find_feet(&mut self, state: &State) {
        let State { theta, learned, across, .. } = state;
        self.set_learned(learned);
        let is_known = |(own, parameters, share): &(Vec<f64>, Vec<f64>, f64)| {
            own == theta && parameters == learned && share == across
        };
        if self.settled.as_ref().is_some_and(is_known) {
            return;
        }
        let mut settled = true;
        for surface in &mut self.surfaces {
            surface.set_across(*across);
            settled &= surface.find(&self.groups[surface.group], &self.heads, theta, &self.scalars);
        }
        self.settled = settled.then(|| (theta.clone(), learned.clone(), *across));
    }

    pub(super) fn set_feet(&mut self, feet: Vec<Feet>) {
        self.settled = None;
        self.surfaces.iter_mut().zip(feet).for_each(|(surface, feet)| surface.set_feet(feet));
    }

    /// Takes over learned scalars, which tolerances of equations go with; returns their derivatives by their parameters.
    pub(super) fn set_learned(&mut self, parameters: &[f64]) -> Vec<f64> {
        let pairs = || self.bound.learned.iter().zip(parameters);
        let found: Vec<(f64, f64)> = pairs().map(|(learned, &parameter)| learned.map.at(parameter)).collect();
        for (learned, (value, _)) in self.bound.learned.iter().zip(&found) {
            self.scalars[learned.slot] = *value;
        }
        for (at, group) in self.groups.iter_mut().enumerate() {
            let terms = group.schema.terms.iter().zip(&self.sizes[at]).zip(&self.bound.powers[at]);
            for ((term, size), powers) in terms {
                let grown = pairs().zip(powers.iter());
                let (grown, growth): (Vec<f64>, Vec<f64>) =
                    grown.map(|((learned, &parameter), power)| learned.map.grown(parameter, *power)).unzip();
                let tolerance = if term.within.is_some() { 1.0 } else { TOLERANCE };
                let sigma = tolerance * size * grown.iter().product::<f64>() / term.weight.sqrt();
                for row in term.first..term.first + term.rows {
                    group.sigma[row] = sigma;
                    group.growth[row].clone_from(&growth);
                }
            }
        }
        found.into_iter().map(|(_, slope)| slope).collect()
    }
}
