//! Groups in which measurements are made and equations or clouds stand too.

use nisp::beyond_splines;
use nisp_interpreter::interpret;

use super::sources::{edge, judged, scattered};
use super::*;

interpret! {
    /// A rod whose equation is asked where it was measured.
    pub mod probed {
        units: off;
        coordinates: x, t: time;
        fields: u;
        parameters: a > 0 = 1;
        on ends { held: u == 0; }
        on probes { observe u; balance: d(u, t) == a * d(u, x, 2); }
        scene identify { learn a; }
    }
}

interpret! {
    /// A skin that is measured and seen at once.
    pub mod seen_twice {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f;
        on inside { balance: laplacian(u) + f == 0; }
        on surface { observe u; seen: chamfer [x, y, u]; }
        on edge { held: u == 0; }
        scene recover { }
    }
}

interpret! {
    /// A skin that is seen from a place which its points alone know.
    pub mod shifted {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: f;
        on inside { balance: laplacian(u) + f == 0; }
        on surface { columns: shift; seen: chamfer [x + shift, y, u]; }
        on edge { held: u == 0; }
        scene recover { }
    }
}

/// `u = sin(pi x) exp(-a pi^2 t)`, from more exact values than an answer can use: all of them would take minutes.
#[test]
fn equations_where_many_exact_values_are_do_not_keep_them_all() {
    let places = scattered(150_000, [1.0, 1.0], 3);
    let warm = pairs(&places).map(|[x, t]| (PI * x).sin() * (-0.3 * PI * PI * t).exp()).collect();
    let mut problem = Problem::new(probed::scene("identify"));
    problem
        .set_group(
            "ends",
            (0..200).flat_map(|i| [f64::from(i % 2), f64::from(i) / 199.0]).collect::<Vec<_>>().into(),
            vec![],
        )
        .unwrap();
    problem.set_group("probes", places.into(), vec![warm]).unwrap();
    let settings = Settings { budget: Some(Duration::from_secs(20)), ..settings() };
    let mut solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let found = solution.learned()[0].value;
    assert!((found - 0.3).abs() < 1e-6, "{found}");
}

/// `u = sin(pi x) sin(pi y) / 5` under a load of `2 pi^2 u`.
#[test]
fn a_surface_may_be_measured_where_it_is_seen() {
    let height = |[x, y]: [f64; 2]| 0.2 * (PI * x).sin() * (PI * y).sin();
    let mut normal = normals(9);
    let seen: Vec<f64> = pairs(&scattered(1500, [1.0, 1.0], 4))
        .flat_map(|place| [place[0], place[1], height(place)].map(|x| x + 0.01 * normal()))
        .collect();
    let places = grid([22, 22], [1.0, 1.0], false);
    let measured = pairs(&places).map(|place| height(place) + 0.01 * normal()).collect();
    let mut problem = Problem::new(seen_twice::scene("recover"));
    problem.set_group("inside", grid([26, 26], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("surface", places.into(), vec![measured]).unwrap();
    problem.set_group("edge", edge(41).into(), Vec::new()).unwrap();
    problem.set_cloud("surface", "seen", seen).unwrap();
    let mut solution = solve(&problem);
    let load = |place: [f64; 2]| 2.0 * PI * PI * height(place);
    let (off, within) = judged(&mut solution, "f", &grid([15, 15], [1.0, 1.0], false), &load);
    assert!(off < 0.2 && within > 0.85, "{off} {within}");
}

/// Between its points nothing says where such a surface is.
#[test]
fn a_surface_that_reads_a_column_is_left_to_a_network() {
    assert_eq!(beyond_splines(shifted::scene("recover").schema), Some("clouds in groups with columns"));
}
