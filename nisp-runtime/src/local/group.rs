//! The rows of a group: misfits of its terms, and their derivatives by the coefficients around each point.
//!
//! Where points come with weights, they stand for a piece of space, and equations are tested: a row is the weighted mean
//! of the residual, with a spline of low degree on the lattice as weight (Petrov-Galerkin). A kink of the solution inside
//! a cell then costs nothing, while a residual asked to vanish at every point would smooth it away.
//! Points without weights give a row each.

use rayon::prelude::*;

use super::heads::Heads;
use super::lattice::{Exponents, Lattice};
use super::rows::Evaluated;
use super::sites::Sites;
use super::testing::{Test, tests};
use crate::bounds::Across;
use crate::kernel::GroupKernel;
use crate::loss::Loss;
use crate::schema::{self, TermKind};

/// Points whose rows are linearised together.
pub(super) const BATCH: usize = 4096;

/// A group at its points.
pub(super) struct Group {
    pub(super) schema: &'static schema::Group,
    pub(super) kernel: GroupKernel<f64>,
    pub(super) sites: Sites,
    pub(super) operators: Vec<Vec<(Exponents, f64)>>,
    /// The jets of bounded heads.
    pub(super) towers: Vec<Across>,
    /// By row: what it is divided by.
    pub(super) sigma: Vec<f64>,
    /// By row: how noisy the points of an observation are beside each other; empty where they are alike.
    noisiness: Vec<Vec<f64>>,
    /// By row: derivatives of that divisor's logarithm by the learned scalars; empty if it goes with none.
    pub(super) growth: Vec<Vec<f64>>,
    /// By row: how its misfit counts, and what that is multiplied by (which its divisor has in it).
    pub(super) losses: Vec<(Loss, f64)>,
    /// Weights of the points in integrals, and in tests; empty if they are one.
    pub(super) weights: Vec<f64>,
    /// What weighted points are tested with, their points cell by cell; empty if each has rows of its own.
    pub(super) tests: Vec<Test>,
    /// How many of the tests, the last ones, are points that count a little, and that nobody judges.
    pub(super) slight: usize,
    /// Degree of the tests, and cells of the lattice that they are splines on.
    pub(super) degree: usize,
    pub(super) base: Vec<usize>,
    /// All places; points by the cells of the first head where they are too many to be linearised together.
    pub(super) order: Vec<u32>,
    /// By head, then by head at the points' partners if there are any, the highest derivative that the group reads; nothing of those
    /// that it does not read.
    pub(super) highest: Vec<Option<u8>>,
    /// By jet, where it is in this order.
    pub(super) slots: Vec<usize>,
}

/// Where a group is asked for: points and their partners, flat, known columns `[column][point]`, and what points weigh.
#[derive(Default)]
pub(super) struct Places<'a> {
    pub(super) points: &'a [f64],
    pub(super) partners: &'a [f64],
    pub(super) columns: &'a [Vec<f64>],
    pub(super) weights: Vec<f64>,
    /// By row, how noisy observations are there; nothing if all are alike.
    pub(super) noisiness: &'a [Vec<f64>],
}

impl Group {
    /// A group, with how its terms' misfits count, at its places. Where these have weights its equations are tested with splines of a
    /// lattice, of such a degree, if one is given; tests see no less than a share of the fullest one's weight.
    pub(super) fn new(
        (schema, terms): (&'static schema::Group, &[Loss]),
        kernel: GroupKernel<f64>,
        heads: &Heads,
        places: Places<'_>,
        tested: Option<(&Lattice, usize, f64)>,
    ) -> Self {
        let operator = |jet: &schema::Jet| {
            let term = |(index, coefficient): &(&[u8], f64)| {
                let mut exponents = Exponents::default();
                exponents[..index.len()].copy_from_slice(index);
                (exponents, *coefficient)
            };
            jet.operator.iter().map(term).collect()
        };
        let operators: Vec<Vec<(Exponents, f64)>> = schema.jets.iter().map(operator).collect();
        let count = heads.lattices.len();
        let mut highest = vec![None; if schema.paired { 2 * count } else { count }];
        let slot = |jet: &schema::Jet| jet.head + if schema.is_partner(jet) { count } else { 0 };
        let slots: Vec<usize> = schema.jets.iter().map(slot).collect();
        for (&slot, operator) in slots.iter().zip(&operators) {
            let order = operator.iter().flat_map(|(exponents, _)| exponents).copied().max();
            highest[slot] = highest[slot].max(order);
        }
        let sites = Sites::new(heads, &highest, [places.points, places.partners], places.columns);
        let (weights, noisiness) = (places.weights, places.noisiness.to_vec());
        let tested = tested.filter(|_| !weights.is_empty());
        let (degree, base) = tested.map_or((0, Vec::new()), |(base, degree, _)| (degree, base.cells.clone()));
        let of = |(base, degree, least)| tests(base, (degree, least), places.points, &weights);
        let mut tests = tested.map_or(Vec::new(), of);
        for test in &mut tests {
            test.points.sort_by(|&(p, _), &(q, _)| sites.cells(p).cmp(sites.cells(q)));
        }
        let places = if tests.is_empty() { sites.count } else { tests.len() };
        let mut order: Vec<u32> = (0..places as u32).collect();
        if tests.is_empty() && order.len() > BATCH {
            order.par_sort_by_cached_key(|&p| sites.cells(p).next());
        }
        let (sigma, growth) = (vec![1.0; schema.rows], vec![Vec::new(); schema.rows]);
        let mut losses = vec![(Loss::Square, 1.0); schema.rows];
        for (term, loss) in schema.terms.iter().zip(terms) {
            losses[term.first..term.first + term.rows].fill((*loss, term.weight));
        }
        let towers = Across::all(schema, |head| heads.limits[head].is_some()).unwrap_or_default();
        Self {
            schema,
            kernel,
            operators,
            towers,
            sigma,
            noisiness,
            growth,
            losses,
            sites,
            weights,
            tests,
            slight: 0,
            degree,
            base,
            order,
            highest,
            slots,
        }
    }

    /// The group with further rows: some of its weighted points, each asked for by itself.
    pub(super) fn with_slight(mut self, (base, flat): (&Lattice, &[f64]), points: &[u32]) -> Self {
        let inputs = base.dimensions();
        for &p in points {
            let place = base.place(&flat[p as usize * inputs..][..inputs]);
            let cell = base.around(&place, self.degree).next().unwrap_or_default();
            self.tests.push(Test { points: vec![(p, 1.0)], cell, weight: 0.0 });
        }
        self.slight = points.len();
        self.order.extend((self.order.len()..self.order.len() + points.len()).map(|place| place as u32));
        self
    }

    /// Lets each of these further rows count so much beside a full test.
    pub(super) fn weigh_slight(&mut self, weight: f64) {
        self.tests.iter_mut().rev().take(self.slight).for_each(|test| test.weight = weight);
    }

    /// Other points than the group's own, which has no partners, at which no measurement is known. Rows that are no observations read
    /// none.
    pub(super) fn sites_at(&self, heads: &Heads, flat: &[f64]) -> Sites {
        let none = vec![0.0; flat.len() / heads.lattices[0].inputs()];
        Sites::new(heads, &self.highest, [flat, &[]], &vec![none; self.schema.columns.len()])
    }

    /// Where the first row of a term that is asked for at every point is among those of [`Group::blocks`].
    pub(super) fn first_own(&self, term: &schema::Term) -> usize {
        self.own_rows().iter().filter(|&&row| row < term.first).count()
    }

    /// Rows whose terms are tested or asked for at every point: those of [`Group::blocks`].
    pub(super) fn own_rows(&self) -> Vec<usize> {
        let terms = self.schema.terms.iter();
        let own = terms.filter(|term| matches!(term.kind, TermKind::Residual | TermKind::Observation));
        own.flat_map(|term| term.first..term.first + term.rows).collect()
    }

    /// The points of every test with their shares; none if equations are asked of points.
    pub(super) fn means(&self) -> Vec<Vec<(u32, f64)>> {
        self.tests[..self.tests.len() - self.slight].iter().map(|test| test.points.clone()).collect()
    }

    /// How many places a row is asked for at: points, or tests.
    pub(super) fn places(&self) -> usize {
        if self.tests.is_empty() { self.sites.count } else { self.tests.len() }
    }

    /// A row at one of [`Group::places`].
    fn at_place(&self, evaluated: &Evaluated, row: usize, place: usize) -> f64 {
        self.tests.get(place).map_or_else(|| evaluated.row(row, place), |test| evaluated.mean(test, row))
    }

    /// What a row is divided by at one of [`Group::places`].
    pub(super) fn divisor(&self, row: usize, place: usize) -> f64 {
        let weight = self.tests.get(place).map_or(1.0, |test| test.weight);
        let noisiness = self.noisiness.get(row).and_then(|own| own.get(place)).copied().unwrap_or(1.0);
        self.sigma[row] * noisiness / weight
    }

    /// A row over its tolerance at one of [`Group::places`].
    pub(super) fn over_tolerance(&self, evaluated: &Evaluated, row: usize, place: usize) -> f64 {
        self.at_place(evaluated, row, place) / self.divisor(row, place)
    }

    /// A row where it is judged: at every point, or in the mean over every test.
    pub(super) fn asked(&self, evaluated: &Evaluated, row: usize) -> Vec<f64> {
        (0..self.places() - self.slight).map(|place| self.at_place(evaluated, row, place)).collect()
    }

    /// False where a cloud is all that the group is compared with.
    pub(super) fn has_rows(&self) -> bool {
        self.schema.terms.iter().any(|term| !matches!(term.kind, TermKind::Chamfer { .. }))
    }

    /// Name of the term of one of [`Group::own_rows`], as the user wrote it.
    pub(super) fn name(&self, at: usize) -> String {
        let row = self.own_rows()[at];
        let term = self.schema.terms.iter().find(|term| (term.first..term.first + term.rows).contains(&row));
        format!("{}.{}", self.schema.name, term.map_or("", |term| term.name))
    }

    /// The first point at which one of [`Group::own_rows`] is not finite.
    pub(super) fn first_without_value(&self, evaluated: &Evaluated, at: usize) -> Option<usize> {
        let row = self.own_rows()[at];
        (0..self.sites.count).find(|&p| !evaluated.row(row, p).is_finite())
    }

    /// Lets misfits count by other losses, by term.
    pub(super) fn set_losses(&mut self, losses: impl Iterator<Item = Loss>) {
        for (term, loss) in self.schema.terms.iter().zip(losses) {
            self.losses[term.first..term.first + term.rows].iter_mut().for_each(|own| own.0 = loss);
        }
    }

    /// Rows over their tolerances, in the order of [`Group::blocks`].
    pub(super) fn over_tolerances(&self, evaluated: &Evaluated) -> Vec<f64> {
        let rows = self.own_rows();
        let at = |place: usize| rows.iter().map(move |&row| self.over_tolerance(evaluated, row, place));
        (0..self.places()).flat_map(at).collect()
    }

    /// Roots of what squares of [`Group::over_tolerances`] are multiplied by where losses are robust.
    pub(super) fn root_weights(&self, over: &[f64]) -> Vec<f64> {
        let losses = self.own_rows().into_iter().map(|row| self.losses[row]).cycle();
        losses.zip(over).map(|((loss, times), over)| loss.weight(over / times.sqrt()).sqrt()).collect()
    }

    /// What a row over its tolerance costs.
    fn cost(&self, row: usize, over: f64) -> f64 {
        match self.losses[row] {
            (Loss::Square, _) => 0.5 * over.powi(2),
            (loss, times) => times * loss.rho(over / times.sqrt()),
        }
    }

    /// Heads that the group reads, first at its points and then at their partners: where they are in the order of `highest`, and which.
    pub(super) fn read(&self, heads: &Heads) -> impl Iterator<Item = (usize, usize)> + '_ {
        let count = heads.lattices.len();
        (0..self.highest.len()).filter(|&slot| self.highest[slot].is_some()).map(move |slot| (slot, slot % count))
    }

    /// What the rows over their tolerances cost, integrals among them.
    pub(super) fn loss(&self, heads: &Heads, theta: &[f64], scalars: &[f64]) -> f64 {
        if !self.has_rows() {
            return 0.0;
        }
        let evaluated = self.evaluate(heads, theta, scalars, false);
        let mut own = 0.0;
        for row in self.own_rows() {
            let over = (0..self.places()).map(|place| self.over_tolerance(&evaluated, row, place));
            own += over.map(|over| self.cost(row, over)).sum::<f64>();
        }
        let integrals = self.sums(&evaluated, scalars).into_iter();
        let integrals = integrals.map(|(row, misfit)| self.cost(row, misfit / self.sigma[row]));
        own + integrals.sum::<f64>()
    }
}
