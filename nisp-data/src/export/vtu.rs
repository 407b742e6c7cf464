//! VTU, the unstructured grid of VTK, as text: exact, readable, and small enough for the meshes of this project.

use std::fmt::{Display, Write as _};
use std::io::{self, Write};
use std::path::Path;

use super::Mesh;
use crate::DataError;
use crate::atomic::write_atomic;

/// VTK's numbers for a lone point, a triangle and a cell along the axes.
const VERTEX: u8 = 1;
const TRIANGLE: u8 = 5;
const VOXEL: u8 = 11;

impl Mesh {
    /// Writes the mesh as VTU.
    pub fn write_vtu(&self, path: impl AsRef<Path>) -> Result<(), DataError> {
        write_atomic(path.as_ref(), |out| self.vtu(out))
    }

    /// The bytes that [`Mesh::write_vtu`] writes.
    pub fn vtu_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // A vector takes everything.
        let _ = self.vtu(&mut bytes);
        bytes
    }

    fn vtu(&self, out: &mut dyn Write) -> io::Result<()> {
        let (cells, corners, kind) = match (self.triangles.len(), self.voxels.len()) {
            (0, 0) => (self.points.len(), 1, VERTEX),
            (0, voxels) => (voxels, 8, VOXEL),
            (triangles, _) => (triangles, 3, TRIANGLE),
        };
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">")?;
        writeln!(
            out,
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">",
            self.points.len()
        )?;
        writeln!(out, "<Points>")?;
        array(out, "Float64", "position [m]", 3, self.points.iter().flatten())?;
        writeln!(out, "</Points>\n<Cells>")?;
        match kind {
            VERTEX => array(out, "Int64", "connectivity", 1, 0..cells)?,
            VOXEL => array(out, "Int64", "connectivity", 1, self.voxels.iter().flatten())?,
            _ => array(out, "Int64", "connectivity", 1, self.triangles.iter().flatten())?,
        }
        array(out, "Int64", "offsets", 1, (1..=cells).map(|cell| cell * corners))?;
        array(out, "UInt8", "types", 1, std::iter::repeat_n(kind, cells))?;
        writeln!(out, "</Cells>\n<PointData>")?;
        for data in &self.arrays {
            array(out, "Float64", &data.name, data.components, data.values.iter())?;
        }
        writeln!(out, "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }
}

fn array(
    out: &mut dyn Write,
    kind: &str,
    name: &str,
    components: usize,
    values: impl Iterator<Item = impl Display>,
) -> io::Result<()> {
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    writeln!(out, "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">")?;
    let mut line = String::new();
    for value in values {
        // Writing into a String cannot fail.
        let _ = write!(line, "{value} ");
        if line.len() > 100 {
            writeln!(out, "{}", line.trim_end())?;
            line.clear();
        }
    }
    writeln!(out, "{}\n</DataArray>", line.trim_end())
}
