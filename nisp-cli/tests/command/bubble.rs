//! The bubble: large strains, forces as vectors, and a sensor that is calibrated from its free shape.

use std::path::{Path, PathBuf};

use crate::common::Place;
use nisp_data::Cloud;
use serde_json::Value;

/// A file of the samples of large strains.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/membrane_large").join(name)
}

fn answer(place: &Place, line: &str) -> Value {
    let ran = place.run(&format!("{line} --budget 300 --json"));
    assert_eq!(ran.code, Some(0), "{line}: {} {}", ran.stderr, ran.stdout);
    serde_json::from_str(&ran.stdout).unwrap()
}

fn vector(value: &Value) -> [f64; 3] {
    std::array::from_fn(|axis| value[axis].as_f64().unwrap())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The force is that of the finite elements, in the sample's file; the patch is where the sphere is.
#[test]
fn a_sphere_presses_with_its_force_where_it_is() {
    let place = Place::new();
    let found = answer(&place, "solve bubble");
    let truth = [-0.2927, 0.0001, -8.2804];
    let seen = found["seen"].as_f64().unwrap();
    assert!(0.0 < seen && seen <= 1.0, "{seen}");
    let force = vector(&found["force"]);
    assert!(distance(force, truth) < 0.25, "{force:?}");
    let deviation = found["force_sd"].as_f64().unwrap();
    assert!(deviation > 0.0 && distance(force, truth) < 4.0 * deviation, "{deviation}");
    assert!(found["errors"]["iou"].as_f64().unwrap() > 0.8, "{}", found["errors"]);
    let patches = found["patches"].as_array().unwrap();
    assert_eq!(patches.len(), 1, "{patches:?}");
    // The truth's own area of the patch, on the deformed surface.
    assert!((patches[0]["area_m2"].as_f64().unwrap() / 0.00047861 - 1.0).abs() < 0.15, "{patches:?}");
    assert!(distance(vector(&patches[0]["force_N"]), truth) < 0.3, "{patches:?}");
}

/// From a modulus nine times the true one.
#[test]
fn the_modulus_is_found_from_far_away() {
    let sample = data("large_inflated_2.toml");
    let found = answer(
        &Place::new(),
        &format!("solve bubble --scene identify --sample {} --cloud 1 --set E=3e6", sample.display()),
    );
    let (modulus, deviation) = (&found["errors"]["E"], &found["errors"]["E_sd"]);
    let truth = 455_000.0;
    let off = (modulus.as_f64().unwrap() - truth).abs();
    assert!(off < 0.01 * truth && off < 4.0 * deviation.as_f64().unwrap(), "{modulus} {deviation}");
}

/// Turns about x, y and z in radians and a shift in metres, for clouds of a camera that is not quite where it should be.
const TURN: [f64; 3] = [0.02, -0.015, 0.03];
const SHIFT: [f64; 3] = [1e-3, -8e-4, 1.5e-3];

/// A sample's cloud in the frame of that camera.
fn seen(place: &Place, from: &str, to: &str) {
    let turned = |[x, y, z]: [f64; 3]| {
        let [(sx, cx), (sy, cy), (sz, cz)] = TURN.map(f64::sin_cos);
        let (y, z) = (cx * y - sx * z, sx * y + cx * z);
        let (x, z) = (cy * x + sy * z, cy * z - sy * x);
        [cz * x - sz * y + SHIFT[0], sz * x + cz * y + SHIFT[1], z + SHIFT[2]]
    };
    let points = Cloud::read(data(from)).unwrap().points.into_iter().map(turned);
    place.put(to, &points.map(|[x, y, z]| format!("{x:e},{y:e},{z:e}\n")).collect::<String>());
}

/// The rim is two hundredths from where it is said to be, and the camera a millimetre or two: forces are right all the same.
#[test]
fn a_calibrated_sensor_finds_the_force() {
    let place = Place::new();
    seen(&place, "large_inflated_1_cloud_0.ply", "free.csv");
    seen(&place, "large_sphere_d35_cloud_0.ply", "pressed.csv");
    let sensor =
        answer(&place, "calibrate bubble --reference free.csv --set p=5400 --set a=0.061 --set b=0.0395 --out sensor");
    assert_eq!(sensor["scene"], "calibrate", "the samples' law is linear: {sensor}");
    for learned in sensor["learned"].as_array().unwrap() {
        let truth = match learned["name"].as_str().unwrap() {
            "E" => 341_260.0,
            "stretch" => 1.0,
            "widen_a" => 0.06 / 0.061,
            "widen_b" => 0.04 / 0.0395,
            "turn_x" => TURN[0],
            "turn_y" => TURN[1],
            "turn_z" => TURN[2],
            "shift_x" => 1e3 * SHIFT[0],
            "shift_y" => 1e3 * SHIFT[1],
            "shift_z" => 1e3 * SHIFT[2],
            name => panic!("{name}"),
        };
        let off = (learned["value"].as_f64().unwrap() - truth).abs();
        assert!(off < 4.0 * learned["deviation"].as_f64().unwrap(), "{learned} {truth}");
    }
    let pressed =
        answer(&place, "solve bubble --calibration sensor/calibration.toml --data pressed.csv --set p=5636.3");
    let force = pressed["errors"]["force_N"].as_f64().unwrap();
    let deviation = pressed["force_sd"].as_f64().unwrap();
    assert!((force - 8.2856).abs() < 0.25 && (force - 8.2856).abs() < 3.0 * deviation, "{force} {deviation}");
    let learned = |name: &str| {
        let all = sensor["learned"].as_array().unwrap();
        all.iter().find(|learned| learned["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    let pose = ["turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z"];
    let material = format!("--set E={} --set stretch={}", learned("E"), learned("stretch"));
    let whole = pose.map(|name| format!(" --set {name}={}", learned(name))).concat();
    let solve = "solve bubble --calibration sensor/calibration.toml --data pressed.csv --set p=5636.3";
    let of = |said: &str| answer(&place, &format!("{solve} {said}"))["force_sd"].as_f64().unwrap();
    // A pose that is said is the one of the calibration.
    let (half, known) = (of(&material), of(&(material.clone() + &whole)));
    assert!(known < half && half < deviation, "what is said is known: {known} {half} {deviation}");
    assert_eq!(pressed["patches"].as_array().unwrap().len(), 1, "{}", pressed["patches"]);
    // A calibration whose frames miss its theory by two millimetres is no ground for any answer.
    let text = std::fs::read_to_string(place.path("sensor/calibration.toml")).unwrap();
    let missed = text.lines().map(|line| if line.starts_with("misfit_m") { "misfit_m = 0.002" } else { line });
    place.put("off.toml", &missed.map(|line| format!("{line}\n")).collect::<String>());
    let ran = place.run("solve bubble --calibration off.toml --data pressed.csv --set p=5636.3");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!(ran.stdout.contains("misses the calibration's free frames by 2.00 mm"), "{}", ran.stdout);
    let free = answer(&place, "solve bubble --calibration sensor/calibration.toml --data free.csv --set p=5400");
    assert!(free["errors"]["force_N"].as_f64().unwrap() < 0.3, "{}", free["errors"]);
    assert!(free["patches"].as_array().unwrap().is_empty(), "{}", free["patches"]);
    // A gauge pressure that is far too high presses everywhere, which no tool does.
    for (frame, pressure) in [("pressed.csv", 1.2 * 5636.3), ("free.csv", 1.1 * 5400.0)] {
        let solve = "solve bubble --calibration sensor/calibration.toml --data";
        let ran = place.run(&format!("{solve} {frame} --set p={pressure}"));
        assert!(ran.code == Some(3) && ran.stdout.contains("no tool does that"), "{} {}", ran.stdout, ran.stderr);
    }
}

#[test]
fn what_does_not_calibrate_says_so() {
    let place = Place::new();
    place.put("free.csv", "0,0,0\n");
    let refused = |line: &str, words: &str| {
        let ran = place.run(line);
        assert_eq!(ran.code, Some(2), "{line}: {}", ran.stdout);
        assert!(ran.stderr.contains(words), "{line}: {}", ran.stderr);
    };
    refused("calibrate rlc --reference free.csv", "`nisp calibrate bubble` can");
    refused("calibrate bubble --reference free.csv --set p=5000", "record 50 at least");
    refused("calibrate bubble --reference free.csv", "--set p");
    refused("solve bubble --calibration free.csv --data free.csv --set p=5000", "no calibration");
    refused("solve bubble --calibration free.csv", "--data FRAME");
    refused("solve rlc --calibration free.csv", "takes no --calibration");
}
