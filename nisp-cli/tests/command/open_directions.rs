//! The circuit's equation determines its source up to a multiple of exp(-6 t), since f' + 6 f = 0 has that solution; the plate's
//! determines its deflection if its edge has a slope; a membrane's, its modulus if somebody has measured the pressure.

use crate::common::Place;
use serde_json::Value;

fn solved(arguments: &str) -> Value {
    ended(arguments, 0)
}

/// The object of a run that ends with an exit code.
fn ended(arguments: &str, code: i32) -> Value {
    let ran = Place::new().run(&format!("solve --json --budget 60 --iterations 1000 --threads 1 {arguments}"));
    assert_eq!(ran.code, Some(code), "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

fn warnings_of(arguments: &str) -> String {
    solved(arguments)["warnings"].to_string()
}

/// The rate in `a multiple of exp(RATE t)`.
fn rate(warnings: &str) -> f64 {
    let (_, from) = warnings.split_once("a multiple of exp(").unwrap_or_else(|| panic!("no exponential: {warnings}"));
    from.split(' ').next().and_then(|rate| rate.parse().ok()).unwrap_or_else(|| panic!("no rate: {warnings}"))
}

#[test]
fn without_a_condition_the_open_direction_is_named() {
    let warnings = warnings_of("rlc --scene free");
    assert!(warnings.contains("the data do not determine `f`"), "{warnings}");
    assert!((rate(&warnings) + 6.0).abs() < 0.1, "{warnings}");
}

#[test]
fn a_condition_that_settles_it_is_named() {
    let warnings = warnings_of("rlc --scene recover");
    assert!(warnings.contains("`f` rests on the condition `start.known: f == f0`"), "{warnings}");
    assert!(!warnings.contains("do not determine"), "{warnings}");
    assert!((rate(&warnings) + 6.0).abs() < 0.1, "{warnings}");
}

/// Only the ratio of modulus and pressure shapes a membrane without bending, which the truth has as 341260 to 5670.
#[test]
fn a_modulus_whose_pressure_is_unknown_is_open() {
    for carrier in ["", "--carrier network"] {
        let found = solved(&format!("membrane --scene identify_unknown_pressure {carrier}"));
        let warnings = found["warnings"].to_string();
        assert!(
            warnings.contains("the data do not determine `E` and `p`: `E` + 1.00 % with `p` + 1.00 %"),
            "{warnings}"
        );
        let ratio = found["errors"]["E"].as_f64().unwrap() / found["errors"]["p"].as_f64().unwrap();
        assert!((ratio * 5670.0 / 341_260.0 - 1.0).abs() < 0.03, "{ratio}");
        assert!(!warnings_of(&format!("membrane --scene identify {carrier}")).contains("do not determine"));
    }
}

#[test]
fn a_plate_without_a_slope_at_its_edge_is_open() {
    // Without data no error bars say how open it is: it is no answer.
    let open = ended("plate --scene edge_only", 3);
    let checks = open["verdict"].as_array().unwrap();
    assert!(checks.iter().any(|check| check["check"] == "determined" && check["passed"] == false), "{checks:?}");
    assert!(open["warnings"].to_string().contains("equations and conditions do not determine `w`"));
    assert!(!warnings_of("plate --scene clamped").contains("do not determine"));
}
