//! Geometry against closed forms.

use std::f64::consts::PI;

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
