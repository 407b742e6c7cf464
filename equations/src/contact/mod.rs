//! Contact of a body: its shape, where the pressure acts on it, and how well that was found.
//!
//! [`Contact`] says where the pressure acts, [`Face`] integrates it, [`metrics`] and [`ContactScore`] judge it; a
//! [`Calibration`] says what a sensor's free frames told of it.

mod calibration;
mod deviation;
mod face;
pub mod metrics;
mod patches;
mod pose;
mod score;

pub(crate) use calibration::{CALIBRATES, SHIFT, TURN, WIDEN};
pub use calibration::{Calibration, LEARNED, Learned, Membrane, Quality, References};
pub use deviation::Deviation;
pub(crate) use deviation::Off;
pub use face::{Face, Load};
pub(crate) use face::{length, minus};
pub use metrics::Rule;
pub use patches::Patch;
pub use pose::Pose;
pub use score::{Against, ContactScore, TrueContact, Values};

use nisp::nearest::Nearest;
use nisp::schema::Scene;
use nisp::units::{Declared, Number, Scale, Si};
use nisp_data::{DataError, Table};

use crate::truth::{Headers, Truth};

/// Share of a body's size by which a truth's points may be beside it, having been rounded.
const SLACK: f64 = 0.01;

/// A body that was seen as a cloud, and the pressure that acts on it. Coordinates are in metres.
pub struct Contact {
    /// The fields that move a point along x, y and z.
    pub displacement: [&'static str; 3],
    /// From the displacements' unit to metres.
    pub unit: Scale<Declared, Si>,
    /// The source that presses, in pascals; nothing where the scene says that nothing does.
    pub pressure: Option<&'static str>,
    /// How a touched point is told.
    pub rule: Rule,
    /// How the pressure acts.
    pub load: Load,
    /// Where it can act.
    pub face: Face,
    /// What was seen of it: points in metres.
    pub cloud: Vec<[f64; 3]>,
    /// How near to a point of the surface one of the cloud's must be to show it, in metres.
    pub near: f64,
    /// The surface, for pictures.
    pub surface: Surface,
    /// From where a picture shows it: degrees from x towards y, and degrees above the plane of both.
    pub eye: [f64; 2],
    /// The true contact at the truth's points, for scoring only.
    pub truth: Option<TrueContact>,
    /// A classical answer to compare with, where one has an answer.
    pub rival: Option<ContactRival>,
}

/// Pressures in pascals at points in the scene's coordinates.
pub type Pressure = dyn Fn(&[f64]) -> Vec<f64>;

/// A classical way to a contact's pressure.
pub struct ContactRival {
    /// Its name in tables.
    pub name: &'static str,
    /// Its answer.
    pub pressure: Box<Pressure>,
}

/// A body's surface at rest.
pub struct Surface {
    /// Places in the scene's coordinates, one after the other.
    pub points: Vec<f64>,
    /// Corners of its triangles.
    pub triangles: Vec<[usize; 3]>,
    /// Whether the pressure can act at a point.
    pub loaded: Vec<bool>,
}

impl Contact {
    /// Where points at rest have moved to, in metres, given their displacements along x, y and z in the declared unit.
    /// A plane body rests at z = 0.
    pub fn deformed(&self, points: &[f64], displacement: [&[f64]; 3]) -> Vec<[f64; 3]> {
        let place = |(at, rest): (usize, &[f64])| {
            let moved = |axis: usize| self.unit.of(Number::declared(displacement[axis][at])).as_si();
            let along = |axis: usize| rest.get(axis).copied().unwrap_or(0.0) + moved(axis);
            std::array::from_fn(along)
        };
        points.chunks_exact(self.face.dim.max(1)).enumerate().map(place).collect()
    }

    /// Share of the surface's points, where an answer has moved them, that the cloud shows.
    pub fn seen(&self, values: &Values<'_>) -> Option<f64> {
        let [Some(x), Some(y), Some(z)] = self.displacement.map(|name| values(name, &self.surface.points)) else {
            return None;
        };
        let surface = self.deformed(&self.surface.points, [&x, &y, &z]);
        let tree = Nearest::of(&self.cloud)?;
        let is_near = |point: &&[f64; 3]| tree.one(point).distance < self.near;
        Some(surface.iter().filter(is_near).count() as f64 / surface.len().max(1) as f64)
    }
}

impl Contact {
    /// Checks that a truth's points are points of the body: they may be in another unit than their headers say.
    fn require_within(&self, table: &Table, scene: &Scene, truth: &Truth) -> Result<(), DataError> {
        let dim = scene.coordinates.len();
        let range = |points: &[f64], axis: usize| {
            let values = points.iter().skip(axis).step_by(dim);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
        };
        for (axis, coordinate) in scene.coordinates.iter().enumerate() {
            let ((from, to), (low, high)) = (range(&truth.points, axis), range(&self.surface.points, axis));
            let slack = SLACK * (high - low);
            if from < low - slack || to > high + slack {
                let (name, unit) = (coordinate.name, coordinate.unit.text);
                let what = format!(
                    "`{name}` runs from {from} to {to} {unit}, the body from {low:.4} to {high:.4}: is it in another unit? \
                     write the unit into its header, as in `{name} [mm]`"
                );
                return Err(DataError::File { path: table.path().into(), what });
            }
        }
        Ok(())
    }

    /// The true contact, where a truth is given and the scene has a pressure.
    pub(crate) fn true_contact(
        &self,
        scene: &Scene,
        truth: Option<(&Table, &Truth)>,
        headers: Headers<'_>,
    ) -> Result<Option<TrueContact>, DataError> {
        let Some((table, truth)) = truth else { return Ok(None) };
        self.require_within(table, scene, truth)?;
        let Some(pressure) = self.pressure else { return Ok(None) };
        for name in self.displacement.into_iter().chain([pressure]) {
            if truth.of(name).is_none() {
                let unit = scene.heads.iter().find(|head| head.name == name).map_or("", |head| head.unit.text);
                headers.read(table, name, unit)?;
            }
        }
        TrueContact::read(table, truth, headers, self, pressure).map(Some)
    }
}
