//! Sources with edges and smooth ones: the measurements say which of them a source is, and bars are as long as that asks for.

use super::some::{pressed, rod};
use super::sources::{bulge, bulged};
use super::*;

/// A string of which a part is pressed evenly: the load is a sum of waves, each of which lifts the string by one that swings.
fn bars_hold_at_the_edges(noise: f64) {
    let (first, last) = (0.2, 0.56);
    let load = |x: f64| if (first..last).contains(&x) { 1.0 } else { 0.0 };
    let wave = |n: f64| 2.0 * ((n * PI * first).cos() - (n * PI * last).cos()) / (n * PI);
    let lifted =
        |n: f64, [x, t]: [f64; 2]| wave(n) * (n * PI * x).sin() * (1.0 - (n * PI * t).cos()) / (n * PI).powi(2);
    let exact = |place| (1..200).map(|n| lifted(f64::from(n), place)).sum::<f64>();
    let mut solution = solve(&rod(pressed::scene("recover"), noise, exact));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places: Vec<f64> = (1..200).flat_map(|i| [0.005 * f64::from(i), 1.0]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let off = found.iter().zip(pairs(&places)).map(|(found, [x, _])| (found - load(x)).abs());
    let over: Vec<f64> = off.zip(deviations.unwrap()).map(|(off, deviation)| off / deviation).collect();
    let share = |most: f64| over.iter().filter(|over| **over > most).count() as f64 / over.len() as f64;
    assert!(share(2.0) < 0.12 && share(4.0) < 0.02, "{} beyond two, {} beyond four", share(2.0), share(4.0));
}

#[test]
fn bars_hold_at_the_edges_of_a_load() {
    bars_hold_at_the_edges(3e-3);
}

/// Under such noise edges are told from a smooth load by little.
#[test]
fn bars_hold_at_edges_that_noise_hides() {
    bars_hold_at_the_edges(3e-2);
}

/// A load of `5 pi^2 sin(pi x) sin(2 pi y)` has no edges, and no bars of one that has.
#[test]
fn bars_of_a_smooth_load_are_those_of_one() {
    let mut solution = solve(&bulged(600, 0.0015, [31, 32]));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.checks);
    let places = grid([20, 20], [1.0, 1.0], false);
    let (found, deviations) = values(&mut solution, "f", &places);
    let exact = |place| 5.0 * PI * PI * bulge(place);
    let off = root_mean_square(found.iter().zip(pairs(&places)).map(|(found, place)| found - exact(place)));
    let bars = root_mean_square(deviations.unwrap().into_iter());
    assert!(off < 2.0 * bars && bars < 2.5 * off, "{off} {bars}");
}
