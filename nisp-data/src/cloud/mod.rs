//! Point clouds and surfaces from files: PLY, PCD, CSV, XYZ, NPY, NPZ; depth images in PNG and NPY; STL for surfaces.

mod camera;
mod check;
mod image;
mod npy;
mod npz;
mod pcd;
mod ply;
mod stl;
mod text;
mod thin;
mod view;

use std::collections::HashSet;
use std::path::Path;

pub use camera::Camera;
pub use check::LengthUnit;
pub use stl::Surface;
pub use view::View;

use crate::DataError;
use crate::components::Components;
use crate::input::{MOST_BYTES, read_bytes};

/// Points in space, with a note of what had to be left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cloud {
    /// The finite points, in file order.
    pub points: Vec<[f64; 3]>,
    /// What the user should know: dropped points, and the like. One line each.
    pub warnings: Vec<String>,
    /// True if the file says the unit of its points, which are in metres then.
    pub is_in_metres: bool,
}

/// File formats, as told by their first bytes or, where those say nothing, by the file's ending.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Format {
    Ply,
    Pcd,
    Npy,
    Npz,
    Png,
    Text,
}

impl Cloud {
    /// Reads a cloud. The format is recognised by content; the ending only matters between the text formats.
    pub fn read(path: impl AsRef<Path>) -> Result<Cloud, DataError> {
        let path = path.as_ref();
        Cloud::parse(path, &read_bytes(path, MOST_BYTES)?)
    }

    /// Reads a cloud from memory; `path` names the source in errors.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Cloud, DataError> {
        Cloud::parse_as(path, bytes, Components::IN_SPACE)
    }

    /// As [`Cloud::parse`], of points with other components. What they have less than three of is zero.
    fn parse_as(path: &Path, bytes: &[u8], components: Components<'_>) -> Result<Cloud, DataError> {
        if bytes.is_empty() {
            return Err(DataError::file(path, "the file is empty; a point cloud is needed"));
        }
        components.refuse_many(path)?;
        let format = recognise(path, bytes)?;
        if matches!(format, Format::Ply | Format::Pcd) {
            components.refuse_space(path)?;
        }
        let (points, is_in_metres) = match format {
            Format::Ply => (ply::parse(path, bytes)?, false),
            Format::Pcd => (pcd::parse(path, bytes)?, false),
            Format::Npy => (npy::Array::new(path, bytes)?.points(path, components)?, false),
            Format::Npz => (npz::parse(path, bytes, components)?, false),
            Format::Png => return Err(DataError::file(path, "is a picture; a point cloud is needed")),
            Format::Text => text::parse(path, bytes, components)?,
        };
        Ok(Cloud { is_in_metres, ..Cloud::finite(path, points)? })
    }

    /// The points of a depth image, in metres and the camera's frame. Pixels without depth are no points, and are not counted.
    fn seen(path: &Path, image: &image::Image, camera: &Camera) -> Result<Cloud, DataError> {
        Ok(Cloud { is_in_metres: true, ..Cloud::finite(path, camera.points(image))? })
    }

    /// Drops points that are not finite or were there before, and counts them. A cloud of none is an error.
    fn finite(path: &Path, points: Vec<[f64; 3]>) -> Result<Cloud, DataError> {
        let all = points.len();
        let mut kept: Vec<[f64; 3]> = points.into_iter().filter(|point| point.iter().all(|x| x.is_finite())).collect();
        if kept.is_empty() {
            let what = match all {
                0 => "the cloud has no points; record it again".to_string(),
                _ => format!("none of the {all} points is finite; record the cloud again"),
            };
            return Err(DataError::file(path, what));
        }
        let dropped = all - kept.len();
        let mut warnings = Vec::new();
        if dropped > 0 {
            warnings.push(format!("{}: {dropped} of {all} points were not finite and left out", path.display()));
        }
        // A point that is there twice would count as two, and its noise as what two agree upon.
        let finite = kept.len();
        let mut seen = HashSet::with_capacity(finite);
        kept.retain(|point| seen.insert(point.map(|x| (x + 0.0).to_bits())));
        if kept.len() < finite {
            let copies = finite - kept.len();
            warnings.push(format!("{}: {copies} of {all} points are copies of others and left out", path.display()));
        }
        Ok(Cloud { points: kept, warnings, is_in_metres: false })
    }
}

fn recognise(path: &Path, bytes: &[u8]) -> Result<Format, DataError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let known = match bytes {
        _ if bytes.starts_with(b"ply") => Some(Format::Ply),
        _ if bytes.starts_with(b"\x93NUMPY") => Some(Format::Npy),
        _ if bytes.starts_with(b"PK") => Some(Format::Npz),
        _ if bytes.starts_with(b"\x89PNG") => Some(Format::Png),
        _ if bytes.starts_with(b"# .PCD") || bytes.starts_with(b"VERSION") => Some(Format::Pcd),
        _ => None,
    };
    match (known, ending.as_str()) {
        (Some(format), _) => Ok(format),
        (None, "csv" | "xyz" | "txt" | "asc" | "pts" | "") => Ok(Format::Text),
        (None, "pcd") => Ok(Format::Pcd),
        (None, "ply" | "npy" | "npz" | "png") => Err(DataError::file(
            path,
            format!("does not begin as a {ending} file does; is it damaged or of another kind?"),
        )),
        (None, "stl" | "obj") => Err(DataError::file(
            path,
            "is a surface, not a point cloud; sample it, or give a PLY, PCD, CSV, XYZ, NPY, NPZ or PNG file",
        )),
        (None, _) => {
            let what = format!("unknown kind of file `.{ending}`; give a PLY, PCD, CSV, XYZ, NPY, NPZ or PNG file");
            Err(DataError::file(path, what))
        }
    }
}
