//! Calibration of a bubble from frames in which nothing touches it.

use std::num::NonZero;

use nisp::nearest::Nearest;
use nisp::units::Number;
use nisp_data::{Cloud, DataError};

use super::given::Given;
use crate::PrepareError;
use crate::contact::{
    CALIBRATES, Calibration, Contact, Deviation, LEARNED, Learned, Membrane, Off, Pose, Quality, References, SHIFT,
    TURN, Values, WIDEN, length, minus,
};
use crate::entry::Entry;

/// Size of the regions over which a theory's error is about the same, for a rim of these semi-axes: a twelfth of the longer axis.
pub(super) fn region(a: f64, b: f64) -> f64 {
    2.0 * a.max(b) / 12.0
}

/// Regions with fewer than this share of the points that an even spread gives them hold strays.
const STRAYS: f64 = 0.1;
/// A median of sizes over this is the standard deviation of normal numbers.
const MEDIAN: f64 = 0.6745;

impl Entry {
    /// The scenes that calibrate, one for each law of the material.
    pub fn calibrates(&self) -> Vec<&'static str> {
        let names = self.scenes.iter().map(|scene| scene.schema.name);
        names.filter(|name| name.starts_with(CALIBRATES)).collect()
    }
}

impl References {
    /// Keeps all points that were seen and what was known before, and thins what is solved: a theory is off by about the same
    /// over whole regions, so that points nearer to each other say nothing new of it.
    pub(super) fn new(cloud: &mut Cloud, points: Vec<usize>, given: &Given<'_>) -> Result<Self, PrepareError> {
        let (a, b) = (given.size("a")?, given.size("b")?);
        let known = Membrane {
            a_m: Some(a),
            b_m: Some(b),
            thickness_m: given.of("t")?,
            young: None,
            poisson: given.of("nu")?,
            stretch: None,
            pressure: given.of("p")?,
        };
        let regions = std::f64::consts::PI * a * b / region(a, b).powi(2);
        let least = (STRAYS * cloud.points.len() as f64 / regions) as usize;
        let thinned = cloud.one_of_each_cube(region(a, b), least);
        let cloud = std::mem::replace(cloud, thinned);
        Ok(Self { cloud, points, given: known })
    }

    /// What a solution says of the sensor: `values` are those of its heads.
    ///
    /// # Errors
    /// A scene that does not move its surface, or that learned no pose.
    pub fn calibration(
        &self,
        entry: &Entry,
        scene: &str,
        contact: &Contact,
        values: &Values<'_>,
        learned: Learned<'_>,
    ) -> Result<Calibration, PrepareError> {
        let missing = |what: &str| PrepareError::Data(DataError::Invalid(format!("the scene `{scene}` has no {what}")));
        let of = |name: &str| (learned.value)(name).ok_or_else(|| missing(&format!("learned `{name}`")));
        let all = |names: [&str; 3]| -> Result<[f64; 3], PrepareError> {
            let [x, y, z] = names.map(of);
            Ok([x?, y?, z?])
        };
        let widen = [of(WIDEN[0])?, of(WIDEN[1])?];
        let pose = Pose {
            turn_rad: all(TURN)?,
            shift_m: all(SHIFT)?.map(|shift| contact.unit.of(Number::declared(shift)).as_si()),
        };
        let known = |value: Option<f64>, what| value.ok_or_else(|| missing(what));
        let (a, b) = (known(self.given.a_m, "semi-axis a")?, known(self.given.b_m, "semi-axis b")?);
        let pressure = known(self.given.pressure, "gauge pressure")?;
        let membrane = Membrane {
            a_m: Some(widen[0] * a),
            b_m: Some(widen[1] * b),
            young: Some(of("E")?),
            stretch: Some(of("stretch")?),
            pressure: None,
            ..self.given
        };
        let offs = self.offs(contact, values, widen, &pose).ok_or_else(|| missing("surface"))??;
        let deviation = Deviation::fit(&offs, [widen[0] * a, widen[1] * b])?;
        let left = |off: &Off| {
            let taken = deviation.at(off.place);
            off.distance - taken.iter().zip(off.normal).map(|(x, n)| x * n).sum::<f64>()
        };
        let left: Vec<f64> = offs.iter().map(left).collect();
        let found = Quality {
            frames: self.points.len(),
            points: self.cloud.points.len(),
            pressure,
            misfit_m: spread(offs.iter().map(|off| off.distance)),
            camera: self.between_neighbours(&offs, &left),
            noise_m: spread(left.into_iter()),
            young_deviation: learned.young_deviation,
        };
        let held = format!(
            "free frames tell E * t over the pressure, not both: the gauge pressure was held at {pressure} Pa and the thickness \
             at the given one; a pressure that is off by one per cent makes E, and every force found with it, off by one per cent"
        );
        let widths: [f64; LEARNED.len()] =
            LEARNED.map(|name| WIDEN.iter().position(|own| *own == name).map_or(1.0, |at| widen[at]));
        let amounts = |own: Vec<f64>| {
            LEARNED.iter().zip(own).zip(widths).map(|((name, x), width)| (name.to_string(), x / width)).collect()
        };
        let posterior = learned.together.unwrap_or_default().into_iter().map(amounts).collect();
        Ok(Calibration {
            equation: entry.name.into(),
            scene: scene.into(),
            held,
            found,
            membrane,
            pose,
            posterior,
            deviation,
        })
    }

    /// The standard deviation of what points have left that neighbours in the same frame do not share; nothing of single points.
    fn between_neighbours(&self, offs: &[Off], left: &[f64]) -> Option<f64> {
        const PAIR: NonZero<usize> = NonZero::new(2).unwrap();
        let (mut from, mut differences) = (0, Vec::new());
        for count in &self.points {
            let frame = from..from + count;
            let places: Vec<[f64; 2]> = offs[frame.clone()].iter().map(|off| off.place).collect();
            let (tree, left) = (Nearest::of(&places)?, &left[frame]);
            let next = |(at, place): (usize, &[f64; 2])| {
                let other = tree.some(place, PAIR).into_iter().map(|near| near.index).find(|index| *index != at)?;
                Some(left[at] - left[other])
            };
            differences.extend(places.iter().enumerate().filter_map(next));
            from += count;
        }
        (!differences.is_empty()).then(|| spread(differences.into_iter()) / 2f64.sqrt())
    }

    /// How far all points are from the surface of a solution; nothing where it has no displacements.
    fn offs(
        &self,
        contact: &Contact,
        values: &Values<'_>,
        widen: [f64; 2],
        pose: &Pose,
    ) -> Option<Result<Vec<Off>, DataError>> {
        let face = &contact.face;
        let [Some(x), Some(y), Some(z)] = contact.displacement.map(|name| values(name, &face.points)) else {
            return None;
        };
        let moved: Vec<[f64; 3]> = contact
            .deformed(&face.points, [&x, &y, &z])
            .into_iter()
            .zip(face.at_rest())
            .map(|(place, rest)| {
                std::array::from_fn(|axis| place[axis] + widen.get(axis).map_or(0.0, |w| (w - 1.0) * rest[axis]))
            })
            .collect();
        let normals = face.area_vectors(&moved);
        let Some(tree) = Nearest::of(&moved) else {
            return Some(Err(DataError::Invalid("the body's surface is not finite".into())));
        };
        let off = |point: &[f64; 3]| {
            let inside = pose.inward(*point);
            let at = tree.one(&inside).index;
            let size = length(normals[at]);
            let normal = normals[at].map(|x| x / size);
            let distance = minus(inside, moved[at]).iter().zip(normal).map(|(x, n)| x * n).sum();
            Off { place: [inside[0], inside[1]], distance, normal }
        };
        Some(Ok(self.cloud.points.iter().map(off).collect()))
    }
}

/// The standard deviation about zero that the median of sizes speaks for; zero of nothing.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN
}
