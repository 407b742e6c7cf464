//! Ctrl-C keeps what was reached.
#![cfg(unix)]

mod common;

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use common::{Place, names};

fn start(place: &Place) -> Child {
    let mut command = place.command("solve pendulum --budget 120 --json");
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn signal(child: &Child) {
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
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
    signal(&child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["status"], "not_converged");
    assert!(object["warnings"].to_string().contains("interrupted after"));
    assert!(object["iterations"].as_u64().unwrap() > 0);
    assert_eq!(names(&place.path("nisp-out")), ["checkpoint.nisp", "plot.svg", "source.csv", "state.csv"]);
    let stopped = object["iterations"].as_u64().unwrap();
    let ran = place.run(&format!("solve pendulum --resume nisp-out --iterations {} --json", stopped + 2));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let object: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(object["iterations"], stopped + 2);
}
