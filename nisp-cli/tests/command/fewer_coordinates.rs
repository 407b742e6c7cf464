//! Sources that depend on fewer coordinates than the fields do: their truths and their pictures.

use std::f64::consts::PI;
use std::fs;

use crate::common::Place;
use serde_json::Value;

const ROD: &str = "coordinates: x [m], t [s]; fields: T [K]; sources: q(x) [K/s]; parameters: a [m^2/s] = 1e-3;
domains: bar = 0 .. 1 times 0 .. 100;
on inside in bar { heat: d(T, t) - a * d(T, x, 2) == q; }
on samples { observe T; }
";

/// A rod that is heated along its length for good: the rate, and the temperature in closed form.
fn rate(x: f64) -> f64 {
    0.02 + 0.05 * (PI * x).cos()
}

fn temperature(x: f64, t: f64) -> f64 {
    let decay = 1e-3 * PI * PI;
    300.0 + 0.02 * t + 0.05 / decay * (1.0 - (-decay * t).exp()) * (PI * x).cos()
}

#[test]
fn a_truth_may_have_the_sources_own_coordinate_alone() {
    let place = Place::new();
    let samples = (0..16 * 21).map(|row| (f64::from(row % 16) / 15.0, 5.0 * f64::from(row / 16)));
    // Noise of a fixed pattern: digits that are cut off.
    let row = |(x, t): (f64, f64)| format!("{x},{t},{:.2}\n", temperature(x, t));
    place.put("rod.csv", &format!("x [m],t [s],T [K]\n{}", samples.map(row).collect::<String>()));
    let truth: String = (0..41).map(|i| f64::from(i) / 40.0).map(|x| format!("{x},{}\n", rate(x))).collect();
    place.put("truth.csv", &format!("x [m],rate [K/s]\n{truth}"));
    place.put("rod.pde", ROD);
    let solve = "solve rod.pde --data rod.csv --truth truth.csv --out out --json";
    let refused = place.run(solve);
    assert!(
        refused.code == Some(2) && refused.stderr.contains("no column answers to any of T, q"),
        "{}",
        refused.stderr
    );
    let ran = place.run(&format!("{solve} --column q=rate"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let errors = &serde_json::from_str::<Value>(&ran.stdout).unwrap()["errors"];
    let [error, size] = ["q", "q_if_zero"].map(|name| errors[name].as_f64().unwrap());
    assert!(error < 0.1 * size, "{errors}");
    let plot = fs::read_to_string(place.path("out/plot.svg")).unwrap();
    assert!(plot.contains("estimate ± 2 sd") && plot.contains("truth"), "no curve of the source over x");
    // A source over both coordinates cannot be scored so.
    place.put("rod.pde", &ROD.replace("q(x)", "q"));
    let refused = place.run(&format!("{solve} --column q=rate"));
    assert!(refused.code == Some(2) && refused.stderr.contains("no column for `t` in s"), "{}", refused.stderr);
}

#[test]
fn what_was_not_given_is_named_first() {
    let place = Place::new();
    place.put(
        "cup.pde",
        "coordinates: t [s]; fields: T [K]; sources: P [K/s]; on body { all: d(T, t) == P; } on samples { observe T; }",
    );
    let ran = place.run("solve cup.pde");
    let said = "group `samples` wants measurements of T; give a table: --data samples=FILE";
    assert!(ran.code == Some(2) && ran.stderr.contains(said), "{}", ran.stderr);
}
