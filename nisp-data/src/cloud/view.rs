//! How files of clouds are to be read: in which unit, and seen by which camera.

use std::path::Path;

use super::camera::Camera;
use super::{Cloud, Format, LengthUnit, image, npy, recognise};
use crate::DataError;
use crate::components::Components;
use crate::input::{MOST_BYTES, read_bytes};

/// What files of clouds do not say themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// Unit of coordinates; metres if not given.
    pub unit: Option<LengthUnit>,
    /// The camera whose frame clouds are in and whose depth images may be given; the body's own frame if none is.
    pub camera: Option<Camera>,
    /// What the numbers of a point are called, in their order: two or three. Columns with these headers are taken. None stands for x, y
    /// and z.
    pub components: Vec<String>,
}

impl View {
    /// Reads a cloud or a depth image into metres and the body's frame.
    ///
    /// # Errors
    /// Files that cannot be read, and depth images without a camera.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Cloud, DataError> {
        let path = path.as_ref();
        self.parse(path, &read_bytes(path, MOST_BYTES)?)
    }

    /// As [`View::read`], from memory; `path` names the source in errors.
    ///
    /// # Errors
    /// As [`View::read`].
    pub fn parse(&self, path: &Path, bytes: &[u8]) -> Result<Cloud, DataError> {
        let image = match recognise(path, bytes) {
            Ok(Format::Png) => Some(image::parse(path, bytes)?),
            Ok(Format::Npy) => npy::Array::new(path, bytes)?.image(path)?,
            _ => None,
        };
        let mut cloud = match (image, &self.camera) {
            (None, _) => Cloud::parse_as(path, bytes, Components::named(&self.components))?,
            (Some(image), Some(camera)) => Cloud::seen(path, &image, camera)?,
            (Some(_), None) => {
                let what = "is a depth image; say with --camera FILE which camera took it, or give a cloud of points";
                return Err(DataError::file(path, what));
            }
        };
        if let Some(unit) = self.unit {
            cloud.take_into_metres(unit);
        }
        if let Some(camera) = &self.camera {
            cloud.points.iter_mut().for_each(|point| *point = camera.place(*point));
        }
        Ok(cloud)
    }
}
