//! Conditions that contradict each other where they meet: a wall that is suddenly hot, sides of a square at different values, a flux that is
//! switched on.

use nisp_interpreter::interpret;

use super::*;

interpret! {
    /// A slab whose faces are suddenly at another temperature.
    pub mod slab {
        units: off;
        coordinates: x, t: time;
        fields: u;
        parameters: a > 0 = 0.3, wall = 1;
        on inside { heat: d(u, t) == a * d(u, x, 2); }
        on faces { hot: u == wall; }
        on begin { cold: u == 0; }
        on probes { observe u; }
        scene diffusivity { learn a; }
    }
}

interpret! {
    /// A square with one side at another temperature than the others.
    pub mod square {
        units: off;
        coordinates: x, y;
        fields: u;
        parameters: side = 2;
        on inside { steady: laplacian(u) == 0; }
        on left { hot: u == side; }
        on others { cold: u == 0; }
        on probes { observe u; }
        scene temperature { learn side; }
    }
}

interpret! {
    /// A thick wall that is heated from the start on.
    pub mod heated {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(t);
        on inside { heat: d(u, t) == 0.1 * d(u, x, 2); }
        on face { flux: d(u, x) == -q; }
        on far { cold: u == 0; }
        on begin { even: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

const NOISE: f64 = 0.005;

fn along(count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| i as f64 / (count - 1) as f64)
}

/// `u = 1 - sum 4 / (n pi) sin(n pi x) exp(-a (n pi)^2 t)` over odd `n`.
fn slab(rate: f64, wall: f64) -> Solution {
    let term = |n: f64, [x, t]: [f64; 2]| (n * PI * x).sin() * (-rate * (n * PI).powi(2) * t).exp() / n;
    let exact = |place: [f64; 2]| 1.0 - 4.0 / PI * (0..200).map(|k| term(f64::from(2 * k + 1), place)).sum::<f64>();
    let mut normal = normals(1);
    let probes: Vec<f64> = [0.1, 0.25, 0.5].iter().flat_map(|&x| along(41).skip(1).flat_map(move |t| [x, t])).collect();
    let measured = pairs(&probes).map(|place| exact(place) + NOISE * normal()).collect();
    let faces = [0.0, 1.0].iter().flat_map(|&x| along(80).flat_map(move |t| [x, t])).collect::<Vec<f64>>();
    let mut problem = Problem::new(slab::scene("diffusivity"));
    problem.set_parameter("wall", wall).unwrap();
    problem.set_group("inside", grid([30, 30], [1.0, 1.0], true).into(), Vec::new()).unwrap();
    problem.set_group("faces", faces.into(), Vec::new()).unwrap();
    problem.set_group("begin", along(80).flat_map(|x| [x, 0.0]).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    solve(&problem)
}

#[test]
fn a_wall_that_is_suddenly_hot_tells_the_diffusivity() {
    let mut solution = slab(0.2, 1.0);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let learned = solution.learned();
    let (rate, deviation) = (learned[0].value, learned[0].deviation.unwrap());
    assert!((rate - 0.2).abs() < 3.0 * deviation && deviation < 0.02 * 0.2, "{rate} {deviation}");
    assert!(solution.warnings.iter().any(|own| own.message.contains("`faces` and `begin`")), "{:?}", solution.warnings);
}

/// Conditions that hold in the mean are asked all the same.
#[test]
fn a_wall_that_is_not_as_hot_is_inconsistent() {
    assert_eq!(slab(0.2, 0.8).status, Status::Inconsistent);
}

/// `u = sum 4 / (n pi) sin(n pi y) sinh(n pi (1 - x)) / sinh(n pi)` over odd `n`.
#[test]
fn corners_of_a_square_may_have_two_values() {
    let term = |n: f64, [x, y]: [f64; 2]| {
        let sinh = (-n * PI * x).exp() * (1.0 - (-2.0 * n * PI * (1.0 - x)).exp()) / (1.0 - (-2.0 * n * PI).exp());
        (n * PI * y).sin() * sinh / n
    };
    let exact = |place: [f64; 2]| 4.0 / PI * (0..200).map(|k| term(f64::from(2 * k + 1), place)).sum::<f64>();
    let mut normal = normals(2);
    let probes: Vec<f64> =
        (1..10).flat_map(|i| (1..10).flat_map(move |j| [0.1 * f64::from(i), 0.1 * f64::from(j)])).collect();
    let measured = pairs(&probes).map(|place| exact(place) + NOISE * normal()).collect();
    let left: Vec<f64> = along(80).flat_map(|y| [0.0, y]).collect();
    let others: Vec<f64> = along(80).flat_map(|x| [x, 0.0, x, 1.0, 1.0, x]).collect();
    let mut problem = Problem::new(square::scene("temperature"));
    problem.set_group("inside", grid([30, 30], [1.0, 1.0], true).into(), Vec::new()).unwrap();
    problem.set_group("left", left.into(), Vec::new()).unwrap();
    problem.set_group("others", others.into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let learned = solution.learned();
    let (side, deviation) = (learned[0].value, learned[0].deviation.unwrap());
    assert!((side - 1.0).abs() < 3.0 * deviation && deviation < 0.02, "{side} {deviation}");
}

/// `u = sqrt(a t) f(x / sqrt(a t))` far from the other end (Carslaw and Jaeger, 2.9), with the integral of the complementary error function.
#[test]
fn a_flux_that_is_switched_on_is_found_from_the_start() {
    let exact = |[x, t]: [f64; 2]| {
        let reach = (0.1 * t).sqrt();
        let at = 0.5 * x / reach;
        let tail = |z: f64| 2.0 / PI.sqrt() * (-z * z).exp();
        let (steps, far) = (2000, at + 6.0);
        let width = (far - at) / f64::from(steps);
        let erfc = (0..steps).map(|i| width * tail(at + (f64::from(i) + 0.5) * width)).sum::<f64>();
        2.0 * reach / PI.sqrt() * (-at * at).exp() - x * erfc
    };
    let mut normal = normals(3);
    let probes: Vec<f64> = [0.1, 0.3].iter().flat_map(|&x| along(61).skip(1).flat_map(move |t| [x, t])).collect();
    let measured = pairs(&probes).map(|place| exact(place) + 0.001 * normal()).collect();
    let wide = |points: Vec<f64>| pairs(&points).flat_map(|[x, t]| [2.0 * x, t]).collect::<Vec<f64>>();
    let side = |x: f64| along(80).flat_map(move |t| [x, t]).collect::<Vec<f64>>();
    let mut problem = Problem::new(heated::scene("recover"));
    problem.set_group("inside", wide(grid([30, 30], [1.0, 1.0], true)).into(), Vec::new()).unwrap();
    problem.set_group("face", side(0.0).into(), Vec::new()).unwrap();
    problem.set_group("far", side(2.0).into(), Vec::new()).unwrap();
    problem.set_group("begin", wide(along(80).flat_map(|x| [x, 0.0]).collect()).into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    // The flux is sought, so that it may be what the start needs.
    assert!(solution.warnings.iter().all(|own| !own.message.contains("`begin`")), "{:?}", solution.warnings);
    let places: Vec<f64> = (0..20).flat_map(|i| [0.0, 0.025 + 0.05 * f64::from(i)]).collect();
    let (found, _) = values(&mut solution, "q", &places);
    let off = found.iter().map(|q| (q - 1.0).powi(2)).sum::<f64>() / 20.0;
    assert!(off.sqrt() < 0.05, "{off} {found:?}");
}
