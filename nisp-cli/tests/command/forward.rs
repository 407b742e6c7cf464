//! Problems in which nothing is measured, as texts.

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
    let place = Place::new();
    let text = "units: off;
coordinates: x, t: time;
fields: u;
domains: rod = 0 .. 1 times 0 .. 1;
on inside in rod { balance: d(u, t) == 0.01 * d(u, x, 2) + 20 * u; }
on ends boundary of rod { held: u == 0; }
on begin start of rod { first: u == 1e-6 * sin(3.141592653589793 * x); }
";
    let (code, report) = solved(&place, text);
    assert_eq!(code, Some(3), "{}", report["verdict"]);
    let grown = |t: f64| 1e-6 * ((20.0 - 0.01 * std::f64::consts::PI.powi(2)) * t).exp();
    let off =
        |row: &Vec<f64>| (row[2] - grown(row[1]) * (std::f64::consts::PI * row[0]).sin()).abs() > 0.1 * grown(1.0);
    assert!(place.rows("out/state.csv").iter().any(off), "the answer is right, and is not called so");
}
