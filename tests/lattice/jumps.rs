//! Sources that act on a part of the domain: second derivatives jump at its sides, which splines do not follow.

use nisp_interpreter::interpret;

use super::sources::scattered;
use super::*;

interpret! {
    /// A square that is heated on a disc about its middle.
    pub mod warmed_unknown {
        units: off;
        coordinates: x, y;
        fields: u;
        parameters: q = 1, r2 = 0.25;
        let inside_of_it = (1 - sign(x^2 + y^2 - r2)) / 2;
        on inside { balance: laplacian(u) == -q * inside_of_it; }
        on edge { columns: target; held: u == target; }
        on probes { observe u; }
        scene strength { learn q; }
    }
}

interpret! {
    /// A rod that is heated on a part of it.
    pub mod warmed_rod {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(t);
        let part = (sign(x - 0.3) - sign(x - 0.55)) / 2;
        on inside { flow: d(u, t) == 0.1 * d(u, x, 2) + q * part; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// With a source of one inside of a disc of radius a half: `-r^2 / 4` inside, `-(1 + 2 ln(2 r)) / 16` outside.
fn disc([x, y]: [f64; 2]) -> f64 {
    let square = x * x + y * y;
    if square < 0.25 { -square / 4.0 } else { -(1.0 + (4.0 * square).ln()) / 16.0 }
}

/// The square from -1 to 1 with what the field is at its edge.
fn square(scene: SceneRef) -> Problem {
    let moved = |points: Vec<f64>| points.into_iter().map(|x| x - 1.0).collect::<Vec<f64>>();
    let edge = (0..257).map(|i| f64::from(i) / 128.0).flat_map(|s| [s, 0.0, s, 2.0, 0.0, s, 2.0, s]);
    let edge = moved(edge.collect());
    let target = pairs(&edge).map(disc).collect();
    let mut problem = Problem::new(scene);
    problem.set_group("inside", moved(grid([30, 30], [2.0, 2.0], false)).into(), Vec::new()).unwrap();
    problem.set_group("edge", edge.into(), vec![target]).unwrap();
    problem
}

fn probed(noise: f64, square_of_radius: f64) -> Problem {
    let mut normal = normals(7);
    let mut problem = square(warmed_unknown::scene("strength"));
    let probes: Vec<f64> = scattered(150, [2.0, 2.0], 3).into_iter().map(|x| x - 1.0).collect();
    let values = pairs(&probes).map(|place| disc(place) + noise * normal()).collect();
    problem.set_group("probes", probes.into(), vec![values]).unwrap();
    problem.set_parameter("r2", square_of_radius).unwrap();
    problem
}

#[test]
fn the_strength_of_a_source_on_a_disc_is_found_with_bars_that_hold() {
    let mut solution = solve(&probed(0.002, 0.25));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let found = solution.learned().swap_remove(0);
    let deviation = found.deviation.unwrap();
    assert!((found.value - 1.0).abs() < 3.0 * deviation && deviation < 0.03, "{} {deviation}", found.value);
    let places: Vec<f64> = grid([30, 30], [2.0, 2.0], false).into_iter().map(|x| x - 1.0).collect();
    let (field, _) = values(&mut solution, "u", &places);
    let off = root_mean_square(field.iter().zip(pairs(&places)).map(|(u, place)| u - disc(place)));
    assert!(off < 0.002, "{off}");
}

#[test]
fn a_source_on_a_smaller_disc_is_noticed() {
    assert_ne!(solve(&probed(0.0005, 0.05)).status, Status::Converged);
}

/// What varies with the time is a sum of sines along the rod, each of which answers the source like a first-order lag.
#[test]
fn a_source_on_a_part_of_a_rod_is_found_over_time() {
    let source = |t: f64| 1.0 + t.sin();
    let exact = |[x, t]: [f64; 2]| {
        let wave = |n: i32| {
            let k = f64::from(n) * PI;
            let rate = 0.1 * k * k;
            let part = 2.0 * ((0.3 * k).cos() - (0.55 * k).cos()) / k;
            let decay = (-rate * t).exp();
            let answer = (1.0 - decay) / rate + (rate * t.sin() - t.cos() + decay) / (rate * rate + 1.0);
            part * answer * (k * x).sin()
        };
        (1..400).map(wave).sum::<f64>()
    };
    let mut solution = solve(&some::rod(warmed_rod::scene("recover"), 0.01, exact));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places: Vec<f64> = (0..40).flat_map(|i| [0.5, 0.05 * (f64::from(i) + 0.5)]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let off: Vec<f64> = found.iter().zip(pairs(&places)).map(|(q, [_, t])| q - source(t)).collect();
    assert!(root_mean_square(off.iter().copied()) < 0.08, "{}", root_mean_square(off.iter().copied()));
    let within = off.iter().zip(&deviations.unwrap()).filter(|(off, bar)| off.abs() <= 2.0 * **bar).count();
    assert!(within >= 34, "{within} of 40");
}
