//! What was found of a contact, and how well, against a truth that no solver has seen.

use nisp_data::overlap::intersection_over_union;
use nisp_data::{DataError, Table};

use super::face::{Face, length, minus, weighted_sum};
use super::metrics::patch_chamfer_mm2;
use super::patches::{Patch, patches};
use super::{Contact, Load};
use crate::truth::{Headers, Truth};

/// The true contact at the truth's points.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueContact {
    /// Which points are touched.
    pub mask: Vec<bool>,
    /// The net force on the body, in newtons.
    pub force: [f64; 3],
}

/// What was found of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactScore {
    /// The net force on the body, in newtons.
    pub force: [f64; 3],
    /// By how many newtons the net force grows with each pascal at each point of the contact's face, along its direction.
    pub per_pascal: Vec<f64>,
    /// The connected parts that are touched, the largest first.
    pub patches: Vec<Patch>,
    /// How far that is from the truth, where it is known.
    pub against: Option<Against>,
}

impl ContactScore {
    /// Magnitude of the net force in newtons.
    pub fn magnitude(&self) -> f64 {
        length(self.force)
    }
}

/// A contact against its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Against {
    /// Error of the net force in newtons: the length of the difference of both vectors.
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
    pub(super) fn read(
        table: &Table,
        truth: &Truth,
        headers: Headers<'_>,
        contact: &Contact,
        pressure: &str,
    ) -> Result<Self, DataError> {
        let mask: Vec<bool> = headers.read(table, "contact", "")?.iter().map(|contact| *contact > 0.5).collect();
        let face = Face::new(contact.face.dim, truth.points.clone())?;
        let fields = contact.displacement.map(|name| truth.of(name).map(<[f64]>::to_vec));
        let moved = contact.moved(&truth.points, &fields).unwrap_or_else(|| face.at_rest());
        let forces = face.forces(contact.load, &moved);
        Ok(Self { mask, force: truth.of(pressure).map_or([0.0; 3], |pressure| weighted_sum(pressure, &forces)) })
    }
}

impl Contact {
    /// Where points have moved to in metres, if all displacements are known.
    fn moved(&self, points: &[f64], fields: &[Option<Vec<f64>>; 3]) -> Option<Vec<[f64; 3]>> {
        let [Some(x), Some(y), Some(z)] = fields else { return None };
        Some(self.deformed(points, [x, y, z]))
    }

    /// Scores a pressure and displacements; nothing where the scene has no pressure, or where its force asks for
    /// displacements that `values` does not know. The truth is looked at where it is known; without displacements in
    /// `values` the patches are those at rest, and there is no distance between them.
    pub fn score(&self, values: &Values<'_>, truth: Option<&Truth>) -> Option<ContactScore> {
        let points = &self.face.points;
        let pressures = values(self.pressure?, points)?;
        let moved = self.moved(points, &self.displacement.map(|name| values(name, points)));
        let (moved, load) = match (moved, self.load) {
            (Some(moved), load) => (moved, load),
            (None, Load::Follower) => return None,
            (None, Load::Fixed(direction) | Load::Normal(direction)) => (self.face.at_rest(), Load::Fixed(direction)),
        };
        let forces = self.face.forces(load, &moved);
        let force = weighted_sum(&pressures, &forces);
        // Without any force, along that of the same pressure everywhere.
        let direction = if length(force) > 0.0 { force } else { weighted_sum(&vec![1.0; forces.len()], &forces) };
        let size = length(direction);
        let along = |own: &[f64; 3]| (0..3).map(|axis| own[axis] * direction[axis]).sum::<f64>() / size;
        let per_pascal = forces.iter().map(along).collect();
        let known = truth.zip(self.truth.as_ref());
        Some(ContactScore {
            force,
            per_pascal,
            patches: patches(&self.face, &self.rule.mask(&pressures), &moved, &pressures, &forces),
            against: known.and_then(|(truth, contact)| self.against(values, force, truth, contact)),
        })
    }

    fn against(&self, values: &Values<'_>, force: [f64; 3], truth: &Truth, contact: &TrueContact) -> Option<Against> {
        let mask = self.rule.mask(&values(self.pressure?, &truth.points)?);
        let touched = |fields: [Option<Vec<f64>>; 3], mask: &[bool]| -> Option<Vec<[f64; 3]>> {
            let moved = self.moved(&truth.points, &fields)?.into_iter().zip(mask);
            Some(moved.filter(|(_, touched)| **touched).map(|(point, _)| point).collect())
        };
        let found = touched(self.displacement.map(|name| values(name, &truth.points)), &mask);
        let real = touched(self.displacement.map(|name| truth.of(name).map(<[f64]>::to_vec)), &contact.mask);
        Some(Against {
            force_error: length(minus(force, contact.force)),
            iou: intersection_over_union(&mask, &contact.mask).ok()?,
            patch_chamfer_mm2: found.zip(real).and_then(|(found, real)| patch_chamfer_mm2(&found, &real)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Rule, Surface};
    use nisp::units::Scale;
    use nisp_data::domain::{Domain, Sampling};

    /// A plane body of one metre with its points and a truth: a disc of radius 0.3 m that carries 5 kPa, 2 mm up.
    fn body() -> (Contact, Truth) {
        let square = Domain::cuboid(&[0.0, 0.0], &[1.0, 1.0]).unwrap();
        let points: Vec<f64> = (0..101 * 101).flat_map(|i| [i % 101, i / 101].map(|k| 0.01 * f64::from(k))).collect();
        let mut table = Table::empty();
        let column = |of: &dyn Fn(f64, f64) -> f64| points.chunks_exact(2).map(|p| of(p[0], p[1])).collect::<Vec<_>>();
        table.push("contact", "", &column(&|x, y| if disc(x, y, 0.3) { 1.0 } else { 0.0 })).unwrap();
        let count = points.len() / 2;
        let heads = vec![
            ("u", vec![0.0; count]),
            ("v", vec![0.0; count]),
            ("w", vec![2.0; count]),
            ("f", column(&|x, y| if disc(x, y, 0.3) { 5e3 } else { 0.0 })),
        ];
        let truth = Truth { points: points.clone(), heads, outside: 0 };
        let mut contact = Contact {
            displacement: ["u", "v", "w"],
            unit: Scale::new(1e-3),
            pressure: Some("f"),
            rule: Rule { least: 2500.0, of_mean: 2.0 },
            load: Load::Fixed([0.0, 0.0, -1.0]),
            face: Face::new(2, square.interior(40_000, Sampling::Grid, 0).coords).unwrap(),
            surface: Surface { points: vec![], triangles: vec![], loaded: vec![] },
            cloud: vec![],
            near: 0.0,
            eye: [0.0, 90.0],
            truth: None,
            rival: None,
        };
        contact.truth = Some(TrueContact::read(&table, &truth, Headers::default(), &contact, "f").unwrap());
        (contact, truth)
    }

    fn disc(x: f64, y: f64, radius: f64) -> bool {
        (x - 0.5).hypot(y - 0.5) < radius
    }

    /// A disc of another radius that carries as much, 3 mm up.
    fn found(radius: f64) -> impl Fn(&str, &[f64]) -> Option<Vec<f64>> {
        move |name, at| {
            let f = |p: &[f64]| if disc(p[0], p[1], radius) { 5e3 } else { 0.0 };
            Some(match name {
                "f" => at.chunks_exact(2).map(f).collect(),
                "w" => vec![3.0; at.len() / 2],
                _ => vec![0.0; at.len() / 2],
            })
        }
    }

    #[test]
    fn a_smaller_disc_is_scored_as_its_closed_form_says() {
        let (contact, truth) = body();
        let score = contact.score(&found(0.24), Some(&truth)).unwrap();
        let (force, real) = [0.24, 0.3].map(|r: f64| 5e3 * std::f64::consts::PI * r * r).into();
        assert!((score.magnitude() / force - 1.0).abs() < 5e-3, "{score:?}");
        assert_eq!(score.patches.len(), 1);
        let against = score.against.unwrap();
        assert!((against.force_error / (real - force) - 1.0).abs() < 0.03, "{against:?}");
        assert!((against.iou - 0.64).abs() < 0.01, "{against:?}");
    }

    /// A millimetre apart, which is nearer than any other point: once in each direction.
    #[test]
    fn the_same_disc_elsewhere_has_the_distance_of_its_lift() {
        let (contact, truth) = body();
        let against = contact.score(&found(0.3), Some(&truth)).unwrap().against.unwrap();
        assert_eq!(against.iou, 1.0);
        assert!((against.patch_chamfer_mm2.unwrap() - 2.0).abs() < 1e-9, "{against:?}");
    }

    /// Of a square of 21 x 21 points 3 mm up, a cloud at x = 0 shows the two columns that are nearer than 0.06.
    #[test]
    fn a_cloud_shows_what_is_near_to_it() {
        let (mut contact, _) = body();
        let line = |count: usize| (0..count).map(move |at| at as f64 / (count - 1) as f64);
        contact.surface.points = line(21).flat_map(|x| line(21).flat_map(move |y| [x, y])).collect();
        contact.cloud = line(101).map(|y| [0.0, y, 3e-3]).collect();
        contact.near = 0.06;
        assert_eq!(contact.seen(&found(0.3)), Some(2.0 / 21.0));
        contact.cloud.iter_mut().for_each(|point| point[2] += 0.06);
        assert_eq!(contact.seen(&found(0.3)), Some(0.0));
    }

    #[test]
    fn without_a_truth_there_is_a_force_and_without_a_patch_no_distance() {
        let (contact, truth) = body();
        let nothing = |_: &str, at: &[f64]| Some(vec![0.0; at.len() / 2]);
        let score = contact.score(&nothing, Some(&truth)).unwrap();
        let against = score.against.as_ref().unwrap();
        assert_eq!((score.magnitude(), against.iou, against.patch_chamfer_mm2), (0.0, 0.0, None));
        assert!(score.patches.is_empty());
        assert_eq!(contact.score(&nothing, None).unwrap().against, None);
        assert_eq!(Contact { pressure: None, ..contact }.score(&nothing, None), None);
    }
}
