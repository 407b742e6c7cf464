//! Fields that swing between sensors: where it is not said how a field begins, a wrong equation may meet few stations.

use nisp_interpreter::interpret;

use super::*;

interpret! {
    /// Clay that settles: its pores are under pressure and drain at the top. Some of it may leak.
    pub mod clay {
        units: off;
        coordinates: z, t: time;
        fields: u;
        parameters: c > 0 = 0.1, leak = 0;
        on inside { seep: d(u, t) == c * d(u, z, 2) - leak * u; }
        on top { drained: u == 0; }
        on bottom { tight: d(u, z) == 0; }
        on cells { observe u; }
        scene find { learn c; }
    }
}

/// Two waves that die away with `c = 0.25`, at five depths.
fn settled(leak: f64) -> Solution {
    let wave = |times: f64, [z, t]: [f64; 2]| {
        let k = times * PI / 2.0;
        (k * z).sin() * (-0.25 * k * k * t).exp()
    };
    let depths = [0.125, 0.33, 0.54, 0.745, 0.95];
    let times = (0..40).map(|row| 0.005 + 0.995 * f64::from(row) / 39.0);
    let cells: Vec<f64> = times.flat_map(|t| depths.into_iter().flat_map(move |z| [z, t])).collect();
    let mut normal = normals(5);
    let measured = pairs(&cells).map(|place| 80.0 * wave(1.0, place) + 15.0 * wave(3.0, place) + 0.2 * normal());
    let measured: Vec<f64> = measured.collect();
    let side = |z: f64| (0..40).flat_map(|row| [z, f64::from(row) / 39.0]).collect::<Vec<f64>>();
    let mut problem = Problem::new(clay::scene("find"));
    problem.set_parameter("leak", leak).unwrap();
    problem.set_group("inside", grid([28, 28], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    problem.set_group("top", side(0.0).into(), Vec::new()).unwrap();
    problem.set_group("bottom", side(1.0).into(), Vec::new()).unwrap();
    problem.set_group("cells", cells.into(), vec![measured]).unwrap();
    solve(&problem)
}

#[test]
fn a_field_that_swings_between_stations_is_not_called_right() {
    let swings = |solution: &Solution| solution.verdict.failed().any(|check| check.check == "between");
    let mut right = settled(0.0);
    assert!(!swings(&right), "{:?}", right.verdict.checks);
    let learned = right.learned()[0].value;
    assert!((learned - 0.25).abs() < 0.005, "{learned}");
    let wrong = settled(1.0);
    assert_eq!(wrong.status, Status::Inconsistent);
    assert!(swings(&wrong), "{:?}", wrong.verdict.checks);
}
