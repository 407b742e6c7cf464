//! PLY: binary little-endian, with a colour for each point and every scalar as a property of its own.

use std::io::{self, Write};
use std::path::Path;

use super::{Array, Mesh};
use crate::DataError;
use crate::atomic::write_atomic;
use crate::colour::ColourScale;

impl Mesh {
    /// Writes the mesh as PLY. `colour_by` names an array (without its unit) and the scale of its colours.
    pub fn write_ply(&self, path: impl AsRef<Path>, colour_by: Option<(&str, ColourScale)>) -> Result<(), DataError> {
        let colours = self.colours(colour_by)?;
        write_atomic(path.as_ref(), |out| self.ply(out, colours))
    }

    /// The bytes that [`Mesh::write_ply`] writes.
    pub fn ply_bytes(&self, colour_by: Option<(&str, ColourScale)>) -> Result<Vec<u8>, DataError> {
        let colours = self.colours(colour_by)?;
        let mut bytes = Vec::new();
        // A vector takes everything.
        let _ = self.ply(&mut bytes, colours);
        Ok(bytes)
    }

    fn colours(&self, by: Option<(&str, ColourScale)>) -> Result<Option<(&Array, ColourScale)>, DataError> {
        by.map(|(name, scale)| Ok((self.scalar(name)?, scale))).transpose()
    }

    fn scalars(&self) -> impl Iterator<Item = &Array> {
        self.arrays.iter().filter(|array| array.components == 1)
    }

    fn scalar(&self, name: &str) -> Result<&Array, DataError> {
        let found = self.scalars().find(|array| array.name == name || bare(&array.name) == name);
        let all = || self.scalars().map(|array| bare(&array.name)).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| DataError::invalid(format!("no array `{name}` to colour by (arrays: {})", all())))
    }

    fn ply(&self, out: &mut dyn Write, colours: Option<(&Array, ColourScale)>) -> io::Result<()> {
        writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment positions in metres")?;
        for array in self.scalars() {
            writeln!(out, "comment {}: {}", property(&array.name), array.name)?;
        }
        writeln!(out, "element vertex {}", self.points.len())?;
        writeln!(out, "property double x\nproperty double y\nproperty double z")?;
        if colours.is_some() {
            writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
        }
        for array in self.scalars() {
            writeln!(out, "property double {}", property(&array.name))?;
        }
        if !self.triangles.is_empty() {
            writeln!(out, "element face {}\nproperty list uchar int vertex_indices", self.triangles.len())?;
        }
        writeln!(out, "end_header")?;
        for (index, point) in self.points.iter().enumerate() {
            point.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))?;
            if let Some((array, scale)) = colours {
                out.write_all(&scale.colour(array.values[index]))?;
            }
            self.scalars().try_for_each(|array| out.write_all(&array.values[index].to_le_bytes()))?;
        }
        for triangle in &self.triangles {
            out.write_all(&[3])?;
            triangle.iter().try_for_each(|&corner| out.write_all(&(corner as i32).to_le_bytes()))?;
        }
        Ok(())
    }
}

/// The name without its unit.
fn bare(name: &str) -> &str {
    name.split(" [").next().unwrap_or(name)
}

/// A property's name must be one word.
fn property(name: &str) -> String {
    bare(name).replace(|letter: char| !letter.is_alphanumeric(), "_")
}
