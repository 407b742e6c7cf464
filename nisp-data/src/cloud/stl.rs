//! Triangulated surfaces from STL files, ascii or binary.

use std::io::Cursor;
use std::path::Path;

use crate::DataError;
use crate::input::{MOST_BYTES, read_bytes};

/// Bytes before the first triangle of a binary file, and bytes per triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// A surface of triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Corners, each once.
    pub vertices: Vec<[f64; 3]>,
    /// Triples of corners, counterclockwise from outside.
    pub triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// Reads an STL file.
    pub fn read(path: impl AsRef<Path>) -> Result<Surface, DataError> {
        let path = path.as_ref();
        Surface::parse(path, &read_bytes(path, MOST_BYTES)?)
    }

    /// Reads STL from memory; `path` names the source in errors.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Surface, DataError> {
        refuse_short(path, bytes)?;
        let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| {
            let text = error.to_string().replace('\n', " ");
            DataError::file(path, format!("not a readable STL file ({text}); export it again"))
        })?;
        if mesh.faces.is_empty() {
            return Err(DataError::file(path, "the STL file has no triangles; export it again"));
        }
        let corner = |vertex: &stl_io::Vertex| [vertex[0], vertex[1], vertex[2]].map(f64::from);
        Ok(Surface {
            vertices: mesh.vertices.iter().map(corner).collect(),
            triangles: mesh.faces.iter().map(|face| face.vertices).collect(),
        })
    }

    /// Total area of the triangles.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|corners| self.triangle_area(corners)).sum()
    }

    fn triangle_area(&self, corners: &[usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|index| self.vertices[index]);
        let (p, q) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        0.5 * normal.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// A binary file announces its length. Believing it without a look could ask for gigabytes.
fn refuse_short(path: &Path, bytes: &[u8]) -> Result<(), DataError> {
    if bytes.starts_with(b"solid") {
        return Ok(());
    }
    let count = bytes.get(80..HEADER).and_then(|word| word.try_into().ok()).map(u32::from_le_bytes);
    match count {
        Some(count) if bytes.len() >= HEADER + TRIANGLE * count as usize => Ok(()),
        _ => Err(DataError::file(path, "the STL file ends too early; export or copy it again")),
    }
}
