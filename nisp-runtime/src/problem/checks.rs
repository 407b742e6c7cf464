//! What is bound is checked before anything is computed with it.

use super::error::{BindError, within};
use super::{Binding, Problem};
use crate::schema::{self, Origin};

impl Problem {
    /// That all parameters that need a value have one, and a finite one.
    pub(super) fn check_parameters(&self) -> Result<(), BindError> {
        for (scalar, value) in self.scene.schema.scalars.iter().zip(&self.scalars) {
            let own = matches!(scalar.origin, Origin::HeadScale(_) | Origin::SideScale { .. });
            match value {
                None if !own => {
                    return Err(BindError::MissingParameter { name: scalar.name.into(), unit: scalar.unit.text });
                }
                Some(value) if !value.as_si().is_finite() => {
                    return Err(BindError::Parameter { name: scalar.name.into(), value: value.as_si() });
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
