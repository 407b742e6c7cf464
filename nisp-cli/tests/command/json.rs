//! The object of `--json` holds everything that a script may want: values, bars, noise, and what is left of every term.

use std::fs;

use crate::common::{Place, circuit};
use serde_json::Value;

/// Standard deviation of the noise on the measurements.
const NOISE: f64 = 0.03;

/// Twelve uniform numbers less six: normal, near enough, and the same in every run.
fn normal() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

fn solved(place: &Place) -> Value {
    let mut normal = normal();
    let mut noise = Vec::new();
    noise.resize_with(200, || NOISE * normal());
    place.put("v.csv", &("t_s,v_V\n".to_string() + &circuit(200, |i, t, v| format!("{t},{}\n", v + noise[i]))));
    let ran = place.run("solve rlc --data v.csv --set f0=6 --budget 20 --json");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

/// The numbers of a column of a table.
fn column(table: &str, header: &str) -> Vec<f64> {
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let at = lines.next().unwrap().iter().position(|own| *own == header).unwrap();
    lines.map(|cells| cells[at].parse().unwrap()).collect()
}

/// The parser of this test rounds the last digit otherwise than that of the standard library.
#[track_caller]
fn same(values: &Value, expected: &[f64]) {
    let values = values.as_array().unwrap().iter().map(|value| value.as_f64().unwrap());
    assert_eq!((values.len(), expected.is_empty()), (expected.len(), false));
    for (value, expected) in values.zip(expected) {
        assert!((value - expected).abs() <= 1e-15 * expected.abs(), "{value} is not {expected}");
    }
}

#[test]
fn values_and_bars_are_those_of_the_tables() {
    let place = Place::new();
    let object = solved(&place);
    let read = |name: &str| fs::read_to_string(place.path("nisp-out").join(name)).unwrap();
    for (key, file, name) in [("sources", "source.csv", "f"), ("state", "state.csv", "v")] {
        let (table, head) = (read(file), &object[key][0]);
        assert_eq!((&head["name"], &head["unit"]), (&name.into(), &"V".into()));
        same(&head["values"], &column(&table, &format!("{name} [V]")));
        same(&head["deviations"], &column(&table, &format!("{name}_sd [V]")));
        same(&object["coordinates"][0]["values"], &column(&table, "t [s]"));
    }
    assert_eq!((&object["coordinates"][0]["name"], &object["coordinates"][0]["unit"]), (&"t".into(), &"s".into()));
    assert_eq!(object["files"]["names"], serde_json::json!(["source.csv", "state.csv", "plot.svg", "answer.nisp"]));
    assert_eq!((&object["files"]["folder"], &object["files"]["fault"]), (&"nisp-out".into(), &Value::Null));
}

#[test]
fn terms_say_what_is_left_of_them_and_how_noisy_the_data_are() {
    let place = Place::new();
    let object = solved(&place);
    let terms = object["terms"].as_array().unwrap();
    let names: Vec<_> = terms.iter().map(|term| term["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["circuit.balance", "samples.v", "start.known"]);
    let [balance, samples, known] = terms.as_slice() else { panic!("{terms:?}") };
    assert_eq!((&samples["unit"], &balance["observation"]), (&"V".into(), &false.into()));
    assert_eq!((&balance["noise"], &known["noise"]), (&Value::Null, &Value::Null));
    assert!(balance["rms"].as_f64().unwrap() < 1e-2 * balance["size"].as_f64().unwrap(), "{balance}");
    assert!(known["rms"].as_f64().unwrap() < 1e-2, "{known}");
    // Of 200 measurements the deviation is known to a twentieth.
    for key in ["noise", "rms"] {
        let found = samples[key].as_f64().unwrap();
        assert!((found / NOISE - 1.0).abs() < 0.2, "{key}: {found}");
    }
    assert_eq!(samples["observation"], true);
    let groups = object["groups"].as_array().unwrap();
    let points: Vec<_> = groups.iter().map(|group| (&group["name"], &group["points"])).collect();
    assert_eq!(
        points,
        [(&"circuit".into(), &300.into()), (&"samples".into(), &200.into()), (&"start".into(), &1.into())]
    );
    assert_eq!(object["data"]["source"], "v.csv");
    let assumed = object["data"]["assumed"].as_array().unwrap();
    assert_eq!(assumed.iter().map(|own| own["name"].as_str().unwrap()).collect::<Vec<_>>(), ["a", "b", "c", "e"]);
    assert!(object["skipped"].as_array().unwrap().iter().any(|text| text.as_str().unwrap().contains("`a`")));
}
