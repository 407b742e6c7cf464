//! A scene bound to parameters, points and data; numbers cross this boundary in their declared units.

mod alone;
mod beliefs;
mod bind;
mod bound;
mod checks;
mod engine;
mod error;
mod evaluate;
mod frame;
mod place;
mod powers;
mod probe;
mod rest;
mod rests;
mod scale;
mod system;
mod uniform;
mod units;

pub(crate) use bound::{Bound, EngineTolerance, LEFT_OUT};
pub use error::BindError;
pub(crate) use frame::Frame;
pub(crate) use place::place;
pub use rest::Rest;
pub use system::UnitSystem;

use crate::kernel::SceneRef;
use crate::units::{Number, Si};

/// A scene with what has been bound to it so far.
#[derive(Clone, Debug)]
pub struct Problem {
    scene: SceneRef,
    /// Given values of scalars.
    scalars: Vec<Option<Number<Si>>>,
    groups: Vec<Option<Binding>>,
    /// Whether observations with a squared loss get a robust one.
    robust: bool,
    /// Given parameters that may be off together: their slots, and by how much each is off at one standard deviation.
    pub(crate) uncertain: Vec<Vec<(usize, Number<Si>)>>,
    /// Things that the data rest on, such as a calibration, and how well each stands.
    pub(crate) doubts: Vec<Doubt>,
}

/// Something that data rest on, and how well it stands: a verdict fails where the value is above its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// What they rest on, in a word.
    pub of: &'static str,
    /// What was found, without unit.
    pub value: f64,
    /// Up to where it stands.
    pub limit: f64,
    /// What is wrong where it does not, and what to do.
    pub message: String,
}

/// Points of a group, flat and point by point, with what belongs to each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Coordinates in their declared units, point by point.
    pub coordinates: Vec<f64>,
    /// What each point stands for, in products of the coordinates' declared units; empty for one each. Integral terms sum
    /// with them, and local functions test equations with them.
    pub weights: Vec<f64>,
    /// Coordinates of every point's partner, for periodic pairs; empty otherwise.
    pub partners: Vec<f64>,
}

impl From<Vec<f64>> for Points {
    fn from(coordinates: Vec<f64>) -> Self {
        Self { coordinates, ..Self::default() }
    }
}

impl From<&[f64]> for Points {
    fn from(coordinates: &[f64]) -> Self {
        coordinates.to_vec().into()
    }
}

/// How far a cloud may be off over whole regions. Lengths are in the declared unit of its term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Standard deviation of a point.
    pub size: f64,
    /// Length over which the cloud is off by about the same.
    pub region: f64,
    /// Share of a point's variance that all points of a region have in common, from 0 to 1; the rest is each point's own.
    pub common: f64,
}

/// What is bound to a group.
#[derive(Clone, Debug, Default)]
struct Binding {
    points: Points,
    /// In declared units.
    columns: Vec<Vec<f64>>,
    /// Clouds of Chamfer terms: term, points flat.
    clouds: Vec<(String, Vec<f64>)>,
    /// Directions from which clouds were seen: term, direction.
    views: Vec<(String, [f64; 3])>,
    /// How far clouds may be off over whole regions: term, tolerance in the term's declared unit.
    tolerances: Vec<(String, Tolerance)>,
}

impl Binding {
    /// The cloud of a term, as bound last.
    fn cloud(&self, term: &str) -> Option<&[f64]> {
        self.clouds.iter().rev().find(|(name, _)| name == term).map(|(_, cloud)| &cloud[..])
    }

    /// True if another binding has the same points, columns and views: all but clouds.
    fn is_alike(&self, other: &Self) -> bool {
        let Self { points, columns, clouds: _, views, tolerances } = self;
        (points, columns, views, tolerances) == (&other.points, &other.columns, &other.views, &other.tolerances)
    }

    /// The direction from which a term's cloud was seen, as bound last.
    fn view(&self, term: &str) -> Option<[f64; 3]> {
        self.views.iter().rev().find(|(name, _)| name == term).map(|(_, view)| *view)
    }

    /// How far a term's cloud may be off over whole regions, as bound last.
    fn tolerance(&self, term: &str) -> Option<Tolerance> {
        self.tolerances.iter().rev().find(|(name, _)| name == term).map(|(_, tolerance)| *tolerance)
    }
}

/// Every `count`-th number from `index`: one entry of what is given point by point. For emitted builders.
#[doc(hidden)]
#[must_use]
pub fn component(values: &[f64], index: usize, count: usize) -> Vec<f64> {
    values.iter().skip(index).step_by(count).copied().collect()
}

impl Problem {
    /// A scene with nothing bound but its declared defaults.
    pub fn new(scene: SceneRef) -> Self {
        use crate::schema::Origin;
        let scalars = scene.schema.scalars.iter().map(|scalar| match scalar.origin {
            Origin::Given(value) => value,
            Origin::Learned { start, .. } => start,
            Origin::Literal(value) => Some(value),
            Origin::HeadScale(_) | Origin::SideScale { .. } => None,
        });
        let groups = vec![None; scene.schema.groups.len()];
        Self { scene, scalars: scalars.collect(), groups, robust: false, uncertain: Vec::new(), doubts: Vec::new() }
    }

    /// The scene.
    pub fn scene(&self) -> SceneRef {
        self.scene
    }

    /// The same bindings to the same scene, compiled otherwise; for emitted builders.
    #[doc(hidden)]
    #[must_use]
    pub fn with_scene(self, scene: SceneRef) -> Self {
        Self { scene, ..self }
    }

    /// What is bound to a group: its points and its columns, in declared units. Nothing for an unknown group or one that is
    /// not bound.
    pub fn group(&self, name: &str) -> Option<(&Points, &[Vec<f64>])> {
        let at = self.scene.schema.groups.iter().position(|own| own.name == name)?;
        self.groups[at].as_ref().map(|binding| (&binding.points, binding.columns.as_slice()))
    }

    /// The cloud that is bound to a Chamfer term, flat and point by point, in the term's unit; nothing where there is none.
    pub fn cloud(&self, group: &str, term: &str) -> Option<&[f64]> {
        let at = self.scene.schema.groups.iter().position(|own| own.name == group)?;
        self.groups[at].as_ref()?.cloud(term)
    }

    /// Gives a parameter its value, in its declared unit.
    ///
    /// # Errors
    /// No such parameter, or a value that is not finite or outside of its declared range.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), BindError> {
        let scalars = self.scene.schema.scalars;
        let at = self.slot(name)?;
        if !value.is_finite() {
            return Err(BindError::Parameter { name: name.into(), value });
        }
        let value = scalars[at].unit.factor.of(Number::declared(value));
        error::within(&scalars[at], value)?;
        self.scalars[at] = Some(value);
        Ok(())
    }

    /// The slot of a parameter.
    fn slot(&self, name: &str) -> Result<usize, BindError> {
        let scalars = self.scene.schema.scalars;
        scalars.iter().position(|s| !name.is_empty() && s.name == name).ok_or_else(|| {
            BindError::unknown("parameter", name, scalars.iter().map(|s| s.name).filter(|n| !n.is_empty()))
        })
    }

    /// Says that given parameters may be off together: by so much at one standard deviation, in declared units and with signs. What is
    /// said in several calls is independent. Error bars of local functions that find contacts on surfaces hold it; other carriers do not.
    ///
    /// # Errors
    /// No such parameter, or a number that is not finite.
    pub fn set_uncertain(&mut self, amounts: &[(&str, f64)]) -> Result<(), BindError> {
        let amount = |&(name, value): &(&str, f64)| {
            let slot = self.slot(name)?;
            let inward = self.scene.schema.scalars[slot].unit.factor.of(Number::declared(value));
            if value.is_finite() { Ok((slot, inward)) } else { Err(BindError::Parameter { name: name.into(), value }) }
        };
        let own = amounts.iter().map(amount).collect::<Result<_, _>>()?;
        self.uncertain.push(own);
        Ok(())
    }

    /// Says how well something stands that the data rest on; the verdict's check `given` takes it over.
    pub fn add_doubt(&mut self, doubt: Doubt) {
        self.doubts.push(doubt);
    }

    /// Whether measured values that are far off count for little: observations whose loss is the square get Welsch's instead,
    /// with its threshold in units of the noise that values without outliers show.
    pub fn set_robust(&mut self, robust: bool) {
        self.robust = robust;
    }

    /// Gives a group its points and columns (in the schema's order), each in its declared unit. NaN in a column that an
    /// observation compares with alone says that nothing was measured there.
    ///
    /// # Errors
    /// No such group.
    pub fn set_group(&mut self, name: &str, points: Points, columns: Vec<Vec<f64>>) -> Result<(), BindError> {
        let groups = self.scene.schema.groups;
        let at = groups
            .iter()
            .position(|g| g.name == name)
            .ok_or_else(|| BindError::unknown("group", name, groups.iter().map(|g| g.name)))?;
        self.groups[at] = Some(Binding { points, columns, ..Binding::default() });
        Ok(())
    }

    /// Gives a Chamfer term its cloud, flat and point by point, in the term's unit, instead of one that it had.
    ///
    /// # Errors
    /// No such group, or nothing bound to it yet.
    pub fn set_cloud(&mut self, group: &str, term: &str, cloud: Vec<f64>) -> Result<(), BindError> {
        let clouds = &mut self.binding(group)?.clouds;
        clouds.retain(|(own, _)| own != term);
        clouds.push((term.into(), cloud));
        Ok(())
    }

    /// What is bound to a group.
    fn binding(&mut self, group: &str) -> Result<&mut Binding, BindError> {
        let groups = self.scene.schema.groups;
        let binding = groups.iter().position(|g| g.name == group).and_then(|at| self.groups[at].as_mut());
        binding.ok_or_else(|| BindError::unknown("group", group, groups.iter().map(|g| g.name)))
    }

    /// Says from which direction a cloud was seen. A camera's points are off along it most; local functions find out from the cloud by
    /// how much less they are off in other directions. Without a direction points are off alike in all.
    ///
    /// # Errors
    /// No such group, or nothing bound to it yet.
    pub fn set_view(&mut self, group: &str, term: &str, direction: [f64; 3]) -> Result<(), BindError> {
        let views = &mut self.binding(group)?.views;
        views.retain(|(own, _)| own != term);
        views.push((term.into(), direction));
        Ok(())
    }

    /// Says how far a cloud may be off over whole regions: what a calibration of its sensor leaves. Local functions let all points of
    /// a region count as one, with this standard deviation; the verdict takes it for no pattern.
    ///
    /// # Errors
    /// No such group, or nothing bound to it yet.
    pub fn set_tolerance(&mut self, group: &str, term: &str, tolerance: Tolerance) -> Result<(), BindError> {
        let tolerances = &mut self.binding(group)?.tolerances;
        tolerances.retain(|(own, _)| own != term);
        tolerances.push((term.into(), tolerance));
        Ok(())
    }

    /// As [`Problem::set_parameter`], for emitted builders, which know the names; a value that is not finite is
    /// reported when the problem is solved.
    #[doc(hidden)]
    #[must_use]
    pub fn with_parameters(mut self, values: &[(&str, f64)]) -> Self {
        for &(name, value) in values {
            if let Some(at) = self.scene.schema.scalars.iter().position(|s| s.name == name) {
                self.scalars[at] = Some(self.scene.schema.scalars[at].unit.factor.of(Number::declared(value)));
            }
        }
        self
    }

    /// As [`Problem::set_group`], for emitted builders.
    #[doc(hidden)]
    #[must_use]
    pub fn with_group(mut self, at: usize, points: Points, columns: Vec<Vec<f64>>) -> Self {
        self.groups[at] = Some(Binding { points, columns, ..Binding::default() });
        self
    }

    /// As [`Problem::set_cloud`], for emitted builders.
    #[doc(hidden)]
    #[must_use]
    pub fn with_cloud(mut self, at: usize, term: &str, cloud: Vec<f64>) -> Self {
        if let Some(binding) = &mut self.groups[at] {
            binding.clouds.push((term.into(), cloud));
        }
        self
    }
}
