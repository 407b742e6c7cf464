//! Geometry against closed forms.

use std::f64::consts::PI;

use nisp_data::cloud::Surface;
use nisp_data::domain::{Domain, Points, Sampling, resample};

fn integral(points: &Points, f: impl Fn(&[f64]) -> f64) -> f64 {
    points.iter().zip(points.weights.as_ref().unwrap()).map(|(point, weight)| weight * f(point)).sum()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1e-300), "{a} is not {b}");
}

fn plane_and_solid() -> Vec<Domain> {
    vec![
        Domain::interval(-1.0, 3.0).unwrap(),
        Domain::cuboid(&[0.0, -1.0], &[2.0, 1.5]).unwrap(),
        Domain::cuboid(&[0.0, -1.0, 2.0], &[2.0, 1.0, 2.5]).unwrap(),
        Domain::disc([1.0, 2.0], 0.5).unwrap(),
        Domain::ellipse([0.0, 0.0], [0.06, 0.04]).unwrap(),
        Domain::polygon(&[[0.0, 0.0], [0.0, 2.0], [1.0, 2.0], [1.0, 1.0], [3.0, 1.0], [3.0, 0.0]]).unwrap(),
    ]
}

/// A tetrahedron with three edges of 2 along the axes from a corner, inside out or not.
fn tetrahedron(inside_out: bool) -> Surface {
    let vertices = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let mut triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    if inside_out {
        triangles.iter_mut().for_each(|triangle| triangle.reverse());
    }
    Surface { vertices, triangles }
}

/// Bodies whose size has a closed form: domain and measures inside and on the boundary.
fn bodies() -> Vec<(Domain, [f64; 2])> {
    let square = |low: f64, high: f64| Domain::cuboid(&[low, 0.0], &[high, 1.0]).unwrap();
    let disc = |x: f64| Domain::disc([x, 0.5], 0.25).unwrap();
    let ball = |radius: f64| Domain::ball([1.0, -1.0, 0.5], radius).unwrap();
    let slope = 5.0_f64.sqrt();
    vec![
        (ball(0.5), [PI / 6.0, PI]),
        (Domain::cylinder([1.0, 0.0], 0.5, [-1.0, 2.0]).unwrap(), [0.75 * PI, 3.5 * PI]),
        // Its volume is a third of base times height; edges of 2 in the file, of 1 here.
        (Domain::solid(&tetrahedron(false), 0.5).unwrap(), [1.0 / 6.0, 1.5 + 3.0_f64.sqrt() / 2.0]),
        (Domain::solid(&tetrahedron(true), 0.5).unwrap(), [1.0 / 6.0, 1.5 + 3.0_f64.sqrt() / 2.0]),
        (square(0.0, 1.0).minus(disc(0.5)).unwrap(), [1.0 - PI / 16.0, 4.0 + PI / 2.0]),
        // Half of the disc is outside: its edge there bounds the sum, and the side below it no more.
        (square(0.0, 1.0).plus(disc(1.0)).unwrap(), [1.0 + PI / 32.0, 3.5 + PI / 4.0]),
        (square(0.0, 1.0).minus(disc(1.0)).unwrap(), [1.0 - PI / 32.0, 3.5 + PI / 4.0]),
        // Boundaries that run along each other.
        (square(0.0, 1.0).plus(square(1.0, 3.0)).unwrap(), [3.0, 8.0]),
        (square(0.0, 2.0).plus(square(1.0, 3.0)).unwrap(), [3.0, 8.0]),
        (square(0.0, 3.0).minus(square(1.0, 3.0)).unwrap(), [1.0, 4.0]),
        (ball(0.5).minus(ball(0.25)).unwrap(), [PI / 6.0 * 0.875, 1.25 * PI]),
        (Domain::polygon(&[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]).unwrap().minus(disc(9.0)).unwrap(), [1.0, 3.0 + slope]),
    ]
}

#[test]
fn bodies_have_their_sizes_and_points_in_their_places() {
    for (domain, [inside, around]) in bodies() {
        close(domain.measure(), inside, 2e-3);
        close(domain.boundary_measure(), around, 2e-3);
        let points = domain.interior(700, Sampling::Sobol, 3);
        assert!(points.len() == 700 && points.iter().all(|point| domain.contains(point)), "{domain:?}");
        close(integral(&points, |_| 1.0), inside, 2e-3);
        let (low, high) = domain.bounds();
        let middle: f64 = low.iter().zip(&high).map(|(a, b)| (a + b) / 2.0).sum();
        let edge = domain.boundary(3000);
        assert!((2700..3300).contains(&edge.len()), "{} points: {domain:?}", edge.len());
        let (mut flux, dim) = (0.0, domain.dim());
        for (at, point) in edge.iter().enumerate() {
            let normal = edge.normal(at).unwrap();
            close(normal.iter().map(|n| n * n).sum(), 1.0, 1e-9);
            let beside = |way: f64| -> Vec<f64> { point.iter().zip(normal).map(|(x, n)| x + way * n).collect() };
            assert!(domain.contains(&beside(-1e-6)) && !domain.contains(&beside(1e-6)), "{point:?} of {domain:?}");
            let along = point.iter().zip(normal).map(|(x, n)| (x - middle / dim as f64) * n).sum::<f64>();
            flux += edge.weights.as_ref().unwrap()[at] * along;
        }
        // The divergence theorem.
        close(flux, dim as f64 * inside, 1e-2);
    }
}

#[test]
fn a_surface_with_a_hole_is_no_solid() {
    let mut open = tetrahedron(false);
    open.triangles.pop();
    let error = Domain::solid(&open, 1.0).unwrap_err().to_string();
    assert!(error.contains("not closed: 3 edges"), "{error}");
    assert!(Domain::ball([0.0; 3], -1.0).is_err());
    let (interval, disc) = (Domain::interval(0.0, 1.0).unwrap(), Domain::disc([0.0; 2], 1.0).unwrap());
    assert!(disc.clone().plus(interval).is_err());
    assert!(disc.clone().minus(disc.clone()).unwrap_err().to_string().contains("nothing of the region is left"));
    // A size that is found by points is not quite none.
    let around = Domain::ellipse([0.1, 0.2], [7.0, 5.0]).unwrap();
    assert!(disc.minus(around).unwrap_err().to_string().contains("nothing of the region is left"));
}

#[test]
fn points_lie_inside_and_weights_add_up() {
    for domain in plane_and_solid() {
        for sampling in [Sampling::Uniform, Sampling::Sobol, Sampling::LatinHypercube, Sampling::Grid] {
            let points = domain.interior(500, sampling, 7);
            if sampling != Sampling::Grid {
                assert_eq!(points.len(), 500);
                assert_ne!(points, domain.interior(500, sampling, 8));
            }
            assert!((400..600).contains(&points.len()));
            assert!(points.iter().all(|point| domain.contains(point)), "{domain:?} {sampling:?}");
            close(integral(&points, |_| 1.0), domain.measure(), 1e-12);
            assert_eq!(points, domain.interior(500, sampling, 7));
        }
    }
}

#[test]
fn quadrature_matches_closed_forms() {
    let ellipse = Domain::ellipse([0.0, 0.0], [2.0, 1.0]).unwrap();
    for (sampling, tolerance) in [(Sampling::Uniform, 0.05), (Sampling::Sobol, 4e-3), (Sampling::Grid, 2e-3)] {
        let points = ellipse.interior(2000, sampling, 1);
        close(integral(&points, |p| p[0] * p[0]), PI * 8.0 / 4.0, tolerance);
    }
    let solid = Domain::cuboid(&[0.0; 3], &[1.0, 2.0, 3.0]).unwrap().interior(4000, Sampling::Sobol, 1);
    close(integral(&solid, |p| p[0] * p[1] * p[2]), 0.5 * 2.0 * 4.5, 1e-2);
}

/// The divergence theorem ties points, normals and weights of the boundary to the area inside.
#[test]
fn boundaries_close() {
    for domain in plane_and_solid() {
        let points = domain.boundary(3000);
        let normals = points.normals.clone().unwrap();
        let weights = points.weights.clone().unwrap();
        let dim = domain.dim();
        let flux: f64 = (0..points.len())
            .map(|i| weights[i] * (0..dim).map(|k| points.coords[i * dim + k] * normals[i * dim + k]).sum::<f64>())
            .sum();
        close(flux, dim as f64 * domain.measure(), 1e-5);
        close(integral(&points, |_| 1.0), domain.boundary_measure(), 1e-12);
        assert!(normals.chunks(dim).all(|n| (n.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12));
    }
    close(Domain::disc([0.0, 0.0], 2.0).unwrap().boundary_measure(), 4.0 * PI, 1e-13);
    close(Domain::ellipse([0.0, 0.0], [0.06, 0.04]).unwrap().boundary_measure(), 0.317_309, 1e-5);
}

#[test]
fn one_face_can_be_taken() {
    let cube = Domain::cuboid(&[-0.023, -0.023, -0.046], &[0.023, 0.023, 0.0]).unwrap();
    let bottom = cube.boundary(2400).select(|_, normal| normal[2] < -0.5);
    assert_eq!(bottom.len(), 400);
    assert!(bottom.column(2).iter().all(|&z| z == -0.046));
    close(integral(&bottom, |_| 1.0), 0.046 * 0.046, 1e-12);
}

#[test]
fn resampling_follows_the_residual() {
    let candidates = Domain::interval(0.0, 1.0).unwrap().interior(4000, Sampling::Sobol, 1);
    let residuals: Vec<f64> = candidates.iter().map(|p| if p[0] < 0.1 { 9.0 } else { 1.0 }).collect();
    let chosen = resample(&candidates, &residuals, 400, 1.0, 0.0, 5).unwrap();
    let near = chosen.iter().filter(|p| p[0] < 0.1).count();
    assert!((160..220).contains(&near), "{near} of 400 where half is expected, less what runs out");
    assert_eq!(resample(&candidates, &vec![0.0; 4000], 10, 1.0, 0.0, 5).unwrap().len(), 10);
    assert!(resample(&candidates, &[1.0], 10, 1.0, 0.0, 5).is_err());
}

#[test]
fn senseless_domains_are_refused() {
    assert!(Domain::interval(1.0, 1.0).is_err());
    assert!(Domain::cuboid(&[0.0], &[1.0, 2.0]).is_err());
    assert!(Domain::ellipse([0.0, 0.0], [1.0, f64::NAN]).is_err());
    assert!(Domain::polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).is_err());
}
