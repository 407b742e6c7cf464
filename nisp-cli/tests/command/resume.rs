//! `--checkpoint` and `--resume`.

use std::fs;

use crate::common::{Place, names};
use serde_json::Value;

fn answer(place: &Place, folder: &str) -> [String; 2] {
    ["source.csv", "state.csv"].map(|name| fs::read_to_string(place.path(&format!("{folder}/{name}"))).unwrap())
}

#[test]
fn a_resumed_run_writes_the_same_answer() {
    let place = Place::new();
    // Runs that end before their time have no error bars, and are not called right.
    assert_eq!(place.run("solve pendulum --iterations 30 --out straight").code, Some(3));
    assert_eq!(place.run("solve pendulum --iterations 5 --checkpoint --out a").code, Some(3));
    assert_eq!(names(&place.path("a")), ["answer.nisp", "checkpoint.nisp", "plot.svg", "source.csv", "state.csv"]);
    let ran = place.run("solve pendulum --iterations 30 --resume a --out b --threads 1 --json");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    let object: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!((&object["iterations"], &object["settings"]["resume"]), (&30.into(), &"a".into()));
    assert_eq!(names(&place.path("b")), ["answer.nisp", "plot.svg", "source.csv", "state.csv"], "none was asked for");
    assert_eq!(answer(&place, "b"), answer(&place, "straight"));
    // Into the folder that it comes from, and from a configuration.
    place.put("run.toml", "resume = \"a\"\ncheckpoint = true\niterations = 30\nout = \"a\"\n");
    assert_eq!(place.run("solve pendulum --config run.toml").code, Some(3));
    assert_eq!(answer(&place, "a"), answer(&place, "straight"));
}

#[test]
fn what_is_no_checkpoint_of_this_run_is_refused_and_nothing_is_written() {
    let place = Place::new();
    assert_eq!(place.run("solve rlc --iterations 3 --checkpoint --out a").code, Some(3));
    let file = place.path("a/checkpoint.nisp");
    let good = fs::read(&file).unwrap();
    let refused = |line: &str, why: &str| {
        let ran = place.run(&format!("solve {line} --out none"));
        assert_eq!(ran.code, Some(2), "{line}");
        assert!(ran.stderr.contains(why), "{line}: {}", ran.stderr);
        assert_eq!(ran.stderr.trim_end().lines().count(), 1, "{}", ran.stderr);
        assert!(!place.path("none").exists(), "{line}");
    };
    refused("rlc --resume nowhere", "nowhere");
    refused("rlc --resume a --seed 1", "another problem");
    refused("rlc --resume a --set a=7.5", "another problem");
    refused("pendulum --resume a", "another problem");
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    for bad in [&flipped[..], &good[..good.len() - 3]] {
        fs::write(&file, bad).unwrap();
        refused("rlc --resume a", "damaged");
    }
    fs::write(&file, "t_s,v_V\n0,1\n").unwrap();
    refused("rlc --resume a", "not a checkpoint");
    fs::write(&file, &good).unwrap();
    // Four steps are no answer: it is written, and called what it is.
    assert_eq!(place.run("solve rlc --iterations 4 --resume a --out b").code, Some(3));
}
