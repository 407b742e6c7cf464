//! Delaunay triangulation of plane points.

use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation, mitigate_underflow};

use crate::DataError;

struct Corner {
    position: Point2<f64>,
    index: usize,
}

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Triangles as triples of point indices, counterclockwise, in a fixed order.
///
/// Triangles with an edge longer than `longest_edge` are left out: they bridge holes and bays.
pub fn triangulate(points: &[[f64; 2]], longest_edge: Option<f64>) -> Result<Vec<[usize; 3]>, DataError> {
    let corner =
        |(index, &[x, y]): (usize, &[f64; 2])| Corner { position: mitigate_underflow(Point2::new(x, y)), index };
    let corners = points.iter().enumerate().map(corner).collect();
    let net = DelaunayTriangulation::<Corner>::bulk_load(corners)
        .map_err(|error| DataError::invalid(format!("points cannot be triangulated: {error}")))?;
    let short = |[a, b, c]: [usize; 3]| {
        let length = |p: usize, q: usize| (points[p][0] - points[q][0]).hypot(points[p][1] - points[q][1]);
        longest_edge.is_none_or(|limit| length(a, b).max(length(b, c)).max(length(c, a)) <= limit)
    };
    let faces = net.inner_faces().map(|face| face.vertices().map(|vertex| vertex.data().index));
    let mut triangles: Vec<[usize; 3]> = faces.filter(|&face| short(face)).map(first_corner_first).collect();
    triangles.sort_unstable();
    Ok(triangles)
}

/// Turns a triangle so that its smallest index leads; the sense of rotation stays.
fn first_corner_first([a, b, c]: [usize; 3]) -> [usize; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Domain, Sampling};

    #[test]
    fn a_disc_is_covered() {
        let disc = Domain::disc([0.0, 0.0], 1.0).unwrap();
        let inner = disc.interior(2000, Sampling::Grid, 0);
        let points: Vec<[f64; 2]> = inner.iter().chain(disc.boundary(200).iter()).map(|p| [p[0], p[1]]).collect();
        let area = |triangles: &[[usize; 3]]| -> f64 {
            let cross = |[a, b, c]: [usize; 3]| {
                let (p, q, r) = (points[a], points[b], points[c]);
                0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))
            };
            triangles.iter().map(|&triangle| cross(triangle)).sum()
        };
        let triangles = triangulate(&points, None).unwrap();
        assert!((area(&triangles) - std::f64::consts::PI).abs() < 1e-3);
        assert!(triangulate(&points, Some(1e-3)).unwrap().is_empty());
    }

    #[test]
    fn odd_points_do_not_panic() {
        assert!(triangulate(&[], None).unwrap().is_empty());
        assert!(triangulate(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], None).unwrap().is_empty());
        assert_eq!(triangulate(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], None).unwrap().len(), 1);
        assert!(triangulate(&[[f64::NAN, 0.0]], None).is_err());
    }
}
