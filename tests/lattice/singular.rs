//! Sources beside places where fields are singular though all conditions agree: a corner of the domain that points inwards, and the end of
//! the part of a side that is held.

use nisp_interpreter::interpret;

use super::sources::{judged, scattered};
use super::*;

interpret! {
    /// A sheet with a corner cut out, held all around.
    pub mod ell {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: q;
        on inside { balance: laplacian(u) == -q; }
        on edge { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

interpret! {
    /// A sheet that is held all around but on half of a side.
    pub mod half {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: q;
        on inside { balance: laplacian(u) == -q; }
        on edge { held: u == 0; }
        on shut { free: d(u, y) == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// The field `r^n sin(n angle) (1 - x^2) (1 - y^2)`, which is zero where the sine is and on the sides at one, and the source that makes it: its
/// first two factors are harmonic.
fn exact(n: f64, [x, y]: [f64; 2]) -> (f64, f64) {
    let (r, angle) = (x.hypot(y), y.atan2(x).rem_euclid(2.0 * PI));
    let harmonic = r.powf(n) * (n * angle).sin();
    let slope = n * r.powf(n - 1.0);
    let [along, across] = [slope * ((n - 1.0) * angle).sin(), slope * ((n - 1.0) * angle).cos()];
    let (a, b) = (1.0 - x * x, 1.0 - y * y);
    let laplacian = -4.0 * (along * x * b + across * y * a) - 2.0 * harmonic * (a + b);
    (harmonic * a * b, -laplacian)
}

/// Points of the sheet from -1 to 1 where something is true, of such as are spread over the unit square.
fn spread(points: Vec<f64>, counts: impl Fn(f64, f64) -> bool) -> Vec<f64> {
    let all = pairs(&points).map(|point| point.map(|x| 2.0 * x - 1.0)).collect::<Vec<[f64; 2]>>();
    all.into_iter().filter(|&[x, y]| counts(x, y)).flatten().collect()
}

/// How far the source is off, over its size, and the share of it within two deviations, from some hundred probes of a sheet where something
/// is true.
fn solved(mut problem: Problem, n: f64, counts: impl Fn(f64, f64) -> bool) -> (f64, f64) {
    problem.set_group("inside", spread(grid([40, 40], [1.0, 1.0], true), &counts).into(), Vec::new()).unwrap();
    let probes = spread(scattered(160, [1.0, 1.0], 32), &counts);
    let mut normal = normals(31);
    let values: Vec<f64> = pairs(&probes).map(|point| exact(n, point).0).collect();
    let noise = 0.01 * root_mean_square(values.iter().copied());
    let measured = values.iter().map(|value| value + noise * normal()).collect();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    let is_told = solution.warnings.iter().any(|own| own.message.contains("fields are not smooth about"));
    assert!(is_told, "{:?}", solution.warnings);
    judged(&mut solution, "q", &spread(scattered(400, [1.0, 1.0], 33), counts), &|point| exact(n, point).1)
}

fn along(from: [f64; 2], to: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    (0..count).flat_map(move |at| {
        let share = (at as f64 + 0.5) / count as f64;
        [0, 1].map(|axis| from[axis] * (1.0 - share) + to[axis] * share)
    })
}

#[test]
fn a_corner_that_points_inwards_makes_up_no_source() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]];
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let edge: Vec<f64> = sides.flat_map(|(from, to)| along(*from, *to, 60)).collect();
    let mut problem = Problem::new(ell::scene("recover"));
    problem.set_group("edge", edge.into(), Vec::new()).unwrap();
    let (off, within) = solved(problem, 2.0 / 3.0, |x, y| x < 0.0 || y > 0.0);
    assert!(off < 0.12 && within > 0.9, "{off} {within}");
}

#[test]
fn the_end_of_a_part_that_is_held_makes_up_no_source() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]];
    let sides = corners.iter().zip(&corners[1..]);
    let edge: Vec<f64> = sides.flat_map(|(from, to)| along(*from, *to, 60)).collect();
    let mut problem = Problem::new(half::scene("recover"));
    problem.set_group("edge", edge.into(), Vec::new()).unwrap();
    problem.set_group("shut", along([-1.0, 0.0], [0.0, 0.0], 60).collect::<Vec<f64>>().into(), Vec::new()).unwrap();
    let (off, within) = solved(problem, 0.5, |_, y| y > 0.0);
    assert!(off < 0.12 && within > 0.9, "{off} {within}");
}
