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
