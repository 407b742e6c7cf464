//! From a [`Problem`] in declared units to one in the engine's.

use super::alone::without_alone;
use super::bound::Bound;
use super::error::BindError;
use super::frame::inward_points;
use super::powers::powers;
use super::probe::Data;
use super::scale::{Scales, scales};
use super::{Binding, Problem, UnitSystem};
use crate::engine::{Learned, LearnedMap};
use crate::loss::Loss;
use crate::network::Inputs;
use crate::schema::{self, Origin};
use crate::units::Number;

/// Threshold of the loss of observations that are to be robust, in standard deviations of their noise: values are left out
/// from some five of them on.
const ROBUST: Loss = Loss::Welsch(2.0);

impl Problem {
    /// Checks what is bound and expresses it in the engine's units.
    pub(crate) fn bound(&self, inputs: Inputs) -> Result<Bound, BindError> {
        self.check_parameters()?;
        let problem = self.clone().with_beliefs();
        let system = problem.system(&problem.bindings()?);
        let bound = Bound::in_units(problem, system, inputs)?;
        match bound.wider_system() {
            Some(system) => Bound::in_units(bound.problem, system, inputs),
            None => Ok(bound),
        }
    }

    /// How the misfits of a term count.
    pub(crate) fn loss(&self, term: &schema::Term) -> Loss {
        let is_square = term.kind == schema::TermKind::Observation && term.loss == Loss::Square;
        if self.robust && is_square { ROBUST } else { term.loss }
    }
}

fn inward_clouds(
    (scene, group): (&schema::Scene, &schema::Group),
    system: &UnitSystem,
    binding: &Binding,
) -> Vec<Vec<f64>> {
    let cloud = |term: &schema::Term| match term.kind {
        schema::TermKind::Chamfer { .. } => {
            let cloud = inward(system, &term.unit, binding.cloud(term.name).unwrap_or_default());
            without_alone(cloud, scene, term)
        }
        _ => Vec::new(),
    };
    group.terms.iter().map(cloud).collect()
}

fn inward_columns(group: &schema::Group, system: &UnitSystem, binding: &Binding) -> Vec<Vec<f64>> {
    let columns = group.columns.iter().zip(&binding.columns);
    columns.map(|(column, values)| inward(system, &column.unit, values)).collect()
}

/// Numbers in their declared unit, in the engine's.
fn inward(system: &UnitSystem, unit: &schema::Unit, numbers: &[f64]) -> Vec<f64> {
    let inward = system.inward(unit);
    numbers.iter().map(|&x| inward.of(Number::declared(x)).as_engine()).collect()
}

/// How learned scalars follow from their parameters.
fn learned(schema: &schema::Scene, system: &UnitSystem, scalars: &[f64]) -> Vec<Learned> {
    let slots = schema.scalars.iter().enumerate();
    let learned = slots.filter_map(|(slot, scalar)| match scalar.origin {
        Origin::Learned { .. } => Some((slot, scalar, scalar.lower, scalar.upper)),
        _ => None,
    });
    learned
        .map(|(slot, scalar, lower, upper)| {
            let size = system.size(&scalar.unit);
            let start = scalars[slot];
            let inward = |bound| size.back(bound).as_engine();
            let map = match (lower.map(inward), upper.map(inward)) {
                (Some(lower), Some(upper)) if lower < start && start < upper => {
                    LearnedMap::Between(lower, upper, ((start - lower) / (upper - start)).ln())
                }
                _ if start > 0.0 => LearnedMap::Positive(start),
                _ => LearnedMap::Linear(start, start.abs().max(1.0)),
            };
            Learned { slot, map }
        })
        .collect()
}

impl Bound {
    /// The problem in this system of units.
    fn in_units(problem: Problem, system: UnitSystem, inputs: Inputs) -> Result<Self, BindError> {
        let schema = problem.scene.schema;
        let bindings = problem.bindings()?;
        let coordinates: Vec<Vec<f64>> =
            bindings.iter().map(|b| inward_points(schema, &system, &b.points.coordinates)).collect();
        let partners: Vec<Vec<f64>> =
            bindings.iter().map(|b| inward_points(schema, &system, &b.points.partners)).collect();
        let columns: Vec<Vec<Vec<f64>>> =
            bindings.iter().zip(schema.groups).map(|(b, group)| inward_columns(group, &system, b)).collect();
        let clouds: Vec<Vec<Vec<f64>>> =
            bindings.iter().zip(schema.groups).map(|(b, group)| inward_clouds((schema, group), &system, b)).collect();
        let mut scalars: Vec<f64> = schema
            .scalars
            .iter()
            .zip(&problem.scalars)
            .map(|(scalar, value)| value.map_or(1.0, |value| system.size(&scalar.unit).back(value).as_engine()))
            .collect();
        let data = Data { coordinates: &coordinates, partners: &partners, columns: &columns, clouds: &clouds };
        let Scales { scaling, mut sizes } = scales(&problem.scene, &mut scalars, data, inputs);
        for (sizes, group) in sizes.iter_mut().zip(schema.groups) {
            for (size, term) in sizes.iter_mut().zip(group.terms) {
                *size = term.within.map_or(*size, |within| system.size(&term.unit).back(within).as_engine());
            }
        }
        let learned = learned(schema, &system, &scalars);
        let powers = powers(&problem.scene, &scalars, data, inputs, &learned);
        let losses = schema.groups.iter().map(|group| group.terms.iter().map(|term| problem.loss(term)).collect());
        let losses = losses.collect();
        Ok(Self {
            problem,
            system,
            scaling,
            scalars,
            learned,
            sizes,
            losses,
            powers,
            coordinates,
            partners,
            columns,
            clouds,
            noisiness: schema.groups.iter().map(|group| vec![Vec::new(); group.rows]).collect(),
        })
    }

    /// A problem that differs from this one in clouds and given parameters only, in the same units and with the same scales; nothing
    /// where more is different.
    pub(crate) fn renewed(&self, problem: &Problem) -> Result<Option<Self>, BindError> {
        problem.check_parameters()?;
        let problem = problem.clone().with_beliefs();
        let (schema, bindings) = (problem.scene.schema, problem.bindings()?);
        let is_same = |(new, old): (&&Binding, &Option<Binding>)| old.as_ref().is_some_and(|old| new.is_alike(old));
        let is_counted_alike = problem.robust == self.problem.robust;
        if !is_counted_alike
            || problem.uncertain != self.problem.uncertain
            || !bindings.iter().zip(&self.problem.groups).all(is_same)
        {
            return Ok(None);
        }
        let clouds = bindings.iter().zip(schema.groups);
        let clouds = clouds.map(|(binding, group)| inward_clouds((schema, group), &self.system, binding)).collect();
        let given = schema.scalars.iter().zip(&problem.scalars).zip(&self.scalars);
        let scalars = given.map(|((scalar, value), own)| {
            value.map_or(*own, |value| self.system.size(&scalar.unit).back(value).as_engine())
        });
        Ok(Some(Self { clouds, scalars: scalars.collect(), problem, ..self.clone() }))
    }
}
