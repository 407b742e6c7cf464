//! Ctrl-C keeps what was reached.
#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::{Place, circuit, names};

fn start(place: &Place) -> Child {
    let mut command = place.command("solve pendulum --carrier network --budget 120 --json");
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Signals once the results folder is there: from then on the command listens.
fn started(place: &Place) {
    while !place.path("nisp-out").exists() {
        sleep(Duration::from_millis(10));
    }
    sleep(Duration::from_millis(500));
}

#[test]
fn ctrl_c_writes_the_best_state_and_says_so() {
    let place = Place::new();
    let child = start(&place);
    started(&place);
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["status"], "not_converged");
    assert!(object["warnings"].to_string().contains("interrupted after"));
    assert!(object["iterations"].as_u64().unwrap() > 0);
    assert_eq!(
        names(&place.path("nisp-out")),
        ["answer.nisp", "checkpoint.nisp", "plot.svg", "source.csv", "state.csv"]
    );
    let stopped = object["iterations"].as_u64().unwrap();
    let ran =
        place.run(&format!("solve pendulum --carrier network --resume nisp-out --iterations {} --json", stopped + 2));
    let object: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    // Two steps more may be too few for an answer that passes all checks.
    let passes = object["verdict"].as_array().unwrap().iter().all(|check| check["passed"] == true);
    assert_eq!(ran.code, Some(if passes { 0 } else { 3 }), "{}", ran.stderr);
    assert_eq!(object["iterations"], stopped + 2);
}

#[test]
fn sigterm_is_as_ctrl_c() {
    let place = Place::new();
    let child = start(&place);
    started(&place);
    signal(&child, "-TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(3));
    assert_eq!(
        names(&place.path("nisp-out")),
        ["answer.nisp", "checkpoint.nisp", "plot.svg", "source.csv", "state.csv"]
    );
}

/// A run that has written its files and waits for ever, because nobody reads its standard output.
fn stuck(place: &Place) -> Child {
    place.put("v.csv", &("t_s,v_V\n".to_string() + &circuit(4000, |_, t, v| format!("{t},{v}\n"))));
    let mut command = place.command("solve rlc --data v.csv --iterations 2 --json");
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("nisp-out/plot.svg").exists() {
        sleep(Duration::from_millis(10));
    }
    sleep(Duration::from_millis(500));
    child
}

#[test]
fn a_run_that_cannot_go_on_ends_all_the_same() {
    let place = Place::new();
    let mut child = stuck(&place);
    assert!(child.try_wait().unwrap().is_none(), "the pipe holds less than the object");
    signal(&child, "-TERM");
    let code = child.wait().unwrap().code();
    let output = child.wait_with_output().unwrap();
    let words = String::from_utf8(output.stderr).unwrap();
    assert_eq!(code, Some(3), "{words}");
    assert!(words.contains("interrupted; the results are in nisp-out"), "{words}");
    assert_eq!(names(&place.path("nisp-out")), ["answer.nisp", "plot.svg", "source.csv", "state.csv"]);
}

#[test]
fn a_second_signal_ends_it_at_once() {
    let place = Place::new();
    let mut child = stuck(&place);
    signal(&child, "-TERM");
    sleep(Duration::from_millis(300));
    signal(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn signals_are_heard_where_standard_error_is_full() {
    let place = Place::new();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let child = place
        .command("solve pendulum --carrier network --budget 120")
        .stdout(Stdio::piped())
        .stderr(full)
        .spawn()
        .unwrap();
    started(&place);
    signal(&child, "-TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(3));
}
