//! Where a body is in a cloud's frame.

use serde::{Deserialize, Serialize};

/// A turn about x, then y, then z, and a shift: from the body's frame to the cloud's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Angles about x, y and z, in radians.
    pub turn_rad: [f64; 3],
    /// Where the body's origin is in the cloud's frame, in metres.
    pub shift_m: [f64; 3],
}

impl Pose {
    /// Columns: the body's axes in the cloud's frame.
    fn axes(&self) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| self.turned(axis))
    }

    fn turned(&self, point: [f64; 3]) -> [f64; 3] {
        let [(sx, cx), (sy, cy), (sz, cz)] = self.turn_rad.map(f64::sin_cos);
        let [x, y, z] = point;
        let (y, z) = (cx * y - sx * z, sx * y + cx * z);
        let (x, z) = (cy * x + sy * z, cy * z - sy * x);
        [cz * x - sz * y, sz * x + cz * y, z]
    }

    /// A point of the cloud's frame, in the body's.
    pub fn inward(&self, point: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.shift_m[axis]);
        self.axes().map(|axis| axis.iter().zip(from).map(|(a, x)| a * x).sum())
    }

    /// A point of the body's frame, in the cloud's.
    pub fn outward(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(point);
        std::array::from_fn(|axis| turned[axis] + self.shift_m[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn turns_are_about_x_then_y_then_z() {
        // About x: z to -y ... y to z; about y: z to x; about z: x to y.
        let pose = Pose { turn_rad: [FRAC_PI_2; 3], shift_m: [1.0, 2.0, 3.0] };
        let moved = pose.outward([0.0, 1.0, 0.0]);
        for (found, expected) in moved.iter().zip([1.0, 3.0, 3.0]) {
            assert!((found - expected).abs() < 1e-12, "{moved:?}");
        }
    }

    #[test]
    fn inward_undoes_outward() {
        let pose = Pose { turn_rad: [0.1, -0.2, 0.3], shift_m: [0.01, 0.02, -0.03] };
        let point = [0.05, -0.04, 0.03];
        for (found, expected) in pose.inward(pose.outward(point)).iter().zip(point) {
            assert!((found - expected).abs() < 1e-15);
        }
    }
}
