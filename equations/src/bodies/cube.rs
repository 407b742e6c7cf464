//! The faces of a cube, as they are drawn.

use crate::contact::Surface;

/// Nodes along an edge of the surface in pictures.
const DRAWN: usize = 31;

/// Nodes of a face of a unit cube around its middle, row by row.
pub(super) fn face(nodes: usize) -> Vec<[f64; 2]> {
    let at = |index: usize| index as f64 / (nodes - 1) as f64 - 0.5;
    (0..nodes * nodes).map(|index| [at(index % nodes), at(index / nodes)]).collect()
}

/// All six faces, seen from outside.
pub(super) fn surface(side: f64) -> Surface {
    let mut surface = Surface { points: Vec::new(), triangles: Vec::new(), loaded: Vec::new() };
    for axis in 0..3 {
        for end in [-0.5, 0.5] {
            let first = surface.loaded.len();
            for [x, y] in face(DRAWN) {
                let mut place = [0.0; 3];
                (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (end, x, y);
                surface.points.extend([side * place[0], side * place[1], side * (place[2] - 0.5)]);
                surface.loaded.push(axis == 2 && end < 0.0);
            }
            for row in 0..DRAWN - 1 {
                for column in 0..DRAWN - 1 {
                    let corner = first + row * DRAWN + column;
                    let (right, above) = (corner + 1, corner + DRAWN);
                    let mut both = [[corner, right, above + 1], [corner, above + 1, above]];
                    if end < 0.0 {
                        both.iter_mut().for_each(|triangle| triangle.swap(1, 2));
                    }
                    surface.triangles.extend(both);
                }
            }
        }
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The divergence theorem: outward triangles of a cube enclose its volume.
    #[test]
    fn the_drawn_surface_is_closed_and_faces_outwards() {
        let surface = surface(0.046);
        let (points, _) = surface.points.as_chunks::<3>();
        let volume: f64 = surface
            .triangles
            .iter()
            .map(|corners| {
                let [p, q, r] = corners.map(|corner| points[corner]);
                let normal = [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]];
                (p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2]) / 6.0
            })
            .sum();
        assert!((volume / 0.046f64.powi(3) - 1.0).abs() < 1e-12, "{volume}");
        assert_eq!(surface.loaded.iter().filter(|loaded| **loaded).count(), DRAWN * DRAWN);
    }
}
