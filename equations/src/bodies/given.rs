//! Parameters: what the user sets goes before what a sample says, and that before what is declared.

use std::path::Path;

use nisp::schema::{Origin, Scalar, Scene};
use nisp::units::{Declared, Number, Scale, Si};
use nisp::{BindError, Problem, SceneRef};

use crate::PrepareError;
use crate::entry::Size;
use crate::prepared::Assumed;
use crate::request::Request;

/// A number that a sample has a place for.
pub(super) struct Sampled {
    /// The parameter's name in the scene.
    pub(super) name: &'static str,
    /// Its table and key in the file.
    pub(super) key: &'static str,
    /// Its value in SI units, if the file has it.
    pub(super) value: Option<f64>,
}

/// All that is said of parameters.
pub(super) struct Given<'a> {
    pub(super) scene: SceneRef,
    pub(super) request: &'a Request,
    /// A sample's path and numbers.
    pub(super) sample: Option<(&'a Path, Vec<Sampled>)>,
    pub(super) sizes: &'static [Size],
}

/// Parameters in SI units that make no sense at zero or below, and what to do.
pub(super) type Positive = [(&'static str, &'static str)];

impl Given<'_> {
    /// A problem with all its parameters.
    ///
    /// # Errors
    /// A name that nothing has, a parameter that nobody gave, or one that must be positive and is not.
    pub(super) fn problem(&self, positive: &Positive) -> Result<Problem, PrepareError> {
        let schema = self.scene.schema;
        let scalars = || schema.scalars.iter().filter(|scalar| !scalar.name.is_empty());
        let names = || scalars().map(|scalar| scalar.name).chain(self.sizes.iter().map(|size| size.name));
        if let Some((name, _)) = self.request.parameters.iter().find(|(name, _)| names().all(|own| own != name)) {
            let have = names().collect::<Vec<_>>().join(", ");
            return Err(BindError::Unknown { what: "parameter", name: name.clone(), have }.into());
        }
        let mut problem = Problem::new(self.scene);
        for scalar in scalars() {
            let Some(value) = self.value(scalar.name)? else { continue };
            problem.set_parameter(scalar.name, scalar.unit.factor.back(value).as_declared())?;
        }
        for &(name, must) in positive {
            let Some(value) = self.known(name)?.filter(|value| *value <= Number::si(0.0)) else { continue };
            let (unit, factor) = unit(schema, name);
            return Err(PrepareError::Range { name, value: factor.back(value).as_declared(), unit, must });
        }
        Ok(problem)
    }

    /// What is taken as declared beside a cloud of the user's own.
    ///
    /// # Errors
    /// As [`Given::problem`].
    pub(super) fn assumed(&self) -> Result<Vec<Assumed>, PrepareError> {
        let mut assumed = Vec::new();
        if self.request.data.is_empty() && self.request.frame.is_none() {
            return Ok(assumed);
        }
        let schema = self.scene.schema;
        let is_given = |scalar: &&Scalar| !scalar.name.is_empty() && matches!(scalar.origin, Origin::Given(_));
        let names = schema.scalars.iter().filter(is_given).map(|scalar| scalar.name);
        for name in names.chain(self.sizes.iter().map(|size| size.name)) {
            if let (None, Some(value)) = (self.value(name)?, self.known(name)?) {
                let (unit, factor) = unit(schema, name);
                assumed.push(Assumed { name, value: factor.back(value).as_declared(), unit });
            }
        }
        Ok(assumed)
    }

    /// A parameter or size in SI units, by whatever says it; nothing if that is nobody.
    ///
    /// # Errors
    /// As [`Given::problem`].
    pub(super) fn of(&self, name: &'static str) -> Result<Option<f64>, PrepareError> {
        Ok(self.known(name)?.map(Number::as_si))
    }

    /// A parameter or size, by whatever says it.
    fn known(&self, name: &'static str) -> Result<Option<Number<Si>>, PrepareError> {
        let schema = self.scene.schema;
        let declared =
            schema.scalars.iter().find(|scalar| scalar.name == name).and_then(|scalar| match scalar.origin {
                Origin::Given(value) | Origin::Learned { start: value, .. } => value,
                _ => None,
            });
        let usual = self.sizes.iter().find(|size| size.name == name).map(|size| Number::si(size.usual));
        Ok(self.value(name)?.or(declared).or(usual))
    }

    /// A size in metres.
    pub(super) fn size(&self, name: &'static str) -> Result<f64, PrepareError> {
        let missing = PrepareError::Missing { name, unit: "m" };
        let size = self.of(name)?.ok_or(missing)?;
        if size > 0.0 {
            return Ok(size);
        }
        let must = "a size is above zero: give it with --set, in metres";
        Err(PrepareError::Range { name, value: size, unit: "m", must })
    }

    /// What the user says.
    pub(super) fn says(&self, name: &str) -> Option<Number<Si>> {
        let (_, factor) = unit(self.scene.schema, name);
        let said = self.request.parameters.iter().rev().find(|(own, _)| own == name);
        said.map(|(_, value)| factor.of(Number::declared(*value)))
    }

    /// What the user or the sample says; nothing where what is declared will do.
    fn value(&self, name: &'static str) -> Result<Option<Number<Si>>, PrepareError> {
        let schema = self.scene.schema;
        let (unit, _) = unit(schema, name);
        if let Some(value) = self.says(name) {
            return Ok(Some(value));
        }
        let scalar = schema.scalars.iter().find(|scalar| scalar.name == name);
        // What is to be learned is not to be read, unless nothing else says where to begin.
        if scalar.is_some_and(|scalar| matches!(scalar.origin, Origin::Learned { start: Some(_), .. })) {
            return Ok(None);
        }
        let number = self
            .sample
            .as_ref()
            .and_then(|(path, numbers)| Some((path, numbers.iter().find(|number| number.name == name)?)));
        match number {
            Some((_, Sampled { value: Some(value), .. })) => Ok(Some(Number::si(*value))),
            Some((path, Sampled { key, .. })) => {
                Err(PrepareError::SampleKey { path: path.to_path_buf(), key, name, unit })
            }
            None => match scalar.map(|scalar| &scalar.origin) {
                Some(Origin::Given(None) | Origin::Learned { start: None, .. }) => {
                    Err(PrepareError::Missing { name, unit })
                }
                _ => Ok(None),
            },
        }
    }
}

/// The unit of a parameter; of a size, metres.
fn unit(schema: &Scene, name: &str) -> (&'static str, Scale<Declared, Si>) {
    let scalar = schema.scalars.iter().find(|scalar| scalar.name == name);
    scalar.map_or(("m", Scale::new(1.0)), |scalar| (scalar.unit.text, scalar.unit.factor))
}
