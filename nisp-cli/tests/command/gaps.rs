//! What was not measured, and what stands alone.

use std::fmt::Write;
use std::fs::read_to_string;
use std::path::Path;

use crate::common::{Place, Ran};
use serde_json::Value;

/// The example's measurements as `t_s,q_m,psi_rad,phi_rad`, each cell as `cell` says of its row, column and text.
fn record(cell: impl Fn(usize, usize, &str) -> String) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pendulum/run_07_obs.csv");
    let mut text = String::from("t_s,q_m,psi_rad,phi_rad\n");
    for (row, line) in read_to_string(path).unwrap().lines().skip(1).enumerate() {
        // Behind three exact columns stand those with noise of 0.01.
        let cells: Vec<&str> = line.split(',').collect();
        let noisy = (0..3).map(|column| cell(row, column, cells[4 + column]));
        let _ = writeln!(text, "{},{}", cells[0], noisy.collect::<Vec<_>>().join(","));
    }
    text
}

fn solved(table: &str, options: &str) -> (Ran, Value) {
    let place = Place::new();
    place.put("run.csv", table);
    let truth = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pendulum/run_07_truth.csv");
    let line = "solve pendulum --data run.csv --json --budget 60 --carrier splines --truth";
    let ran = place.run(&format!("{line} {} {options}", truth.display()));
    let object = serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}", ran.stderr));
    (ran, object)
}

/// The mean error of the force over its mean magnitude.
fn error(object: &Value) -> f64 {
    object["errors"]["f"].as_f64().unwrap() / object["errors"]["f_if_zero"].as_f64().unwrap()
}

#[test]
fn what_was_not_measured_does_not_count() {
    let gaps = record(|row, column, text| match column {
        0 if (60..120).contains(&row) => String::new(),
        1 if row % 7 == 0 => "nan".into(),
        _ => text.into(),
    });
    let (ran, object) = solved(&gaps, "");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    // A layer of the force that splines smooth away is most of the error, with all rows too.
    assert!(error(&object) < 0.5, "{}", error(&object));
    let warnings = object["warnings"].to_string();
    assert!(warnings.contains("`q` is not measured in 60 of 201 rows") && warnings.contains("`psi`"), "{warnings}");
}

#[test]
fn a_column_that_is_not_there_was_not_measured() {
    let table: String = record(|_, _, text| text.into())
        .lines()
        .map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0))
        .collect();
    let (ran, object) = solved(&table, "");
    assert!(object["warnings"].to_string().contains("`phi` is not measured"), "{}", ran.stdout);
    assert!(error(&object) < 0.5, "{}", error(&object));
}

#[test]
fn outliers_are_seen_and_a_robust_loss_leaves_them_out() {
    let spoiled = record(|row, column, text| {
        let value: f64 = text.parse().unwrap();
        format!("{}", if row % 20 == 7 + column { value + 0.5 } else { value })
    });
    let (ran, object) = solved(&spoiled, "");
    assert_eq!((ran.code, object["status"].as_str()), (Some(3), Some("inconsistent")));
    let failed = object["verdict"].as_array().unwrap().iter().filter(|check| check["passed"] == false);
    let hint = failed
        .filter(|check| check["check"] == "outliers")
        .all(|check| check["message"].to_string().contains("--robust"));
    assert!(hint && object["verdict"].to_string().contains("stand alone"), "{}", object["verdict"]);
    let (ran, object) = solved(&spoiled, "--robust");
    assert_eq!(ran.code, Some(0), "{}", object["verdict"]);
    assert!(error(&object) < 0.6, "{}", error(&object));
}
