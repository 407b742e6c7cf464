//! How well a contact was found, against a truth that no solver has seen.

use nisp_data::nearest::intersection_over_union;
use nisp_data::{DataError, Table};

use super::Contact;
use super::metrics::{areas, integral, patch_chamfer_mm2};
use crate::truth::{Headers, Truth};

/// The true contact at the truth's points.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueContact {
    /// Which points are touched.
    pub mask: Vec<bool>,
    /// The net force, in newtons.
    pub force: f64,
}

/// What was found of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactScore {
    /// Magnitude of the net force, the pressure's integral over the area at rest, in newtons.
    pub force: f64,
    /// How far that is from the truth, where it is known.
    pub against: Option<Against>,
}

/// A contact against its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Against {
    /// Error of the net force in newtons.
    pub force_error: f64,
    /// Intersection over union of the touched points.
    pub iou: f64,
    /// Squared distance of the deformed patches in square millimetres; nothing if one of them is empty.
    pub patch_chamfer_mm2: Option<f64>,
}

/// Values of a head at points, in its declared unit; nothing if there is no such head.
pub type Values<'a> = dyn Fn(&str, &[f64]) -> Option<Vec<f64>> + 'a;

impl TrueContact {
    /// Reads the column `contact` (0 or 1) beside the truth's pressure.
    ///
    /// # Errors
    /// No such column, or points without an area.
    pub fn read(table: &Table, truth: &Truth, pressure: &str, headers: Headers<'_>) -> Result<Self, DataError> {
        let mask: Vec<bool> = headers.read(table, "contact", "")?.iter().map(|contact| *contact > 0.5).collect();
        let dim = truth.points.len() / mask.len().max(1);
        let plane: Vec<[f64; 2]> = truth.points.chunks_exact(dim.max(2)).map(|point| [point[0], point[1]]).collect();
        let areas = areas(&plane)?;
        Ok(Self { mask, force: truth.of(pressure).map_or(0.0, |pressure| integral(pressure, &areas)) })
    }
}

impl Contact {
    /// Scores a pressure and displacements; nothing where the scene has no pressure. The truth is looked at where it
    /// is known; without displacements in `values` there is no distance between patches.
    pub fn score(&self, values: &Values<'_>, truth: Option<&Truth>) -> Option<ContactScore> {
        let name = self.pressure?;
        let force = integral(&values(name, &self.area.coords)?, self.area.weights.as_deref()?).abs();
        let known = truth.zip(self.truth.as_ref());
        let against = known.and_then(|(truth, contact)| self.against(values, force, truth, contact));
        Some(ContactScore { force, against })
    }

    fn against(&self, values: &Values<'_>, force: f64, truth: &Truth, contact: &TrueContact) -> Option<Against> {
        let mask = self.rule.mask(&values(self.pressure?, &truth.points)?);
        let touched = |fields: [Option<Vec<f64>>; 3], mask: &[bool]| -> Option<Vec<[f64; 3]>> {
            let [Some(x), Some(y), Some(z)] = fields else { return None };
            let moved = self.deformed(&truth.points, [&x, &y, &z]).into_iter().zip(mask);
            Some(moved.filter(|(_, touched)| **touched).map(|(point, _)| point).collect())
        };
        let found = touched(self.displacement.map(|name| values(name, &truth.points)), &mask);
        let real = touched(self.displacement.map(|name| truth.of(name).map(<[f64]>::to_vec)), &contact.mask);
        Some(Against {
            force_error: (force - contact.force).abs(),
            iou: intersection_over_union(&mask, &contact.mask).ok()?,
            patch_chamfer_mm2: found.zip(real).and_then(|(found, real)| patch_chamfer_mm2(&found, &real)),
        })
    }
}
