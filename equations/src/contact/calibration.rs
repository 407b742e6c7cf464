//! What free frames told of a sensor: a file that is written once and read with every frame.

use std::collections::BTreeMap;
use std::path::Path;

use nisp::Doubt;
use nisp_data::Cloud;
use nisp_data::input::read_text;
use serde::{Deserialize, Serialize};

use super::Pose;
use super::deviation::Deviation;
use crate::PrepareError;

/// What the scenes that calibrate are called; the rest of their names is that of the law that they take.
pub(crate) const CALIBRATES: &str = "calibrate";

/// What free frames tell of a sensor, all of it together.
pub const LEARNED: [&str; 10] =
    ["E", "stretch", WIDEN[0], WIDEN[1], SHIFT[0], SHIFT[1], SHIFT[2], TURN[0], TURN[1], TURN[2]];
/// How much wider the rim is than its semi-axes.
pub(crate) const WIDEN: [&str; 2] = ["widen_a", "widen_b"];
/// Where the rim's middle is in the cloud's frame.
pub(crate) const SHIFT: [&str; 3] = ["shift_x", "shift_y", "shift_z"];
/// How the rim is turned in the cloud's frame.
pub(crate) const TURN: [&str; 3] = ["turn_x", "turn_y", "turn_z"];

/// What a solution of free frames learned of a sensor.
pub struct Learned<'a> {
    /// Values of learned scalars by their names, in declared units.
    pub value: &'a dyn Fn(&str) -> Option<f64>,
    /// The standard deviation of Young's modulus in pascals, where there is one.
    pub young_deviation: Option<f64>,
    /// By how much the numbers of [`LEARNED`] may be off, as [`nisp::Solution::learned_together`] has it.
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
    /// By how much the numbers of [`LEARNED`] may be off together, in declared units: each by one standard deviation and independent of
    /// the others. Widths are shares of the semi-axes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub posterior: Vec<BTreeMap<String, f64>>,
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
    /// What neighbouring points of a frame are off each other then: the noise of the camera alone. Nothing in files that do not say it.
    #[serde(rename = "camera_m", default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<f64>,
    /// The standard deviation of Young's modulus in pascals, where there is one.
    #[serde(rename = "young_sd_Pa", default, skip_serializing_if = "Option::is_none")]
    pub young_deviation: Option<f64>,
}

impl Quality {
    /// Share of what points are off the theory's surface, as a variance, that the smooth deviation explains.
    pub(crate) fn common(&self) -> f64 {
        let own = (self.noise_m / self.misfit_m).powi(2);
        if own.is_finite() { (1.0 - own).clamp(0.0, 1.0) } else { 1.0 }
    }
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
    /// All their points, in metres, frame by frame.
    pub cloud: Cloud,
    /// How many points each frame has.
    pub points: Vec<usize>,
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

    /// What every answer rests on: how well the theory and the smooth deviation describe the free frames.
    pub fn doubts(&self) -> Vec<Doubt> {
        /// What a theory may miss free frames by, as a share of the longer semi-axis: a real bubble is .3 hundredths off.
        const MISSED: f64 = 0.01;
        /// What may be left of free frames, over the camera's own noise: 1.8 times on a real bubble.
        const LEFT: f64 = 2.5;
        /// Noise of a camera that matters, as a share of the longer semi-axis.
        const LEAST: f64 = 5e-4;
        let Quality { misfit_m, noise_m, camera, .. } = self.found;
        let size = [self.membrane.a_m, self.membrane.b_m].into_iter().flatten().fold(0.0, f64::max);
        let causes = "did something touch the bubble in a free frame, were frames of several pressures or sensors given as one, or are \
                      pressure, sizes or unit wrong? calibrate anew";
        let missed = format!(
            "the theory misses the calibration's free frames by {:.2} mm, {:.1} % of the rim's semi-axis: {causes}",
            1e3 * misfit_m,
            100.0 * misfit_m / size
        );
        let doubt = |value, limit, message| Doubt { of: "calibration", value, limit, message };
        let mut all = vec![doubt(misfit_m / size, MISSED, missed)];
        all.extend(camera.map(|camera| {
            let left = format!(
                "the calibration's free frames are {:.2} mm off beside the smooth deviation, and neighbouring points {:.2} mm: {causes}",
                1e3 * noise_m,
                1e3 * camera
            );
            doubt(noise_m / camera.max(LEAST * size), LEFT, left)
        }));
        all.retain(|own| own.value.is_finite());
        all
    }

    /// A warning where Young's modulus is hardly known. A softer membrane that is stretched more at rest has about the same free shape.
    pub fn doubt(&self) -> Option<String> {
        /// Deviation of the modulus, as a share of it, up to which clouds leave more of a force open than the modulus does.
        const KNOWN: f64 = 0.05;
        let share = self.found.young_deviation? / self.membrane.young?;
        let held = if self.posterior.is_empty() {
            "which their deviations do not hold"
        } else {
            "and their deviations say so"
        };
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
}
