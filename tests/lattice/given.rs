//! Given numbers that the data contradict, where a source takes over most of what is wrong with them.

use nisp_interpreter::interpret;

use super::some::measured_rod;
use super::sources::scattered;
use super::*;

interpret! {
    /// A rod that is warmed evenly all the time.
    pub mod warmed {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        parameters: a = 0.1;
        on inside { flow: d(u, t) == a * d(u, x, 2) + q; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// `u = (1 - exp(-r t)) sin(pi x)` with `r = 0.1 pi^2`: with another diffusivity a source makes the same warmth in the end, at another pace.
#[test]
fn a_diffusivity_that_is_wrong_is_named_with_what_it_should_be() {
    let rate = 0.1 * PI * PI;
    let found = |diffusivity: f64| {
        let mut normal = normals(8);
        let probes = scattered(300, [1.0, 2.0], 3);
        let warm = |[x, t]: [f64; 2]| (1.0 - (-rate * t).exp()) * (PI * x).sin();
        let measured = pairs(&probes).map(|place| warm(place) + 0.02 * normal()).collect();
        let mut problem = measured_rod(warmed::scene("recover"), probes, measured);
        problem.set_parameter("a", diffusivity).unwrap();
        solve(&problem)
    };
    let right = found(0.1);
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
    let wrong = found(0.12);
    assert_eq!(wrong.status, Status::Inconsistent);
    let check = wrong.verdict.failed().find(|check| check.check == "given").unwrap();
    assert!(check.message.contains("`a` about 9.") || check.message.contains("`a` about 1.0"), "{}", check.message);
}

interpret! {
    /// A slab that cools in air, of which conductivity and transfer are unknown: all three numbers may be larger alike.
    mod slab {
        units: off;
        coordinates: x, t: time;
        fields: u;
        parameters: c = 1.6, k > 0 = 1, h > 0 = 1;
        domains: slab = 0 .. 1 times 0 .. 1;
        on inside in slab { heat: c * d(u, t) == k * d(u, x, 2); }
        on faces boundary of slab { columns: normal: vector; cooled: -k * normal[0] * d(u, x) == h * u; }
        on begin start of slab { hot: u == 1; }
        on probes { observe u; }
        scene rates { learn k, h; }
    }
}

/// `u = sum of A cos(m (x - 1/2)) exp(-k m^2 t / c)` with `m tan(m / 2) = h / k`. What only scales with what is learned is told by nothing,
/// and contradicted by nothing, though cells are coarse where the cold sets in.
#[test]
fn a_capacity_that_only_scales_is_not_contradicted() {
    let (k, h, c) = (0.8, 2.0, 1.6);
    // Roots by bisection, between the poles of the tangent.
    let root = |n: i32| {
        let (mut low, mut high) = (2.0 * PI * f64::from(n) + 1e-9, 2.0 * PI * f64::from(n) + PI - 1e-9);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if middle * (middle / 2.0).tan() < h / k { low = middle } else { high = middle }
        }
        low
    };
    let modes: Vec<[f64; 2]> = (0..12).map(root).map(|m| [m, 4.0 * (m / 2.0).sin() / (m + m.sin())]).collect();
    let warm = |[x, t]: [f64; 2]| -> f64 {
        modes.iter().map(|[m, a]| a * (m * (x - 0.5)).cos() * (-k * m * m * t / c).exp()).sum()
    };
    let mut noise = normals(5);
    let probes: Vec<f64> = (0..120).flat_map(|at| [[0.1, 0.5, 0.8][at % 3], (at / 3 + 1) as f64 / 40.0]).collect();
    let measured = pairs(&probes).map(|place| warm(place) + 0.004 * noise()).collect();
    let mut problem = Problem::new(slab::scene("rates"));
    let along = |count: usize| (0..count).map(move |i| i as f64 / (count - 1) as f64);
    problem.set_group("inside", grid([32, 32], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("begin", along(41).flat_map(|s| [s, 0.0]).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let faces: Vec<f64> = along(41).flat_map(|s| [0.0, s, 1.0, s]).collect();
    let normal: Vec<f64> = along(41).flat_map(|_| [-1.0, 1.0]).collect();
    problem.set_group("faces", faces.into(), vec![normal]).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    for (learned, exact) in solution.learned().iter().zip([k, h]) {
        assert!((learned.value - exact).abs() < 4.0 * learned.deviation.unwrap(), "{learned:?} is not {exact}");
    }
}
