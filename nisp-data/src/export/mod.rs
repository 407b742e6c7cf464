//! Results for other programs: VTU of surfaces and volumes for ParaView, PLY with colours for any mesh viewer.

mod ply;
mod triangulate;
mod voxels;
mod vtu;

pub use triangulate::triangulate;

use crate::DataError;

/// Points, triangles between them (if any), and named values on the points.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    /// Cells between the points of a grid; none where there are triangles.
    voxels: Vec<[usize; 8]>,
    arrays: Vec<Array>,
}

/// Values on the points of a mesh.
#[derive(Debug, Clone)]
struct Array {
    /// With its unit: `f [Pa]`.
    name: String,
    components: usize,
    values: Vec<f64>,
}

impl Mesh {
    /// A mesh; without triangles it is a cloud.
    pub fn new(points: Vec<[f64; 3]>, triangles: Vec<[usize; 3]>) -> Result<Mesh, DataError> {
        if triangles.iter().flatten().any(|&corner| corner >= points.len()) {
            return Err(DataError::invalid("a triangle names a point that the mesh does not have"));
        }
        Ok(Mesh { points, triangles, ..Mesh::default() })
    }

    /// The cells of a grid all of whose corners are points; a cloud where there are none.
    pub fn volume(points: Vec<[f64; 3]>) -> Mesh {
        let voxels = voxels::voxels(&points);
        Mesh { points, voxels, ..Mesh::default() }
    }

    /// Adds values: one for each point, or three for a vector (or any fixed number).
    pub fn push(&mut self, name: &str, unit: &str, values: Vec<f64>) -> Result<(), DataError> {
        let count = self.points.len();
        if count == 0 || values.is_empty() || !values.len().is_multiple_of(count) {
            return Err(DataError::invalid(format!(
                "array `{name}`: {} values do not fit {count} points",
                values.len()
            )));
        }
        let name = if matches!(unit, "" | "1") { name.to_string() } else { format!("{name} [{unit}]") };
        self.arrays.push(Array { name, components: values.len() / count, values });
        Ok(())
    }
}
