//! The circuit's equation determines its source up to a multiple of exp(-6 t), since f' + 6 f = 0 has that solution; the plate's
//! determines its deflection if its edge has a slope.

mod common;

use common::Place;
use serde_json::Value;

fn warnings(arguments: &str) -> String {
    let ran = Place::new().run(&format!("solve --json --budget 60 --iterations 1000 --threads 1 {arguments}"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let object: Value = serde_json::from_str(&ran.stdout).unwrap();
    object["warnings"].to_string()
}

/// The rate in `a multiple of exp(RATE t)`.
fn rate(warnings: &str) -> f64 {
    let (_, from) = warnings.split_once("a multiple of exp(").unwrap_or_else(|| panic!("no exponential: {warnings}"));
    from.split(' ').next().and_then(|rate| rate.parse().ok()).unwrap_or_else(|| panic!("no rate: {warnings}"))
}

#[test]
fn without_a_condition_the_open_direction_is_named() {
    let warnings = warnings("rlc --scene free");
    assert!(warnings.contains("the data do not determine `f`"), "{warnings}");
    assert!((rate(&warnings) + 6.0).abs() < 0.1, "{warnings}");
}

#[test]
fn a_condition_that_settles_it_is_named() {
    let warnings = warnings("rlc --scene recover");
    assert!(warnings.contains("`f` rests on the condition `start.known: f == f0`"), "{warnings}");
    assert!(!warnings.contains("do not determine"), "{warnings}");
    assert!((rate(&warnings) + 6.0).abs() < 0.1, "{warnings}");
}

#[test]
fn a_plate_without_a_slope_at_its_edge_is_open() {
    assert!(warnings("plate --scene edge_only").contains("the data do not determine `w`"));
    assert!(!warnings("plate --scene clamped").contains("do not determine"));
}
