//! The folder of results: one run at a time, all files or none, and an answer is never nowhere.
#![cfg(unix)]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::{Place, circuit_table, names};
use serde_json::Value;

const FILES: [&str; 4] = ["answer.nisp", "plot.svg", "source.csv", "state.csv"];
const WITH_CHECKPOINT: [&str; 5] = ["answer.nisp", "checkpoint.nisp", "plot.svg", "source.csv", "state.csv"];

/// Starts a run of many steps and waits until it has its folder.
fn start(place: &Place, line: &str) -> Child {
    let mut command = place.command(line);
    command.env("TMPDIR", place.path("tmp"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // It writes its number there as soon as the folder is its own.
    while fs::read_to_string(place.path("a/out/.nisp.lock")).unwrap_or_default().is_empty() {
        sleep(Duration::from_millis(10));
    }
    child
}

/// Asks it to stop, and gives its exit code, its object and its words.
fn stop(child: Child) -> (Option<i32>, String, String) {
    // A moment for the first steps.
    sleep(Duration::from_millis(300));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

const LONG: &str = "solve pendulum --carrier network --budget 120 --out a/out";

#[test]
fn a_folder_holds_the_files_of_one_run_and_what_is_the_users_own() {
    let place = Place::new();
    assert_eq!(place.run("solve pendulum --set g=1.62 --out a").code, Some(3));
    assert!(place.path("a/misfits.csv").exists());
    assert_eq!(place.run("solve pendulum --out a").code, Some(0));
    assert_eq!(names(&place.path("a")), FILES);
    fs::create_dir(place.path("own")).unwrap();
    fs::write(place.path("own/misfits.csv"), "mine").unwrap();
    assert_eq!(place.run("solve pendulum --out own").code, Some(0));
    assert_eq!(fs::read_to_string(place.path("own/misfits.csv")).unwrap(), "mine");
}

#[test]
fn a_file_that_is_read_is_not_written_over() {
    let place = Place::new();
    fs::create_dir(place.path("own")).unwrap();
    let data = circuit_table();
    place.put("own/state.csv", &data);
    let solve = "solve rlc --iterations 2 --out own --data own/state.csv";
    let ran = place.run(solve);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    let words =
        "own/state.csv is read here, and results would be written over it: give another --out, or move the file";
    assert!(ran.stderr.contains(words), "{}", ran.stderr);
    assert_eq!(fs::read_to_string(place.path("own/state.csv")).unwrap(), data);
    assert_eq!(names(&place.path("own")), ["state.csv"]);
    // An answer is read, too.
    assert_eq!(place.run("solve pendulum --out p").code, Some(0));
    let answer = fs::read(place.path("p/answer.nisp")).unwrap();
    assert_eq!(place.run("eval p/answer.nisp --grid 5 --out p/answer.nisp").code, Some(2));
    assert_eq!(fs::read(place.path("p/answer.nisp")).unwrap(), answer);
}

#[test]
fn points_where_the_answer_does_not_hold_have_no_value() {
    let place = Place::new();
    let text = "coordinates: t [s];\nfields: v [m/s];\nsources: a [m/s^2];\n\
                on ride { motion: d(v, t) == a; }\non samples { observe v; }\n";
    fs::write(place.path("ride.pde"), text).unwrap();
    let speed = |at: u32| {
        let t = 0.1 * f64::from(at);
        format!("{t:.1},{:.6}\n", t.sin() + 0.01 * (f64::from(at * at)).sin())
    };
    fs::write(place.path("ride.csv"), format!("t [s],v [m/s]\n{}", (0..100).map(speed).collect::<String>())).unwrap();
    fs::write(place.path("at.csv"), "t [s]\n1\n900\n").unwrap();
    let ran = place.run("solve ride.pde --data ride.csv --at at.csv --out a");
    assert!(ran.stdout.contains("1 of 2 points of at.csv lie outside"), "{}{}", ran.stdout, ran.stderr);
    let source = fs::read_to_string(place.path("a/source.csv")).unwrap();
    assert!(source.lines().last().unwrap().starts_with("900,NaN,NaN"), "{source}");
}

#[test]
fn two_runs_into_one_folder_do_not_mix() {
    let place = Place::new();
    let first = start(&place, &format!("{LONG} --json"));
    let second = place.run("solve rlc --iterations 2 --out a/out");
    assert_eq!((second.code, second.stdout.as_str(), second.stderr.lines().count()), (Some(2), "", 1));
    let words = format!("a/out: another run (process {}) writes into this folder", first.id());
    assert!(second.stderr.contains(&words) && second.stderr.contains("--out"), "{}", second.stderr);
    let (code, object, words) = stop(first);
    assert_eq!(code, Some(3), "{words}");
    assert_eq!(serde_json::from_str::<Value>(&object).unwrap()["scene"], "pendulum");
    // The first is through: the folder is free, and nothing of the lock stays.
    assert_eq!(place.run("solve rlc --iterations 2 --out a/out").code, Some(3));
    assert_eq!(names(&place.path("a/out")), WITH_CHECKPOINT);
}

#[test]
fn a_killed_run_leaves_the_folder_free() {
    let place = Place::new();
    let mut child = start(&place, LONG);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(place.run("solve rlc --iterations 2 --out a/out").code, Some(3));
    assert_eq!(names(&place.path("a/out")), FILES);
}

#[test]
fn a_folder_that_is_deleted_meanwhile_is_made_again() {
    let place = Place::new();
    let child = start(&place, &format!("{LONG} --json"));
    fs::remove_dir_all(place.path("a")).unwrap();
    let (code, object, words) = stop(child);
    assert_eq!(code, Some(4), "{words}");
    let object: Value = serde_json::from_str(&object).unwrap();
    assert_eq!(object["files"]["folder"], "a/out");
    assert!(object["files"]["fault"].as_str().unwrap().contains("the folder is gone"), "{object}");
    assert_eq!(names(&place.path("a/out")), WITH_CHECKPOINT);
}

#[test]
fn a_file_that_cannot_be_replaced_sends_all_of_them_beside() {
    let place = Place::new();
    let child = start(&place, LONG);
    fs::create_dir(place.path("a/out/state.csv")).unwrap();
    let (code, table, words) = stop(child);
    assert_eq!(code, Some(4), "{words}");
    assert!(
        table.contains("plot.svg, answer.nisp and checkpoint.nisp to a/out-1, because a/out/state.csv: "),
        "{table}"
    );
    assert_eq!(names(&place.path("a/out")), ["state.csv"]);
    assert_eq!(names(&place.path("a/out-1")), WITH_CHECKPOINT);
    // Known before the start, it is bad input.
    let ran = place.run("solve rlc --iterations 2 --out a/out");
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
    assert!(ran.stderr.contains("a/out/state.csv") && ran.stderr.contains("a folder stands where"), "{}", ran.stderr);
    assert_eq!(names(&place.path("a/out")), ["state.csv"]);
}

#[test]
fn without_any_folder_the_tables_are_printed() {
    let place = Place::new();
    fs::create_dir(place.path("tmp")).unwrap();
    for (temporary, json) in [(true, true), (false, true), (false, false)] {
        let child = start(&place, &format!("{LONG} {}", if json { "--json" } else { "" }));
        fs::remove_dir_all(place.path("a")).unwrap();
        // Neither the folder nor one beside it can be made.
        fs::write(place.path("a"), "in the way").unwrap();
        if !temporary {
            fs::remove_dir_all(place.path("tmp")).ok();
        }
        let (code, out, words) = stop(child);
        assert_eq!(code, Some(4), "{words}");
        match (temporary, json) {
            (true, _) => {
                let object: Value = serde_json::from_str(&out).unwrap();
                let folder = object["files"]["folder"].as_str().unwrap();
                assert!(folder.starts_with(place.path("tmp").to_str().unwrap()), "{folder}");
                assert_eq!(names(folder.as_ref()), WITH_CHECKPOINT);
            }
            (false, true) => {
                let object: Value = serde_json::from_str(&out).unwrap();
                assert_eq!((&object["files"]["folder"], &object["files"]["names"][0]), (&Value::Null, &Value::Null));
                assert_eq!(object["sources"][0]["values"].as_array().unwrap().len(), 201);
            }
            (false, false) => {
                let (_, table) = out.split_once("\nsource.csv\n").unwrap();
                let (source, state) = table.split_once("\nstate.csv\n").unwrap();
                assert!(source.starts_with("t [s],f [N]\n") && state.starts_with("t [s],q [m],"), "{table:.200}");
                assert_eq!((source.lines().count(), state.lines().count()), (202, 202));
            }
        }
        fs::remove_file(place.path("a")).unwrap();
    }
}
