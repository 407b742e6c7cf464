//! The plate from the command line: solved where it is determined, and said to be open where it is not.

use std::process::Command;

fn plate(options: &[&str]) -> serde_json::Value {
    let out = tempfile::tempdir().unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_nisp"))
        .args(["solve", "plate", "--json", "--out", out.path().join("out").to_str().unwrap()])
        .args(options)
        .output()
        .unwrap();
    let plot = std::fs::read_to_string(out.path().join("out/plot.svg"));
    let plot = plot.unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&run.stderr)));
    for part in [">estimate<", ">truth<", ">error of w ["] {
        assert!(plot.contains(part), "no `{part}` in the plot");
    }
    serde_json::from_slice(&run.stdout).unwrap()
}

#[test]
fn a_clamped_plate_bends_as_its_closed_form_says() {
    for (carrier, most) in [("auto", 2e-5), ("network", 1e-3)] {
        let report = plate(&["--carrier", carrier, "--iterations", "3000", "--budget", "60"]);
        let error = report["errors"]["w"].as_f64().unwrap();
        // The deflection is 36.8 mm in the middle.
        assert!(error <= most, "{carrier}: {error} mm");
        assert_eq!(report["warnings"].as_array().map(Vec::len), Some(0), "{report}");
    }
}

#[test]
fn a_plate_that_is_only_held_is_said_to_be_underdetermined() {
    let report = plate(&["--scene", "edge_only", "--iterations", "20"]);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("2 conditions, found 1: the problem may be underdetermined"), "{warnings}");
}
