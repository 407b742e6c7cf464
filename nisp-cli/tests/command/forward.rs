//! Problems in which nothing is measured, as texts.

use std::fs;

use serde_json::Value;

use crate::common::Place;

/// Solves a text; its exit code and what it says.
fn solved(place: &Place, text: &str) -> (Option<i32>, Value) {
    place.put("equation.pde", text);
    let ran = place.run("solve equation.pde --budget 60 --json --out out");
    (ran.code, serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}{}", ran.stdout, ran.stderr)))
}

/// A front, the closed form of which the right side is made from.
const FRONT: &str = "units: off;
coordinates: x, t: time;
fields: u;
domains: rod = 0 .. 1 times 0 .. 1;
let s = 0.5 * (1 - tanh((x - 0.2 - 0.3 * t) / 0.1));
on inside in rod { balance: d(u, t) == 0.01 * d(u, x, 2) + d(s, t) - 0.01 * d(s, x, 2) + u - s; }
on begin start of rod { first: u == s; }
on ends boundary of rod { held: u == s; }
";

/// No condition says anything where time ends, and little is said between the points of an edge.
#[test]
fn a_front_is_where_its_closed_form_says_up_to_the_end_of_time() {
    let place = Place::new();
    let (code, report) = solved(&place, FRONT);
    assert_eq!((code, report["status"].as_str()), (Some(0), Some("converged")), "{}", report["verdict"]);
    let mut last = 0;
    for row in place.rows("out/state.csv") {
        let [x, t, u] = row[..3] else { panic!("{row:?}") };
        let exact = 0.5 * (1.0 - ((x - 0.2 - 0.3 * t) / 0.1).tanh());
        assert!((u - exact).abs() < 5e-3, "{u} for {exact} at {x}, {t}");
        last += usize::from(t == 1.0);
    }
    assert!(last > 10, "{last} places at the end of time");
}

/// The fourth power of pi has sixty digits as a product of decimals.
#[test]
fn a_plate_whose_load_has_a_power_of_pi_bends_as_its_closed_form_does() {
    let place = Place::new();
    let text = "units: off;
coordinates: x, y;
fields: w;
domains: plate = box(0 .. 1, 0 .. 1);
on inside in plate { bending: laplacian(laplacian(w)) == 4 * pi^4 * sin(pi * x) * sin(pi * y); }
on edge boundary of plate { held: w == 0; free: laplacian(w) == 0; }
";
    let (code, report) = solved(&place, text);
    assert_eq!((code, report["status"].as_str()), (Some(0), Some("converged")), "{}", report["verdict"]);
    let sine = |x: f64| (std::f64::consts::PI * x).sin();
    for row in place.rows("out/state.csv") {
        assert!((row[2] - sine(row[0]) * sine(row[1])).abs() < 1e-6, "{row:?}");
    }
}

/// How large the field is must be asked everywhere: in a strip along a wall it is nothing, and any deviation is large beside that.
#[test]
fn a_layer_at_an_outlet_is_determined() {
    let place = Place::new();
    let text = "units: off;
coordinates: x, y;
fields: u;
domains: channel = box(0 .. 1, 0 .. 1);
let w = sin(pi * y) * (exp((x - 1) / 0.1) - exp(-1 / 0.1));
on inside in channel { balance: d(u, x) - 0.1 * laplacian(u) == 0.1 * pi^2 * w; }
on edge boundary of channel { held: u == w; }
";
    let (code, report) = solved(&place, text);
    assert_eq!((code, report["status"].as_str()), (Some(0), Some("converged")), "{}", report["verdict"]);
    for row in place.rows("out/state.csv") {
        let exact = (std::f64::consts::PI * row[1]).sin() * (((row[0] - 1.0) / 0.1).exp() - (-1.0_f64 / 0.1).exp());
        assert!((row[2] - exact).abs() < 1e-4, "{row:?}");
    }
}

#[test]
fn without_a_beginning_a_temperature_is_open() {
    let place = Place::new();
    let text = "units: off;
coordinates: x, t: time;
fields: u;
domains: rod = 0 .. 1 times 0 .. 1;
on inside in rod { balance: d(u, t) == 0.1 * d(u, x, 2); }
on ends boundary of rod { held: u == x; }
";
    let (code, report) = solved(&place, text);
    let open = report["verdict"].as_array().unwrap().iter().find(|check| check["check"] == "determined");
    let open = open.unwrap_or_else(|| panic!("{}", report["verdict"]));
    assert_eq!((code, open["passed"].as_bool()), (Some(3), Some(false)), "{}", report["verdict"]);
    assert!(open["message"].as_str().unwrap().starts_with("equations and conditions do not determine `u`"), "{open}");
    let begun = format!("{text}on begin start of rod {{ first: u == x + sin(3.141592653589793 * x); }}\n");
    let (code, report) = solved(&place, &begun);
    assert_eq!(code, Some(0), "{}", report["verdict"]);
    let decay = |t: f64| (-0.1 * std::f64::consts::PI.powi(2) * t).exp();
    for row in place.rows("out/state.csv") {
        let exact = row[0] + decay(row[1]) * (std::f64::consts::PI * row[0]).sin();
        assert!((row[2] - exact).abs() < 1e-7, "{row:?} for {exact}");
    }
}

/// Slopes at the edge leave a constant open.
#[test]
fn slopes_alone_leave_a_potential_open() {
    let place = Place::new();
    let text = "units: off;
coordinates: x, y;
fields: u;
domains: room = box(0 .. 1, 0 .. 1);
let known = cos(3.141592653589793 * x) * cos(3.141592653589793 * y);
on inside in room { balance: d(u, x, 2) + d(u, y, 2) == laplacian(known); }
on edge boundary of room { columns: normal: vector [1]; tight: dot(grad(u), normal) == 0; }
";
    let (code, report) = solved(&place, text);
    let open = report["verdict"].as_array().unwrap().iter().any(|check| check["check"] == "determined");
    assert!(code == Some(3) && open, "{}", report["verdict"]);
    let held = format!("{text}on corners {{ held: u == known; }}\n");
    place.put("corner.csv", "x,y\n0,0\n1,1\n");
    place.put("equation.pde", &held);
    let ran = place.run("solve equation.pde --data corners=corner.csv --budget 60 --out out");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    for row in place.rows("out/state.csv") {
        let exact = (std::f64::consts::PI * row[0]).cos() * (std::f64::consts::PI * row[1]).cos();
        assert!((row[2] - exact).abs() < 1e-6, "{row:?} for {exact}");
    }
}

/// What grows a hundred million times is not found by equations that hold to a small part of their largest value.
#[test]
fn what_grows_is_not_called_right() {
    let text = "units: off;
coordinates: x, t: time;
fields: u;
domains: rod = 0 .. 1 times 0 .. 1;
on inside in rod { balance: d(u, t) == 0.01 * d(u, x, 2) + 20 * u; }
on ends boundary of rod { held: u == 0; }
on begin start of rod { first: u == 1e-6 * sin(3.141592653589793 * x); }
";
    let grown = |t: f64| 1e-6 * ((20.0 - 0.01 * std::f64::consts::PI.powi(2)) * t).exp();
    let exact = |x: f64, t: f64| grown(t) * (std::f64::consts::PI * x).sin();
    let (is_right, off) = called_right(text, "--budget 10", exact);
    assert!(!is_right, "{off}");
    assert!(off > 0.1 * grown(1.0), "the answer is right, and is not called so");
}

/// Solves a text whose closed form is known: whether it is called right, and how far it is off at the worst place.
fn called_right(text: &str, options: &str, exact: impl Fn(f64, f64) -> f64) -> (bool, f64) {
    let place = Place::new();
    place.put("equation.pde", text);
    let ran = place.run(&format!("solve equation.pde --out out {options}"));
    assert!(matches!(ran.code, Some(0 | 3)), "{}{}", ran.stdout, ran.stderr);
    let off = |row: &Vec<f64>| (row[2] - exact(row[0], row[1])).abs();
    (ran.code == Some(0), place.rows("out/state.csv").iter().map(off).fold(0.0, f64::max))
}

/// A front that grows from a tail of 1e-10: what is left of the equation in the tail is small, and decides where the front is.
#[test]
fn a_front_that_grows_from_its_tail_is_right_or_doubted() {
    let text = "units: off;
coordinates: x, t: time;
fields: u;
domains: rod = -10 .. 30 times 0 .. 8;
let s = 1 / (1 + exp((x - 5 * t / sqrt(6)) / sqrt(6)))^2;
on inside in rod { balance: d(u, t) == d(u, x, 2) + u * (1 - u); }
on ends boundary of rod { held: u == s; }
on begin start of rod { first: u == s; }
";
    let front = |x: f64, t: f64| (1.0 + ((x - 5.0 * t / 6f64.sqrt()) / 6f64.sqrt()).exp()).powi(-2);
    let (is_right, off) = called_right(text, "--carrier splines --budget 20", front);
    assert!(off < 5e-3 || !is_right, "{off}");
}

/// A corner where the slope has no bound: a network leaves little of the equation in the mean.
#[test]
fn a_network_that_misses_a_corner_is_doubted() {
    let text = "units: off;
coordinates: x, y;
fields: u;
domains: room = box(-1 .. 1, -1 .. 1) minus box(0 .. 1.1, -1.1 .. 0);
let angle = 2.356194490192345 + 2 * atan((-x - y) / (sqrt(2) * sqrt(x^2 + y^2 + 1e-20) + (y - x)));
on inside in room { balance: d(u, x, 2) + d(u, y, 2) == 0; }
on edge boundary of room { held: u == (x^2 + y^2 + 1e-20)^(1 / 3) * sin(2 / 3 * angle); }
";
    let potential = |x: f64, y: f64| {
        let angle = y.atan2(x);
        let angle = if angle < -1e-9 { angle + std::f64::consts::TAU } else { angle };
        (x * x + y * y).cbrt() * (2.0 / 3.0 * angle).sin()
    };
    let (is_right, off) = called_right(text, "--carrier network --budget 10", potential);
    assert!(off < 5e-3 || !is_right, "{off}");
}

/// `w'' = 8 - p` over a floor at -1/2 rests on it from `sqrt(1 / 8)` on, where `p` is 8. Where nothing is measured, equations that hold to a tenth
/// of their source leave it half off.
#[test]
fn a_wire_that_hardly_rests_on_its_floor_is_doubted() {
    let text = "units: off;
coordinates: x;
fields: w;
sources: p;
domains: wire = 0 .. 1;
on inside in wire { balance: d(w, x, 2) == 8 - p; touch: 0 <= p _|_ w + 0.5 >= 0; }
on ends boundary of wire { held: w == 0; }
";
    let place = Place::new();
    place.put("wire.pde", text);
    for options in ["", "--carrier network --iterations 400"] {
        let ran = place.run(&format!("solve wire.pde {options} --grid 101 --out out"));
        let table = fs::read_to_string(place.path("out/source.csv")).unwrap();
        let (mut off, mut all) = (0.0, 0.0);
        for line in table.lines().skip(1) {
            let cells: Vec<f64> = line.split(',').take(2).map(|cell| cell.parse().unwrap()).collect();
            let rests = (0.125_f64.sqrt()..=1.0 - 0.125_f64.sqrt()).contains(&cells[0]);
            off += (cells[1] - if rests { 8.0 } else { 0.0 }).powi(2);
            all += if rests { 64.0 } else { 0.0 };
        }
        // At a place by the edge it may be either.
        let is_right = (off / all).sqrt() < 0.1;
        assert_eq!(ran.code, Some(if is_right { 0 } else { 3 }), "{options}: {off} of {all}");
    }
}

/// What is held where the flow leaves says nothing of what enters: rounding does, and grows against the flow.
#[test]
fn a_condition_at_the_outlet_instead_of_the_inlet_is_named() {
    let place = Place::new();
    let text = "units: off;
coordinates: x, t: time;
fields: u;
domains: pipe = 0 .. 1 times 0 .. 2;
on inside in pipe { carried: d(u, t) + d(u, x) == 0.02 * d(u, x, 2); }
on ends boundary of pipe { columns: normal: vector [1]; outlet: (1 + normal[0]) * (u - sin(5 * t)) == 0; }
on begin start of pipe { clean: u == 0; }
";
    place.put("equation.pde", text);
    // So many steps end on the first lattice.
    let ran = place.run("solve equation.pde --carrier splines --iterations 12 --json --out out");
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    let checks = report["verdict"].as_array().unwrap();
    let failed = |name: &str| checks.iter().find(|check| check["check"] == name && check["passed"] == false);
    assert!(ran.code == Some(3) && failed("refined").is_some(), "{}", report["verdict"]);
    // The maximum principle bounds what a condition at the inlet would give by one.
    assert!(place.rows("out/state.csv").iter().any(|row| row[2].abs() > 500.0));
    let amplified = failed("amplified").unwrap_or_else(|| panic!("{}", report["verdict"]));
    assert!(amplified["message"].as_str().unwrap().contains("stands at the wrong end"), "{amplified}");
}

/// A peak that is next to nothing at the edge is determined by its value there, however small that is.
#[test]
fn a_peak_far_from_its_edge_is_determined() {
    let text = "units: off;
coordinates: x, y;
fields: u;
domains: room = box(0 .. 1, 0 .. 1);
let square = (x - 0.6)^2 + (y - 0.4)^2;
let peak = exp(-25 * square);
on inside in room { balance: d(u, x, 2) + d(u, y, 2) == peak * (2500 * square - 100); }
on edge boundary of room { held: u == peak; }
";
    let peak = |x: f64, y: f64| (-25.0 * ((x - 0.6).powi(2) + (y - 0.4).powi(2))).exp();
    let (is_right, off) = called_right(text, "--budget 60", peak);
    assert!(is_right && off < 1e-3, "{is_right} {off}");
}
