//! From a [`Problem`] to an engine: checks, units, scales.

use thiserror::Error;

use super::frame::inward_points;
use super::powers::powers;
use super::scale::{Data, Scales, scales};
use super::{Binding, Frame, Problem, UnitSystem};
use crate::engine::{BoundGroup, Chamfer, Engine, Learned, LearnedMap, Powers, Scaling, is_exchangeable};
use crate::kernel::Precision;
use crate::loss::Loss;
use crate::network::{Architecture, Inputs, Layout};
use crate::schema::{self, Origin};
use crate::simd::Isa;

/// Why a problem cannot be solved as it is bound.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BindError {
    /// A name that the scene does not have.
    #[error("there is no {what} `{name}`; the scene has: {have}")]
    Unknown {
        /// What kind of name it should be.
        what: &'static str,
        /// The name given.
        name: String,
        /// The names there are.
        have: String,
    },
    /// A parameter that is not finite.
    #[error("parameter `{name}` is {value}; give a finite number in its declared unit")]
    Parameter {
        /// Its name.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A parameter outside of the range that it is declared with.
    #[error("parameter `{name}` is {value}{}, and must be {range}", unit_text(.unit))]
    Range {
        /// Its name.
        name: String,
        /// Its value, in its declared unit.
        value: f64,
        /// Its declared unit.
        unit: &'static str,
        /// What is allowed.
        range: String,
    },
    /// A parameter without a value.
    #[error("parameter `{name}` has no value; give it one{}", unit_hint(.unit))]
    MissingParameter {
        /// Its name.
        name: String,
        /// Its declared unit.
        unit: &'static str,
    },
    /// A group without points.
    #[error("group `{group}` has no points; bind at least one")]
    NoPoints {
        /// The group.
        group: &'static str,
    },
    /// Numbers that do not come in whole points, or as many as there are points.
    #[error("group `{group}`: {what} has {found} numbers where {expected} are expected")]
    Length {
        /// The group.
        group: &'static str,
        /// Which of its data.
        what: String,
        /// How many numbers were given.
        found: usize,
        /// How many are expected.
        expected: usize,
    },
    /// A number that is NaN or infinite.
    #[error("group `{group}`: {what} is not finite at point {point}; remove the point or mend its data")]
    NotFinite {
        /// The group.
        group: &'static str,
        /// Which of its data.
        what: String,
        /// The point, counted from 0.
        point: usize,
    },
    /// Columns without a single value.
    #[error("group `{group}`: nothing is measured in any of its columns; bind a value at least")]
    NothingMeasured {
        /// The group.
        group: &'static str,
    },
    /// A Chamfer term without a cloud.
    #[error("group `{group}`: term `{term}` has no cloud; bind the points that its surface passes through")]
    NoCloud {
        /// The group.
        group: &'static str,
        /// The term.
        term: &'static str,
    },
    /// A scene whose kernels have not been compiled in the precision asked for.
    #[error(
        "scene `{scene}` is compiled in double precision only; call `.in_single_precision()` before `.problem()`, or solve \
         in f64"
    )]
    NotCompiled {
        /// The scene.
        scene: &'static str,
    },
    /// A network that cannot be.
    #[error(
        "a network of {layers} layers of {width} units cannot be built; both must be at least 1, and their product not huge"
    )]
    Architecture {
        /// Layers asked for.
        layers: usize,
        /// Units asked for.
        width: usize,
    },
}

fn unit_text(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// That a value in SI units lies in the range that its scalar is declared with.
pub(super) fn within(scalar: &schema::Scalar, value: f64) -> Result<(), BindError> {
    if scalar.lower.is_none_or(|low| value >= low) && scalar.upper.is_none_or(|high| value <= high) {
        return Ok(());
    }
    let (name, unit, range) = (scalar.name.into(), scalar.unit.text, range(scalar));
    Err(BindError::Range { name, value: value / scalar.unit.factor, unit, range })
}

/// The range of a scalar in its declared unit, in words.
fn range(scalar: &schema::Scalar) -> String {
    let unit = unit_text(scalar.unit.text);
    let shown = |bound: f64| {
        // Rounding of the unit's factor should not show.
        let outward = bound / scalar.unit.factor;
        if outward.abs() < f64::MIN_POSITIVE { "0".to_string() } else { format!("{}", (outward * 1e12).round() / 1e12) }
    };
    let is_left_out = |bound: f64| bound != 0.0 && bound.abs() < f64::MIN_POSITIVE;
    let low = scalar.lower.map(|low| {
        let word = if is_left_out(low) { "above" } else { "at least" };
        format!("{word} {}{unit}", shown(low))
    });
    let high = scalar.upper.map(|high| {
        let word = if is_left_out(high) { "below" } else { "at most" };
        format!("{word} {}{unit}", shown(high))
    });
    low.into_iter().chain(high).collect::<Vec<_>>().join(" and ")
}

fn unit_hint(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}

impl BindError {
    pub(super) fn unknown<'a>(what: &'static str, name: &str, have: impl Iterator<Item = &'a str>) -> Self {
        Self::Unknown { what, name: name.into(), have: have.collect::<Vec<_>>().join(", ") }
    }
}

/// Threshold of the loss of observations that are to be robust, in standard deviations of their noise: values are left out
/// from some five of them on.
const ROBUST: Loss = Loss::Welsch(2.0);

/// A problem in the engine's units, whatever the precision.
#[derive(Clone, Debug)]
pub(crate) struct Bound {
    pub(crate) problem: Problem,
    pub(crate) system: UnitSystem,
    pub(crate) scaling: Scaling,
    pub(crate) scalars: Vec<f64>,
    pub(crate) learned: Vec<Learned>,
    /// Natural size of each term's rows, by group and term.
    pub(crate) sizes: Vec<Vec<f64>>,
    /// How misfits count, by group and term.
    pub(crate) losses: Vec<Vec<Loss>>,
    /// Powers of the learned scalars that the sizes of equations go with, by group and term; see [`super::powers`].
    pub(crate) powers: Vec<Vec<Powers>>,
    /// Coordinates by group, in the engine's units, point by point.
    pub(crate) coordinates: Vec<Vec<f64>>,
    /// Coordinates of their partners, in the same way; empty unless the group is paired.
    pub(crate) partners: Vec<Vec<f64>>,
    /// Columns by group, in the engine's units; NaN where a quantity was not measured.
    pub(crate) columns: Vec<Vec<Vec<f64>>>,
    /// Clouds by group and term, in the engine's units, flat and point by point; empty for other terms.
    pub(crate) clouds: Vec<Vec<Vec<f64>>>,
}

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
    fn loss(&self, term: &schema::Term) -> Loss {
        let is_square = term.kind == schema::TermKind::Observation && term.loss == Loss::Square;
        if self.robust && is_square { ROBUST } else { term.loss }
    }

    /// That all parameters that need a value have one, and a finite one.
    fn check_parameters(&self) -> Result<(), BindError> {
        for (scalar, value) in self.scene.schema.scalars.iter().zip(&self.scalars) {
            let own = matches!(scalar.origin, Origin::HeadScale(_) | Origin::SideScale { .. });
            match value {
                None if !own => {
                    return Err(BindError::MissingParameter { name: scalar.name.into(), unit: scalar.unit.text });
                }
                Some(value) if !value.is_finite() => {
                    return Err(BindError::Parameter { name: scalar.name.into(), value: *value });
                }
                Some(value) => within(scalar, *value)?,
                None => {}
            }
        }
        Ok(())
    }

    /// What is bound to each group, checked for lengths and finite numbers.
    pub(super) fn bindings(&self) -> Result<Vec<&Binding>, BindError> {
        let inputs = self.scene.schema.coordinates.len();
        let mut bindings = Vec::new();
        for (group, binding) in self.scene.schema.groups.iter().zip(&self.groups) {
            let Some(binding) = binding.as_ref().filter(|b| !b.points.coordinates.is_empty()) else {
                return Err(BindError::NoPoints { group: group.name });
            };
            let numbers = binding.points.coordinates.len();
            let length = |what: String, found: usize, expected: usize| {
                if found == expected {
                    Ok(())
                } else {
                    Err(BindError::Length { group: group.name, what, found, expected })
                }
            };
            length("the point list".into(), numbers, numbers.div_ceil(inputs) * inputs)?;
            let points = numbers / inputs;
            length("the list of columns".into(), binding.columns.len(), group.columns.len())?;
            for (column, values) in group.columns.iter().zip(&binding.columns) {
                length(format!("column `{}`", column.name), values.len(), points)?;
                let may_lack = group.may_lack(column.name) && values.iter().all(|x| x.is_finite() || x.is_nan());
                if !may_lack {
                    finite(group.name, || format!("column `{}`", column.name), values, 1)?;
                }
            }
            if !group.columns.is_empty() && binding.columns.iter().flatten().all(|x| x.is_nan()) {
                return Err(BindError::NothingMeasured { group: group.name });
            }
            if !binding.points.weights.is_empty() {
                length("the weights".into(), binding.points.weights.len(), points)?;
            }
            finite(group.name, || "a coordinate".into(), &binding.points.coordinates, inputs)?;
            length(
                "the list of partners".into(),
                binding.points.partners.len(),
                if group.paired { numbers } else { 0 },
            )?;
            finite(group.name, || "a partner's coordinate".into(), &binding.points.partners, inputs)?;
            for term in group.terms.iter().filter(|term| matches!(term.kind, schema::TermKind::Chamfer { .. })) {
                let cloud = binding.cloud(term.name).filter(|cloud| !cloud.is_empty());
                let cloud = cloud.ok_or(BindError::NoCloud { group: group.name, term: term.name })?;
                let what = || format!("the cloud of `{}`", term.name);
                length(what(), cloud.len(), cloud.len().next_multiple_of(term.rows))?;
                finite(group.name, what, cloud, term.rows)?;
            }
            bindings.push(binding);
        }
        Ok(bindings)
    }
}

fn finite(group: &'static str, what: impl Fn() -> String, values: &[f64], per_point: usize) -> Result<(), BindError> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(BindError::NotFinite { group, what: what(), point: at / per_point }),
    }
}

fn inward_clouds(group: &schema::Group, system: &UnitSystem, binding: &Binding) -> Vec<Vec<f64>> {
    let cloud = |term: &schema::Term| match term.kind {
        schema::TermKind::Chamfer { .. } => binding.cloud(term.name).unwrap_or_default(),
        _ => &[],
    };
    let inward = |term| cloud(term).iter().map(|x| x * system.inward(&term.unit)).collect();
    group.terms.iter().map(inward).collect()
}

fn inward_columns(group: &schema::Group, system: &UnitSystem, binding: &Binding) -> Vec<Vec<f64>> {
    let columns = group.columns.iter().zip(&binding.columns);
    columns.map(|(column, values)| values.iter().map(|x| x * system.inward(&column.unit)).collect()).collect()
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
            let map = match (lower.map(|x| x / size), upper.map(|x| x / size)) {
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

/// Solvers keep some vectors of this length, of a gigabyte each.
const MOST_PARAMETERS: usize = 100_000_000;

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
            bindings.iter().zip(schema.groups).map(|(b, group)| inward_clouds(group, &system, b)).collect();
        let mut scalars: Vec<f64> = schema
            .scalars
            .iter()
            .zip(&problem.scalars)
            .map(|(scalar, value)| value.map_or(1.0, |value| value / system.size(&scalar.unit)))
            .collect();
        let data = Data { coordinates: &coordinates, partners: &partners, columns: &columns, clouds: &clouds };
        let Scales { scaling, mut sizes } = scales(&problem.scene, &mut scalars, data, inputs);
        for (sizes, group) in sizes.iter_mut().zip(schema.groups) {
            for (size, term) in sizes.iter_mut().zip(group.terms) {
                *size = term.within.map_or(*size, |within| within / system.size(&term.unit));
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
        })
    }

    /// Columns of a group with zeros where nothing was measured: rows that read those do not count.
    pub(crate) fn filled_columns(&self, group: usize) -> Vec<Vec<f64>> {
        let filled = |column: &Vec<f64>| column.iter().map(|&x| if x.is_nan() { 0.0 } else { x }).collect();
        self.columns[group].iter().map(filled).collect()
    }

    /// Where an observation was measured, point by point; nothing if everywhere.
    pub(crate) fn lacking(&self, group: usize, term: &schema::Term) -> Option<Vec<bool>> {
        let columns = || term.columns.iter().map(|&column| &self.columns[group][column]);
        let points = columns().next()?.len();
        let measured: Vec<bool> = (0..points).map(|p| columns().all(|column| !column[p].is_nan())).collect();
        measured.contains(&false).then_some(measured)
    }

    /// Those of the values at the points of a group at which an observation was measured.
    pub(crate) fn measured<T: Clone>(&self, group: usize, term: &schema::Term, values: &[T]) -> Vec<T> {
        let Some(measured) = self.lacking(group, term) else { return values.to_vec() };
        let each = values.len() / measured.len().max(1);
        let kept = values.chunks_exact(each.max(1)).zip(&measured).filter(|(_, is_there)| **is_there);
        kept.flat_map(|(value, _)| value.to_vec()).collect()
    }

    /// The engine of this problem in precision `E`, for a network of the given shape.
    pub(crate) fn engine<E: Precision>(&self, architecture: Architecture) -> Result<Engine<E>, BindError> {
        self.engine_on(Isa::detect(), architecture)
    }

    /// The same with vectors of `isa`.
    pub(crate) fn engine_on<E: Precision>(&self, isa: Isa, architecture: Architecture) -> Result<Engine<E>, BindError> {
        if architecture.width == 0 || architecture.layers == 0 {
            return Err(BindError::Architecture { layers: architecture.layers, width: architecture.width });
        }
        let scene = self.problem.scene;
        let inputs = scene.schema.coordinates.len();
        let lanes = isa.lanes::<E>();
        let layout = Layout::new(architecture, inputs, scene.schema.heads.len(), self.learned.len(), lanes);
        if layout.len > MOST_PARAMETERS {
            return Err(BindError::Architecture { layers: architecture.layers, width: architecture.width });
        }
        let mut groups = Vec::new();
        let kernels = E::kernels(&scene).ok_or(BindError::NotCompiled { scene: scene.schema.name })?;
        for (at, kernel) in kernels.into_iter().enumerate().take(scene.schema.groups.len()) {
            let schema = &scene.schema.groups[at];
            let mut group = BoundGroup::new(
                kernel,
                schema,
                &self.scaling,
                &self.coordinates[at],
                &self.partners[at],
                &self.filled_columns(at),
            );
            let bound = self.sizes[at].iter().zip(&self.losses[at]).zip(&self.powers[at]).zip(&self.clouds[at]);
            for (term, (((size, loss), powers), cloud)) in group.terms.iter_mut().zip(bound) {
                (term.size, term.loss) = (*size, *loss);
                term.within = term.schema.within.map(|_| size / term.schema.weight.sqrt());
                term.powers = powers.clone();
                if term.schema.kind == schema::TermKind::Integral && !self.raw_weights(at).is_empty() {
                    let weights = self.weights(at, term.schema.measure.as_ref());
                    term.point_weights = Some(weights.into_iter().map(E::from_f64).collect());
                }
                if let Some(measured) = self.lacking(at, term.schema) {
                    let weights = measured.into_iter().map(|is_there| if is_there { E::ONE } else { E::ZERO });
                    term.point_weights = Some(weights.collect());
                }
                term.chamfer = Chamfer::new(cloud, (term.schema, term.loss), group.points);
            }
            groups.push(group);
        }
        let scalars = self.scalars.iter().map(|&x| E::from_f64(x)).collect();
        Ok(Engine::new(isa, layout, groups, scalars, self.learned.clone()))
    }

    /// A problem with the points and columns of this one, in the same units and with the same scales: nothing where they are
    /// others.
    pub(crate) fn renewed(&self, problem: &Problem) -> Result<Option<Self>, BindError> {
        problem.check_parameters()?;
        let problem = problem.clone().with_beliefs();
        let (schema, bindings) = (problem.scene.schema, problem.bindings()?);
        let is_same = |(new, old): (&&Binding, &Option<Binding>)| {
            old.as_ref().is_some_and(|old| new.points == old.points && new.columns == old.columns)
        };
        if !bindings.iter().zip(&self.problem.groups).all(is_same) {
            return Ok(None);
        }
        let clouds = bindings.iter().zip(schema.groups);
        let clouds = clouds.map(|(binding, group)| inward_clouds(group, &self.system, binding)).collect();
        let given = schema.scalars.iter().zip(&problem.scalars).zip(&self.scalars);
        let scalars =
            given.map(|((scalar, value), own)| value.map_or(*own, |value| value / self.system.size(&scalar.unit)));
        Ok(Some(Self { clouds, scalars: scalars.collect(), problem, ..self.clone() }))
    }

    /// The cloud of a term, in the engine's units, flat.
    pub(crate) fn cloud(&self, group: usize, term: &str) -> &[f64] {
        let terms = self.problem.scene.schema.groups[group].terms.iter();
        terms.zip(&self.clouds[group]).find(|(own, _)| own.name == term).map_or(&[], |(_, cloud)| cloud)
    }

    /// The same with a share of the points of groups that may exchange theirs, evenly picked.
    pub(crate) fn thinned(&self, share: f64) -> Self {
        let mut thinned = self.clone();
        let schema = self.problem.scene.schema;
        let inputs = schema.coordinates.len();
        for at in (0..schema.groups.len()).filter(|&at| is_exchangeable(&schema.groups[at])) {
            let all = self.coordinates[at].len() / inputs;
            let count = ((share * all as f64).round() as usize).clamp(1, all);
            let chosen: Vec<usize> = (0..count).map(|i| i * all / count).collect();
            let points = chosen.iter().flat_map(|&p| &self.coordinates[at][p * inputs..(p + 1) * inputs]);
            thinned.coordinates[at] = points.copied().collect();
            for (own, all) in thinned.columns[at].iter_mut().zip(&self.columns[at]) {
                *own = chosen.iter().map(|&p| all[p]).collect();
            }
        }
        thinned
    }

    /// The same with the points of an interval of the only coordinate alone, for scenes without clouds, pairs and weights.
    pub(crate) fn between(&self, low: f64, high: f64) -> Self {
        let mut part = self.clone();
        for (at, all) in self.coordinates.iter().enumerate() {
            let is_inside: Vec<bool> = all.iter().map(|x| (low..=high).contains(x)).collect();
            let inside = |values: &[f64]| -> Vec<f64> {
                values.iter().zip(&is_inside).filter(|(_, inside)| **inside).map(|(x, _)| *x).collect()
            };
            part.coordinates[at] = inside(all);
            part.columns[at] = self.columns[at].iter().map(|column| inside(column)).collect();
        }
        part
    }

    fn raw_weights(&self, group: usize) -> &[f64] {
        self.problem.groups[group].as_ref().map_or(&[], |binding| &binding.points.weights)
    }

    /// Weights of a group's points in the engine's units, if `measure` is theirs; empty if they have none.
    pub(crate) fn weights(&self, group: usize, measure: Option<&schema::Unit>) -> Vec<f64> {
        let inward = measure.map_or(1.0, |measure| self.system.inward(measure));
        self.raw_weights(group).iter().map(|weight| weight * inward).collect()
    }

    /// Natural size of a head: what its transformation multiplies with, or the network's scale.
    pub(crate) fn head_scale(&self, head: usize) -> f64 {
        let mut slots = self.problem.scene.schema.scalars.iter();
        let slot = slots.position(|scalar| scalar.origin == Origin::HeadScale(head));
        slot.map_or(self.scaling.scale[head], |slot| self.scalars[slot])
    }

    /// The direction along which a term's cloud is off, if it is known.
    pub(crate) fn view(&self, group: usize, term: &str) -> Option<[f64; 3]> {
        self.problem.groups[group].as_ref()?.view(term)
    }

    /// How far a term's cloud may be off over whole regions, if that is known.
    pub(crate) fn tolerance(&self, group: usize, term: &schema::Term) -> Option<f64> {
        let declared = self.problem.groups[group].as_ref()?.tolerance(term.name)?;
        Some(declared * self.system.inward(&term.unit))
    }

    /// Points given in declared units, in the engine's.
    pub(crate) fn inward(&self, points: &[f64]) -> Vec<f64> {
        inward_points(self.problem.scene.schema, &self.system, points)
    }

    /// The scene with its units, scales and scalars, without points and data.
    pub(crate) fn frame(&self) -> Frame {
        Frame {
            scene: self.problem.scene,
            system: self.system,
            scaling: self.scaling.clone(),
            scalars: self.scalars.clone(),
            learned: self.learned.clone(),
        }
    }
}
