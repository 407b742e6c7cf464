//! Frames one after the other: what is said of each, and what is not.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::Value;

use crate::common::Place;

/// A file of the repository's membranes.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/membrane").join(name)
}

/// Options of a membrane of which a sample has the parameters.
fn membrane(sample: &str) -> String {
    format!("stream membrane --budget 600 --sample {}", data(sample).display())
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn force(line: &Value) -> f64 {
    let force = line["force_N"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap().powi(2));
    force.sum::<f64>().sqrt()
}

#[test]
fn frames_of_which_none_is_a_cloud_are_bad_input() {
    let place = Place::new();
    place.put("f_1.ply", "no cloud");
    place.put("f_2.ply", "no cloud either");
    let ran = place.run(&format!("{} --frames f_*.ply", membrane("flower_1.toml")));
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(lines(&ran.stdout).len() == 2 && lines(&ran.stdout).iter().all(|line| line["status"] == "error"));
}

/// The sample's truth: 8.69 N on a patch of 426 square millimetres at rest.
#[test]
fn files_of_a_pattern_are_all_answered_and_a_bad_one_is_named() {
    let place = Place::new();
    fs::copy(data("flower_1_cloud_1.ply"), place.path("f_1.ply")).unwrap();
    place.put("f_2.ply", "no cloud");
    fs::copy(data("flower_1_cloud_0.ply"), place.path("f_3.ply")).unwrap();
    let ran = place.run(&format!("{} --frames f_*.ply --maps maps", membrane("flower_1.toml")));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let lines = lines(&ran.stdout);
    let names: Vec<_> = lines.iter().map(|line| line["frame"].as_str().unwrap()).collect();
    assert_eq!(names, ["f_1.ply", "f_2.ply", "f_3.ply"]);
    assert_eq!(lines[1]["status"], "error");
    assert!(lines[1]["error"].as_str().unwrap().contains("f_2.ply"), "{}", lines[1]);
    for line in [&lines[0], &lines[2]] {
        assert_eq!(line["status"], "converged", "{line}");
        assert!((force(line) - 8.688).abs() < 0.3, "{line}");
        let patch = &line["patches"][0];
        assert!((patch["area_at_rest_m2"].as_f64().unwrap() / 4.26e-4 - 1.0).abs() < 0.35, "{line}");
        assert!(line["seen"].as_f64().unwrap() > 0.7, "{line}");
        assert!(place.path(line["map"].as_str().unwrap()).exists());
        assert_eq!(line["dropped"], 0);
    }
    assert!(lines[0]["force_sd_N"].as_f64().unwrap() > 0.0, "{}", lines[0]);
    // The clouds leave a part of the surface unseen, of which an answer that goes on from another has no deviation.
    assert!(lines[2]["force_sd_N"].is_null(), "{}", lines[2]);
    assert_eq!(place.names(), ["f_1.ply", "f_2.ply", "f_3.ply", "maps"]);
}

#[test]
fn clouds_come_on_standard_input_with_their_lengths() {
    let place = Place::new();
    let mut child = start(&place, &format!("{} --scene identify -", membrane("inflated_3.toml")));
    let mut input = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap());
    let cloud = fs::read(data("inflated_3_cloud_1.ply")).unwrap();
    for (bytes, status) in [(cloud.clone(), "converged"), (b"ply\nnothing".to_vec(), "error"), (cloud, "converged")] {
        input.write_all(&(bytes.len() as u64).to_le_bytes()).unwrap();
        input.write_all(&bytes).unwrap();
        let line = next(&mut answers);
        assert_eq!(line["status"], status, "{line}");
        if status == "converged" {
            // The sample's own modulus.
            let learned = &line["learned"][0];
            let (value, deviation) = (learned["value"].as_f64().unwrap(), learned["deviation"].as_f64().unwrap());
            assert!((value - truth("inflated_3.toml", "young_Pa")).abs() < 5.0 * deviation, "{line}");
        }
    }
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// A number of a sample's file.
fn truth(sample: &str, key: &str) -> f64 {
    let text = fs::read_to_string(data(sample)).unwrap();
    let line = text.lines().find(|line| line.starts_with(key)).unwrap();
    line.split_once('=').unwrap().1.trim().parse().unwrap()
}

fn start(place: &Place, line: &str) -> Child {
    place.command(line).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn next(answers: &mut BufReader<ChildStdout>) -> Value {
    let mut line = String::new();
    answers.read_line(&mut line).unwrap();
    serde_json::from_str(&line).unwrap_or_else(|_| panic!("no answer but `{line}`"))
}

/// One shape asks for a modulus in proportion to the pressure.
#[test]
fn names_on_standard_input_bring_parameters() {
    let place = Place::new();
    let pressure = truth("inflated_3.toml", "gauge_pressure_Pa");
    let cloud = data("inflated_3_cloud_1.ply");
    place.put("list", &format!("{0}\n\n{0} p={1}\n", cloud.display(), 1.1 * pressure));
    let mut command = place.command(&format!("{} --scene identify -", membrane("inflated_3.toml")));
    let output = command.stdin(fs::File::open(place.path("list")).unwrap()).output().unwrap();
    let lines = lines(std::str::from_utf8(&output.stdout).unwrap());
    let moduli: Vec<f64> = lines.iter().map(|line| line["learned"][0]["value"].as_f64().unwrap()).collect();
    assert_eq!(moduli.len(), 2);
    assert!((moduli[1] / moduli[0] - 1.1).abs() < 0.01, "{moduli:?}");
}

#[cfg(unix)]
#[test]
fn a_folder_is_followed_until_the_program_is_told_to_end() {
    let place = Place::new();
    fs::create_dir(place.path("camera")).unwrap();
    fs::copy(data("inflated_1_cloud_2.ply"), place.path("camera/before.ply")).unwrap();
    let mut child = start(&place, &format!("{} --scene identify --follow camera", membrane("inflated_3.toml")));
    let mut answers = BufReader::new(child.stdout.take().unwrap());
    // Whether it listens cannot be seen from outside: frames are added until one is answered.
    let line = std::thread::scope(|scope| {
        let answer = scope.spawn(|| next(&mut answers));
        let mut number = 0;
        while !answer.is_finished() {
            fs::copy(data("inflated_3_cloud_1.ply"), place.path(&format!("camera/f_{number:04}.ply"))).unwrap();
            number += 1;
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        answer.join().unwrap()
    });
    assert_eq!(line["status"], "converged", "{line}");
    assert!(line["frame"].as_str().unwrap().contains("f_0"), "{line}");
    let killed = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let place = Place::new();
    for (line, words) in [
        ("stream pendulum --frames x", "--frames is about clouds"),
        ("stream membrane --frames x", "there is no such file"),
        ("stream membrane --follow x", "--follow x"),
        ("stream membrane", "--frames"),
        ("stream membrane --frames x --follow y", "cannot be used with"),
    ] {
        let ran = place.run(line);
        assert_eq!(ran.code, Some(2), "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{line}: {}", ran.stderr);
    }
    fs::copy(data("inflated_3_cloud_1.ply"), place.path("f.ply")).unwrap();
    let ran = place.run("stream membrane --frames f.ply");
    assert_eq!((ran.code, ran.stderr.contains("--set p=VALUE")), (Some(2), true), "{}", ran.stderr);
}
