//! Depth images as points in space.

use super::image::Image;
use crate::DataError;

/// How far a rotation may be from one: its columns have the length one and right angles to this.
const ROTATION: f64 = 1e-3;

/// A pinhole camera that measures depth along its axis, and where it is. Images are without distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Focal lengths along columns and rows, in pixels.
    pub focal: [f64; 2],
    /// Column and row of the axis, in pixels; the middle of the first pixel is at 0.
    pub center: [f64; 2],
    /// Metres in one unit of an image; if not given, 0.001 for whole numbers and 1 for others.
    pub scale: Option<f64>,
    /// Turns directions of the camera (columns, rows, depth) into those of the body; its rows are the body's axes.
    pub rotation: [[f64; 3]; 3],
    /// Where the camera is in the body's frame, in metres.
    pub position: [f64; 3],
}

impl Camera {
    /// Checks that focal lengths and scale are positive and that the rotation is one.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self) -> Result<(), DataError> {
        let positive = [("fx", self.focal[0]), ("fy", self.focal[1]), ("scale", self.scale.unwrap_or(1.0))];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0) {
            return Err(DataError::invalid(format!("`{name}` is {value}, and must be above 0")));
        }
        let [x, y, z] = self.rotation;
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        let off = [dot(x, x) - 1.0, dot(y, y) - 1.0, dot(x, y), cross[0] - z[0], cross[1] - z[1], cross[2] - z[2]];
        if off.into_iter().any(|off| off.is_nan() || off.abs() > ROTATION) {
            let what = "`rotation` is none: its rows must have the length 1, be at right angles, and be right-handed";
            return Err(DataError::invalid(what));
        }
        Ok(())
    }

    /// The points that an image shows, in the camera's frame, in metres.
    pub(super) fn points(&self, image: &Image) -> Vec<[f64; 3]> {
        let scale = self.scale.unwrap_or(image.metres);
        let seen = image.depths.iter().enumerate().filter(|(_, depth)| depth.is_finite() && **depth > 0.0);
        seen.map(|(index, depth)| {
            let z = depth * scale;
            let along = |pixel: usize, axis: usize| (pixel as f64 - self.center[axis]) * z / self.focal[axis];
            [along(index % image.width, 0), along(index / image.width, 1), z]
        })
        .collect()
    }

    /// A point of the camera's frame in the body's.
    pub(super) fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.rotation.map(|row| row[0] * point[0] + row[1] * point[1] + row[2] * point[2]);
        [0, 1, 2].map(|axis| turned[axis] + self.position[axis])
    }
}
