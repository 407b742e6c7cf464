//! Standard output and standard error may be closed, full or never read, and paths may be no text: nothing panics.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::process::Stdio;

use crate::common::{Place, circuit_table, names};

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

#[test]
fn a_full_standard_error_changes_no_exit_code() {
    let place = Place::new();
    for line in ["solve nope", "solve rlc --data nowhere.csv", "explain", "solve rlc --width x"] {
        assert_eq!(place.command(line).stderr(full()).status().unwrap().code(), Some(2), "{line}");
    }
    // On the way of signals, too: see interrupt.rs.
}

#[test]
fn a_full_standard_output_leaves_the_files_and_says_so() {
    let place = Place::new();
    for more in ["", "--json"] {
        let line = format!("solve rlc --iterations 2 --out out {more}");
        let output = place.command(&line).stdout(full()).output().unwrap();
        let words = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{words}");
        assert!(words.starts_with("nisp: standard output: ") && !words.contains("panicked"), "{words}");
        assert_eq!(names(&place.path("out")), ["answer.nisp", "plot.svg", "source.csv", "state.csv"]);
        fs::remove_dir_all(place.path("out")).unwrap();
    }
    let code = place.command("list").stdout(full()).stderr(full()).status().unwrap().code();
    assert_eq!(code, Some(2));
}

#[test]
fn a_path_that_is_no_text_is_written_as_far_as_it_goes() {
    let place = Place::new();
    let name = OsStr::from_bytes(b"volts\xff.csv");
    fs::write(place.path(".").join(name), circuit_table()).unwrap();
    let mut command = place.command("solve rlc --iterations 2 --json --out");
    command.arg(OsStr::from_bytes(b"out\xfe")).arg("--data").arg(name);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["settings"]["data"], "volts\u{fffd}.csv");
    assert_eq!(object["files"]["folder"], "out\u{fffd}");
    assert!(place.path(".").join(OsStr::from_bytes(b"out\xfe/source.csv")).exists());
}
