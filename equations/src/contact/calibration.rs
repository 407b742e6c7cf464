//! What free frames told of a sensor: a file that is written once and read with every frame.

use std::collections::BTreeMap;
use std::path::Path;

use nisp_data::Cloud;
use nisp_data::input::read_text;
use serde::{Deserialize, Serialize};

use super::Pose;
use super::deviation::Deviation;
use crate::PrepareError;

/// What the scenes that calibrate are called; the rest of their names is that of the law that they take.
pub(crate) const CALIBRATES: &str = "calibrate";

/// Material numbers that free frames hardly tell from each other.
pub const OPEN: [&str; 2] = ["E", "stretch"];

/// What a solution of free frames learned of a sensor.
pub struct Learned<'a> {
    /// Values of learned scalars by their names, in declared units.
    pub value: &'a dyn Fn(&str) -> Option<f64>,
    /// The standard deviation of Young's modulus in pascals, where there is one.
    pub young_deviation: Option<f64>,
    /// Along which shares of their values numbers of [`OPEN`] may be off, as [`nisp::Solution::learned_together`] has them.
    pub together: Option<Vec<Vec<f64>>>,
}

/// A sensor as its free frames show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Name of the equation.
    pub equation: String,
    /// The scene that found it.
    pub scene: String,
    /// What is as likely with other values of what was held, in words.
    pub held: String,
    /// How many points in how many frames it rests on, and what they are off.
    pub found: Quality,
    /// Material and size, in the keys of a sample.
    pub membrane: Membrane,
    /// Where the rim is in the cloud's frame.
    pub pose: Pose,
    /// Along which shares of their values material numbers may be off together, each of one standard deviation and independent of the
    /// others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub open: Vec<BTreeMap<String, f64>>,
    /// What the theory does not explain.
    pub deviation: Deviation,
}

/// What a calibration rests on. Lengths are in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Frames.
    pub frames: usize,
    /// Points in all of them.
    pub points: usize,
    /// The gauge pressure at which they were taken, in pascals.
    #[serde(rename = "gauge_pressure_Pa")]
    pub pressure: f64,
    /// What the points are off the theory's surface: the median of sizes over 0.6745, a standard deviation without outliers.
    pub misfit_m: f64,
    /// The same after the smooth deviation is taken off.
    pub noise_m: f64,
    /// The standard deviation of Young's modulus in pascals, where there is one.
    #[serde(rename = "young_sd_Pa", default, skip_serializing_if = "Option::is_none")]
    pub young_deviation: Option<f64>,
}

/// Material and size of a membrane, in the keys of samples and calibrations and in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Membrane {
    /// Semi-axis of the rim along `alpha`.
    pub a_m: Option<f64>,
    /// Semi-axis of the rim along `beta`.
    pub b_m: Option<f64>,
    /// Thickness.
    pub thickness_m: Option<f64>,
    /// Young's modulus.
    #[serde(rename = "young_Pa")]
    pub young: Option<f64>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// Stretch that it has at rest over its rim; one where nothing is said.
    pub stretch: Option<f64>,
    /// Gauge pressure.
    #[serde(rename = "gauge_pressure_Pa")]
    pub pressure: Option<f64>,
}

/// Frames of a sensor that nothing touches, and what they were bound with.
#[derive(Clone, Debug)]
pub struct References {
    /// How many frames.
    pub frames: usize,
    /// All their points, in metres.
    pub cloud: Cloud,
    /// What was known before.
    pub given: Membrane,
}

impl Calibration {
    /// Reads a file of [`Calibration::text`].
    ///
    /// # Errors
    /// No such file, or one that is no calibration.
    pub fn read(path: &Path) -> Result<Self, PrepareError> {
        let text = read_text(path)?;
        let fault = |reason: String| PrepareError::File { path: path.into(), reason };
        let calibration: Self = toml::from_str(&text)
            .map_err(|error| fault(format!("no calibration: {}; make one with `nisp calibrate`", error.message())))?;
        if !calibration.deviation.is_whole() || !calibration.scene.starts_with(CALIBRATES) {
            return Err(fault("no calibration; make one with `nisp calibrate`".into()));
        }
        Ok(calibration)
    }

    /// The file's text.
    ///
    /// # Errors
    /// Numbers that have no text.
    pub fn text(&self) -> Result<String, toml::ser::Error> {
        let about =
            "# What free frames told of a sensor, for --calibration. Lengths are in metres, angles in radians.\n";
        Ok(format!("{about}{}", toml::to_string(self)?))
    }

    /// A warning where Young's modulus is hardly known. A softer membrane that is stretched more at rest has about the same free shape.
    pub fn doubt(&self) -> Option<String> {
        /// Deviation of the modulus, as a share of it, up to which clouds leave more of a force open than the modulus does.
        const KNOWN: f64 = 0.05;
        let share = self.found.young_deviation? / self.membrane.young?;
        let held =
            if self.open.is_empty() { "which their deviations do not hold" } else { "and their deviations say so" };
        (share > KNOWN).then(|| {
            format!(
                "free frames tell `E` to {:.0} % only, since a stretch at rest makes up for it: forces found with this calibration may be off \
                 by about half of that share, {held}",
                100.0 * share
            )
        })
    }

    /// The scene of the same law that does what this one does.
    pub(crate) fn scene_for(&self, scene: &str) -> String {
        let law = self.scene.strip_prefix(CALIBRATES).unwrap_or_default();
        if scene.ends_with(law) { scene.into() } else { format!("{scene}{law}") }
    }

    /// Takes a cloud into the frame of the rim, and the deviation off.
    pub(crate) fn correct(&self, cloud: &mut Cloud) {
        for point in &mut cloud.points {
            let inside = self.pose.inward(*point);
            let off = self.deviation.at([inside[0], inside[1]]);
            *point = std::array::from_fn(|axis| inside[axis] - off[axis]);
        }
    }
}
