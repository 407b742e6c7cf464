//! Where local functions end: lattices without cells, units of weights, and steps to where an equation has no value.

use nisp::local::Local;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Points, Problem, Settings, recover, scene};

use crate::drum::*;

nisp::pde! {
    /// A load on a beam of which only the sum is known.
    pub mod load {
        coordinates:
            /// place
            x [mm];
        sources:
            /// load
            f [N/m];
        parameters:
            /// its sum
            F [N];

        on beam { even: d(f, x) == 0; total: integral(f) == F; }

        /// The even load.
        scene even_load { }
    }
}

#[test]
fn a_lattice_without_cells_is_refused() {
    let mut problem = Problem::new(scene::<load::even_load::Scene>());
    problem.set_parameter("F", 3.0).unwrap();
    problem.set_group("beam", vec![0.0, 1.0, 2.0].into(), Vec::new()).unwrap();
    let local = Local { cells: 0, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 1, patches: None };
    let settings = Settings { carrier: Carrier::Local(local), ..Settings::default() };
    let refused = recover(&problem, &settings, &mut |_| Flow::Continue).err().unwrap().to_string();
    assert!(refused.contains("fewer cells than a test"), "{refused}");
}

/// 3 N over 20 mm are 150 N/m, whatever the unit of the weights.
#[test]
fn weights_are_in_the_unit_of_the_coordinates() {
    let mut problem = Problem::new(scene::<load::even_load::Scene>());
    problem.set_parameter("F", 3.0).unwrap();
    let points: Vec<f64> = (0..40).map(|i| 0.5 * (f64::from(i) + 0.5)).collect();
    problem
        .set_group("beam", Points { coordinates: points, weights: vec![0.5; 40], ..Points::default() }, Vec::new())
        .unwrap();
    let settings = Settings { iterations: Some(300), ..Settings::default() };
    let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    for value in values(&solution.evaluate(&[1.0, 10.0, 19.0]), "f") {
        assert!((value - 150.0).abs() < 1e-3, "{value}");
    }
}

nisp::pde! {
    /// A drumhead under a ceiling, above which its equation has no value.
    pub mod low {
        coordinates:
            /// place
            x [mm],
            /// place
            y [mm];
        fields:
            /// height
            w [mm];
        parameters:
            /// tension
            T [N/m] in 1 .. 1000 = 20,
            /// pressure from below
            p [Pa],
            /// height of the ceiling
            c [mm];

        on interior { balance: -T * laplacian(w) == p + 1e-9 * p * sqrt(1 - w / c); }
        on surface { cloud: chamfer [x, y, w]; }
        on rim { held: w == 0; }

        /// The tension.
        scene under { learn T; }
    }
}

/// Data lead every step through the ceiling: all of them are taken back, and what is left is the state before.
#[test]
fn steps_into_places_without_a_value_are_taken_back_and_named() {
    let mut problem = Problem::new(scene::<low::under::Scene>());
    problem.set_parameter("c", 0.5 * height(0.0, 0.0, 1.0)).unwrap();
    bind(&mut problem, 0.0, 1.0, 0.0);
    let solution = solve(&problem, None, 2);
    assert_eq!(solution.status, Status::NotConverged);
    let named = |warning: &str| warning.contains("interior.balance") && warning.contains("point");
    assert!(solution.warnings.iter().any(|warning| named(&warning.message)), "{:?}", solution.warnings);
    assert!(values(&solution.evaluate(&disc(200)), "w").iter().all(|w| w.is_finite()));
}
