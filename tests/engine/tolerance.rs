//! How far rows may be off, where the user says so.

use nisp::network::Architecture;
use nisp::solve::objective::{BlockKind, LeastSquares};
use nisp::{Problem, scene};

use nisp_references::reference::engine;

nisp::pde! {
    mod beam {
        coordinates: x [m];
        fields: u [mm];
        sources: f [N/m^4];
        parameters: k [N/m^3] in 1 .. 9 = 5;
        on inside { balance: k * d(u, x, 2) == f within 20 [mN/m^4] weight 4; }
        on samples { observe u within 0.3 [mm]; observe rough: u ~ late [mm]; }
        on guess { prior: k == 4 [N/m^3] within 0.5 [N/m^3]; }
        scene recover { learn k; }
    }
}

#[test]
fn rows_are_divided_by_what_they_may_be_off_by() {
    let x: Vec<f64> = (0..20).map(|i| f64::from(i) * 0.1).collect();
    let u: Vec<f64> = x.iter().map(|x| x.sin()).collect();
    let mut problem = Problem::new(scene::<beam::recover::Scene>());
    problem.set_group("inside", x.clone().into(), vec![]).unwrap();
    problem.set_group("samples", x.into(), vec![u.clone(), u]).unwrap();
    problem.set_group("guess", vec![1.0].into(), vec![]).unwrap();
    let mut engine = engine::<f64>(&problem, Architecture::plain(5, 1));
    let theta = vec![0.0; engine.parameters()];
    let prior = engine.raw_rows(2, &theta)[0];
    let blocks = engine.blocks();
    // One newton per cubic metre off, in whatever unit the engine computes.
    assert!((prior / blocks[3].sigma - 1.0 / 0.5).abs() <= 1e-12, "{prior} {}", blocks[3].sigma);
    assert_eq!(blocks[3].kind, BlockKind::Equation);
    // Known noise is not estimated anew.
    assert_eq!(blocks[1].kind, BlockKind::Observation);
    assert_eq!(blocks[2].kind, BlockKind::ObservationOfUnknownNoise);
}

nisp::pde! {
    mod sheet {
        coordinates: x [m], y [m];
        fields: u: vector [m];
        sources: f: vector [N/m^3];
        parameters: E [Pa];
        on inside { balance: E * laplacian(u) == f; }
        on marks { columns: level [m]; observe height: u_x + u_y ~ level; observe u; }
        scene recover { }
    }
}

/// Noise is judged by columns, and belongs to the observations that compare with them.
#[test]
fn observations_know_their_columns() {
    let columns = |scene: nisp::SceneRef, group: usize| -> Vec<Vec<usize>> {
        scene.schema.groups[group].terms.iter().map(|term| term.columns.to_vec()).collect()
    };
    assert_eq!(columns(scene::<beam::recover::Scene>(), 1), [[0], [1]]);
    assert_eq!(columns(scene::<sheet::recover::Scene>(), 1), [vec![0], vec![1, 2]]);
    assert_eq!(columns(scene::<sheet::recover::Scene>(), 0), [[0; 0]]);
}
