//! Files of cameras.

use std::path::Path;

use nisp_data::cloud::Camera;
use nisp_data::input::read_text;
use serde::Deserialize;

use crate::PrepareError;

/// A camera as its file has it: `fx = 381.2`, pixels; lengths in metres.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    scale: Option<f64>,
    #[serde(default = "unturned")]
    rotation: [[f64; 3]; 3],
    #[serde(default)]
    position: [f64; 3],
}

fn unturned() -> [[f64; 3]; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

/// Reads the camera that took depth images from a TOML file.
///
/// # Errors
/// A file that cannot be read or describes no camera.
pub fn camera(path: &Path) -> Result<Camera, PrepareError> {
    let fault = |reason: String| PrepareError::File { path: path.into(), reason };
    let written: Written = toml::from_str(&read_text(path)?).map_err(|error| fault(error.to_string()))?;
    let Written { fx, fy, cx, cy, scale, rotation, position } = written;
    let camera = Camera { focal: [fx, fy], center: [cx, cy], scale, rotation, position };
    camera.check().map_err(|error| fault(error.to_string()))?;
    Ok(camera)
}
