//! What is said of answers to spoiled problems, and of answers to sound ones.

use crate::common::Place;
use serde_json::Value;

/// Exit code, status, and the checks that failed.
fn verdict(line: &str) -> (Option<i32>, String, Vec<String>) {
    let ran = Place::new().run(&format!("solve {line} --json"));
    let object: Value = serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{line}: {}", ran.stderr));
    let checks = object["verdict"].as_array().unwrap().iter().filter(|check| check["passed"] == false);
    let failed = checks.map(|check| check["check"].as_str().unwrap().to_string()).collect();
    (ran.code, object["status"].as_str().unwrap().to_string(), failed)
}

#[test]
fn a_condition_that_is_not_met_is_never_called_solved() {
    for line in ["rlc --set f0=1e8 --budget 20", "plate --set t=1e-200 --budget 20"] {
        let (code, status, failed) = verdict(line);
        assert_eq!(code, Some(3), "{line}: {status} {failed:?}");
        assert_ne!(status, "converged", "{line}");
        assert!(!failed.is_empty(), "{line}");
    }
}

#[test]
fn sound_problems_pass() {
    for line in ["rlc --budget 60 --iterations 2000", "plate --budget 60 --iterations 2000"] {
        let (code, status, failed) = verdict(line);
        assert_eq!((code, &failed[..]), (Some(0), &[][..]), "{line}: {status}");
    }
}

#[test]
fn two_sources_that_act_alike_are_named_together() {
    let place = Place::new();
    let two = "coordinates: t [s]; fields: T [K]; sources: P [K/s], S [K/s];
        on body { balance: d(T, t) + 0.1 [1/s] * T == P + S; } on samples { observe T; }";
    place.put("two.pde", two);
    let row = |i: u32| {
        let t = f64::from(i) * 0.5;
        format!("{t},{:.3}\n", 2.0 + (0.3 * t).sin())
    };
    place.put("run.csv", &format!("t [s],T [K]\n{}", (0..100).map(row).collect::<String>()));
    let ran = place.run("solve two.pde --data run.csv");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    let said = "nothing tells `P` from `S`";
    assert!(ran.stderr.contains(said) || ran.stdout.contains(said), "{}{}", ran.stdout, ran.stderr);
}

#[test]
fn two_sources_of_which_one_multiplies_a_field_are_not_told_apart() {
    let place = Place::new();
    // A mixer with its inflow and what flows in; with the inflow measured as well, both are known.
    let mixer = "coordinates: t [min]; fields: c [g/L]; sources: Q [L/min], cin [g/L];
        on mixer { balance: 10 [L] * d(c, t) == Q * (cin - c); } on samples { observe c; }";
    let (dt, mut c) = (0.01, 4.0);
    let (mut one, mut both) = ("t [min],c [g/L]\n".to_string(), "t [min],c [g/L],Q [L/min]\n".to_string());
    for i in 0..6000 {
        let t = dt * f64::from(i);
        let (flow, entering) = (2.0 + 0.8 * (0.2 * t).sin(), 5.0 + 2.0 * (0.13 * t + 1.0).cos());
        if i % 30 == 0 {
            let noise = 0.003 * (7.0 * f64::from(i)).sin();
            one += &format!("{t:.2},{:.5}\n", c + noise);
            both += &format!("{t:.2},{:.5},{:.4}\n", c + noise, flow + noise);
        }
        c += dt * flow * (entering - c) / 10.0;
    }
    place.put("mixer.pde", mixer);
    place.put("run.csv", &one);
    let ran = place.run("solve mixer.pde --data run.csv");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    assert!(ran.stdout.contains("nothing tells `Q` from `cin`"), "{}{}", ran.stdout, ran.stderr);
    place.put("metered.pde", &mixer.replace("observe c;", "observe c, Q;"));
    place.put("run.csv", &both);
    let ran = place.run("solve metered.pde --data run.csv");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
}

#[test]
fn a_table_of_known_values_that_ends_early_is_named() {
    let place = Place::new();
    let tank = "coordinates: t [s]; fields: h [m]; sources: q [m/s];
        on body { columns: p [m/s]; balance: d(h, t) == q + p; } on samples { observe h; }";
    place.put("tank.pde", tank);
    let rows = |count: u32, header: &str, value: fn(f64) -> f64| {
        let row = |i: u32| format!("{i},{}\n", value(f64::from(i)));
        format!("t [s],{header}\n{}", (0..count).map(row).collect::<String>())
    };
    place.put("known.csv", &rows(60, "p [m/s]", |t| (0.1 * t).cos()));
    place.put("run.csv", &rows(100, "h [m]", |t| 10.0 * (0.1 * t).sin() + 0.01 * t));
    let ran = place.run("solve tank.pde --data body=known.csv --data samples=run.csv");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    let said = "t = 0.000 s to t = 59.000 s: give rows of `body` for all of them";
    assert!(ran.stderr.contains(said) || ran.stdout.contains(said), "{}{}", ran.stdout, ran.stderr);
}
