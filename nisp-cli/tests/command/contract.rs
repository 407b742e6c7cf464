//! Names, fields and exit codes that scripts depend on.

use std::fs;

use crate::common::{Place, circuit, circuit_table, names};
use serde_json::Value;

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn json_is_one_object_with_the_promised_fields_and_nothing_else() {
    let place = Place::new();
    let ran = place.run("solve rlc --json --iterations 40 --seed 5 --threads 1 --optimizer lbfgs --precision f32");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert_eq!(ran.stderr, "");
    assert_eq!(ran.stdout.matches('\n').count(), 1);
    let object = object(&ran.stdout);
    let mut promised = [
        "scene",
        "status",
        "seed",
        "precision",
        "optimizer",
        "threads",
        "wall_s",
        "iterations",
        "loss",
        "warnings",
        "verdict",
        "errors",
        "coordinates",
        "sources",
        "state",
        "learned",
        "terms",
        "carrier",
        "groups",
        "skipped",
        "data",
        "files",
        "settings",
    ];
    promised.sort_unstable();
    assert_eq!(keys(&object), promised);
    assert_eq!(keys(&object["errors"]), ["f", "f_if_zero", "v"]);
    assert_eq!(object["scene"], "rlc");
    assert_eq!(object["status"], "budget");
    assert_eq!(object["seed"], 5);
    assert_eq!(object["precision"], "f32");
    assert_eq!(object["optimizer"], "lbfgs");
    assert_eq!(object["threads"], 1);
    assert_eq!(object["iterations"], 40);
    // After so few steps the data are not followed yet.
    let verdict = object["verdict"].as_array().unwrap();
    let failed = |check: &&serde_json::Value| check["passed"] == false;
    let misfit = verdict.iter().filter(failed).find(|check| check["check"] == "misfit").unwrap();
    assert!(misfit["message"].as_str().unwrap().contains("`v` is not resolved"), "{verdict:?}");
    assert!(object["wall_s"].as_f64().unwrap() > 0.0 && object["loss"].as_f64().unwrap() > 0.0);
    // The mean of 6 exp(-3t) over [0, 2] s is 0.9975; the trapezia's ends add a little.
    assert!((object["errors"]["f_if_zero"].as_f64().unwrap() - 0.9975).abs() < 5e-3);
    assert_eq!(names(&place.path("nisp-out")), ["answer.nisp", "plot.svg", "source.csv", "state.csv"]);
}

#[test]
fn without_options_for_it_the_number_of_threads_is_the_machines() {
    let place = Place::new();
    let threads = std::thread::available_parallelism().unwrap().get();
    let ran = place.run("solve rlc --json --iterations 2");
    assert_eq!(object(&ran.stdout)["threads"], threads);
}

#[test]
fn every_option_of_the_contract_is_taken() {
    let place = Place::new();
    place.put("data.csv", &("when,volts\n".to_string() + &circuit(60, |_, t, v| format!("{t},{v}\n"))));
    place.put(
        "truth.csv",
        &("t [s],f [V]\n".to_string() + &circuit(9, |_, t, _| format!("{t},{}\n", 6.0 * (-3.0 * t).exp())) + "3,0\n"),
    );
    let ran = place.run(
        "solve rlc --scene recover --data data.csv --column t=when --column v=volts --truth truth.csv --set f0=6 --seed 1 \
         --precision f64 --optimizer broyden --width 8 --layers 2 --threads 2 --budget 20 --iterations 1500 --out a/b --json",
    );
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let object = object(&ran.stdout);
    assert!(object["warnings"].to_string().contains("1 of 10 rows of the truth"), "{object}");
    // Only what the truth has is scored.
    assert_eq!(keys(&object["errors"]), ["f", "f_if_zero"]);
    assert!(object["errors"]["f"].as_f64().unwrap() < 1e-2, "{object}");
    let source = fs::read_to_string(place.path("a/b/source.csv")).unwrap();
    assert!(source.starts_with("t [s],f [V]"), "{source}");
    assert_eq!(source.lines().count(), 61);
    let state = fs::read_to_string(place.path("a/b/state.csv")).unwrap();
    assert!(state.starts_with("t [s],v [V]"), "{state}");
    assert!(fs::read_to_string(place.path("a/b/plot.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn parameters_are_set_in_their_declared_unit() {
    let place = Place::new();
    let f = |value: &str| {
        place.run(&format!("solve rlc --iterations 400 --json --out {value} --set f0={value}"));
        let source = fs::read_to_string(place.path(value).join("source.csv")).unwrap();
        source.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse::<f64>().unwrap()
    };
    assert!((f("6") - 6.0).abs() < 0.3 && (f("9") - 9.0).abs() < 0.3);
}

#[test]
fn a_header_in_milliseconds_is_converted() {
    let place = Place::new();
    place.put("s.csv", &circuit_table());
    place.put("ms.csv", &("t_ms,v [mV]\n".to_string() + &circuit(60, |_, t, v| format!("{},{}\n", 1e3 * t, 1e3 * v))));
    for name in ["s", "ms"] {
        assert_eq!(place.run(&format!("solve rlc --data {name}.csv --iterations 200 --out {name}")).code, Some(0));
    }
    let first = |name: &str| {
        fs::read_to_string(place.path(name).join("state.csv")).unwrap().lines().nth(60).unwrap().to_string()
    };
    let numbers = |line: String| line.split(',').map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let (a, b) = (numbers(first("s")), numbers(first("ms")));
    assert_eq!(a[0], 2.0);
    assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 0.1, "{a:?} {b:?}");
}

#[test]
fn a_configuration_stands_for_flags_and_flags_win() {
    let place = Place::new();
    fs::create_dir(place.path("study")).unwrap();
    place.put("study/volts.csv", &("t,u\n".to_string() + &circuit(60, |_, t, v| format!("{t},{v}\n"))));
    place.put(
        "study/run.toml",
        "data = \"volts.csv\"\ncolumn = { v = \"u\" }\nset = { f0 = 6 }\nwidth = 5\niterations = 7\nseed = 3\njson = true\nout = \"out\"\n",
    );
    let ran = place.run("solve rlc --config study/run.toml --seed 4 --set f0=6.5");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    let object = object(&ran.stdout);
    assert_eq!((&object["seed"], &object["iterations"]), (&4.into(), &7.into()));
    assert_eq!((&object["settings"]["width"], &object["settings"]["parameters"]["f0"]), (&5.into(), &6.5.into()));
    assert_eq!(names(&place.path("study/out")).len(), 4);
    let refusal = |content: &str| {
        place.put("bad.toml", content);
        let ran = place.run("solve rlc --config bad.toml");
        assert_eq!((ran.code, ran.stderr.lines().count()), (Some(2), 1), "{}", ran.stderr);
        ran.stderr
    };
    assert!(refusal("witdh = 3").contains("bad.toml") && refusal("witdh = 3").contains("--width"));
    assert!(refusal("seed = 1\nwidth = [3]").contains("`width`"));
    assert!(refusal("seed = 1\nwidth = \n").contains("line 2"));
    assert!(refusal("config = \"x\"").contains("`config`"));
}

#[test]
fn a_run_that_cannot_converge_says_so_with_code_3() {
    let place = Place::new();
    // Too accurate data for f32: it stalls, long before the budget.
    let ran = place.run("solve rlc --precision f32 --optimizer lbfgs --budget 60 --json");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    let object = object(&ran.stdout);
    assert_eq!(object["status"], "not_converged");
    assert!(object["warnings"][0].as_str().unwrap().contains("f64"));
    assert_eq!(names(&place.path("nisp-out")).len(), 4);
}

#[test]
fn the_answer_does_not_depend_on_the_threads() {
    let place = Place::new();
    for threads in ["1", "2"] {
        place.run(&format!("solve pendulum --iterations 5 --threads {threads} --out {threads}"));
    }
    let source = |threads: &str| fs::read(place.path(threads).join("source.csv")).unwrap();
    assert!(!source("1").is_empty() && source("1") == source("2"));
}

#[test]
fn lists_and_explains() {
    let place = Place::new();
    let list = place.run("list");
    assert!(list.code == Some(0) && list.stdout.contains("pendulum") && list.stdout.contains("--scene free"));
    let explained = place.run("explain pendulum");
    assert_eq!(explained.code, Some(0));
    for part in ["coordinate t", "source     f", "[N]", "parameter  m0", "0.005", "channels 3", "skipped"] {
        assert!(explained.stdout.contains(part), "{part}");
    }
    // One product of two layers of ten units over three channels: two operations a multiply-add, forward, twice back.
    let explained = place.run("explain pendulum --width 10").stdout;
    assert!(explained.contains("matrix products        600       1200"), "{explained}");
    assert!(place.run("explain rlc --scene free").stdout.contains("scene free"));
    assert!(
        place.run("explain bubble").stdout.contains("size       a     [m]       0.06  Semi-axis of the rim along x.")
    );
    assert!(place.names().is_empty());
}

#[test]
fn help_teaches() {
    let place = Place::new();
    let help = place.run("solve --help");
    assert_eq!(help.code, Some(0));
    for part in ["Examples:", "declared unit", "source.csv", "Ctrl-C", "Exit codes:", "[default: 16]", "q_m_sigma0.01"]
    {
        assert!(help.stdout.contains(part), "{part}");
    }
    let eval = place.run("eval --help");
    for part in ["Examples:", "bending moment", "_sd", "NaN", "SI units", "Exit codes:"] {
        assert!(eval.stdout.contains(part), "{part}");
    }
    assert!(help.stdout.lines().chain(eval.stdout.lines()).all(|line| line.chars().count() <= 120));
    assert_eq!(place.run("").code, Some(2));
    assert_eq!(place.run("--version").code, Some(0));
}
