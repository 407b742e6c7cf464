//! Rows that reach across the cells: integrals, which all cells share, and conditions between points and their partners.

use super::*;
use nisp::Points;
use nisp_interpreter::interpret;

interpret! {
    /// A string between two posts that something presses, whose weight is known as a whole.
    pub mod laden {
        units: off;
        coordinates: x;
        fields: w, bend;
        sources: q;
        parameters: tension = 1, weight = 1, area = 1;
        on span {
            balance: tension * d(w, x, 2) == -q;
            curve: bend == d(w, x, 2);
            whole: integral(q) == weight;
            under: integral(w) == area;
        }
        on posts { held: w == 0; }
        on probes { observe w; }
        scene stiffness { only span.balance, span.whole, posts, probes; learn tension; }
        scene volume { only span.balance, span.curve, span.under, posts, probes; }
    }
}

interpret! {
    /// A ring that something warms always in the same way.
    pub mod ring {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        on inside { flow: d(u, t) == 0.1 * d(u, x, 2) + q; }
        on seam pairs { value: u == partner(u); slope: d(u, x) == partner(d(u, x)); }
        on begin { cold: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

const NOISE: f64 = 0.005;
const TENSION: f64 = 0.7;

/// `w = sin(pi x)` belongs to `q = tension pi^2 sin(pi x)`, which is `2 pi tension` in all; below it are `2 / pi`.
fn string(scene: SceneRef, (known, value): (&str, f64)) -> Problem {
    let mut normal = normals(4);
    let along = |count: usize| (0..count).map(|i| i as f64 / (count - 1) as f64).collect::<Vec<f64>>();
    let (span, probes) = (along(101), along(31));
    let measured = probes.iter().map(|x| (PI * x).sin() + NOISE * normal()).collect();
    let weights = span.iter().map(|x| if *x == 0.0 || *x == 1.0 { 0.005 } else { 0.01 }).collect();
    let mut problem = Problem::new(scene);
    problem.set_parameter(known, value).unwrap();
    problem.set_group("span", Points { coordinates: span, weights, ..Points::default() }, Vec::new()).unwrap();
    problem.set_group("posts", vec![0.0, 1.0].into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    problem
}

/// The shape alone says nothing of the tension.
#[test]
fn a_weight_that_is_known_as_a_whole_tells_the_tension() {
    let mut solution = solve(&string(laden::scene("stiffness"), ("weight", 2.0 * PI * TENSION)));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let learned = solution.learned();
    let (tension, deviation) = (learned[0].value, learned[0].deviation.unwrap());
    assert!((tension - TENSION).abs() < 3.0 * deviation && deviation < 0.05 * TENSION, "{tension} {deviation}");
}

#[test]
fn a_whole_that_the_data_contradict_is_inconsistent() {
    let of = |area: f64| solve(&string(laden::scene("volume"), ("area", area)));
    assert_eq!(of(2.0 / PI).status, Status::Converged);
    assert_eq!(of(2.4 / PI).status, Status::Inconsistent);
}

/// `u = (1 - exp(-r t)) / r sin(2 pi (x - 0.1))` with `r = 0.4 pi^2`. Nothing is measured near the seam: what comes around it says what is there.
#[test]
fn a_field_on_a_ring_goes_on_across_the_seam() {
    let rate = 0.4 * PI * PI;
    let wave = |x: f64| (2.0 * PI * (x - 0.1)).sin();
    let exact = |[x, t]: [f64; 2]| (1.0 - (-rate * t).exp()) / rate * wave(x);
    let mut normal = normals(5);
    let probes: Vec<f64> =
        (0..400).flat_map(|i| [0.2 + 0.6 * f64::from(i % 20) / 19.0, 0.05 * f64::from(i / 20 + 1)]).collect();
    let measured = pairs(&probes).map(|place| exact(place) + 1e-3 * normal()).collect();
    let times: Vec<f64> = (0..40).map(|i| f64::from(i) / 39.0).collect();
    let seam = |x: f64| times.iter().flat_map(|&t| [x, t]).collect::<Vec<f64>>();
    let begin: Vec<f64> = times.iter().flat_map(|&x| [x, 0.0]).collect();
    let mut problem = Problem::new(ring::scene("recover"));
    problem.set_group("inside", grid([32, 32], [1.0, 1.0], false).into(), Vec::new()).unwrap();
    let joined = Points { coordinates: seam(0.0), partners: seam(1.0), ..Points::default() };
    problem.set_group("seam", joined, Vec::new()).unwrap();
    problem.set_group("begin", begin.into(), Vec::new()).unwrap();
    problem.set_group("probes", probes.into(), vec![measured]).unwrap();
    let mut solution = solve(&problem);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    for t in [0.3, 0.6, 1.0] {
        let (found, _) = values(&mut solution, "u", &[0.0, t, 1.0, t]);
        assert!((found[0] - found[1]).abs() < 1e-5, "{found:?}");
        assert!((found[0] - exact([0.0, t])).abs() < 0.01, "{found:?} for {}", exact([0.0, t]));
    }
    let places: Vec<f64> = (0..50).flat_map(|i| [f64::from(i) / 49.0, 0.5]).collect();
    let (found, deviations) = values(&mut solution, "q", &places);
    let deviations = deviations.unwrap();
    let beyond = pairs(&places).enumerate().filter(|&(at, [x, _])| (found[at] - wave(x)).abs() > 2.0 * deviations[at]);
    assert!(beyond.count() <= 5, "{found:?}");
}
