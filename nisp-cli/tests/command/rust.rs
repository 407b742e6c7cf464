//! A crate of a user's own with the whole command line.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::common::{Place, names};

/// Builds and runs the crate as its README says, with this build's dependencies, profile and target folder.
fn run(folder: &Path, line: &str) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = Path::new(env!("CARGO_BIN_EXE_nisp")).ancestors().nth(2).unwrap();
    let mut cargo = Command::new(env!("CARGO"));
    // The workspace's profile, so that what is built already is built no more. Our own crates are built anew: with less care.
    cargo.arg("--config").arg(root.join("Cargo.toml"));
    cargo.args(["--config", "profile.release.package.nisp-runtime.codegen-units=16"]);
    for level in ["runtime.opt-level=1", "data.opt-level=0", "interpreter.opt-level=0"] {
        cargo.args(["--config", &format!("profile.release.package.nisp-{level}")]);
    }
    cargo.args(["run", "--quiet"]).args(if cfg!(debug_assertions) { None } else { Some("--release") });
    cargo.env("CARGO_TARGET_DIR", target).current_dir(folder);
    if !folder.join("Cargo.lock").exists() {
        fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    }
    cargo.arg("--").args(line.split_whitespace()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_new_crate_builds_and_has_the_whole_command_line() {
    let place = Place::new();
    let made = place.run("new kettle --rust");
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    assert_eq!(names(&place.path("kettle")), ["Cargo.toml", "README.md", "data.csv", "src", "truth.csv"]);
    let folder = place.path("kettle");
    let readme = fs::read_to_string(folder.join("README.md")).unwrap();
    for command in ["check kettle --data data.csv", "solve kettle --data data.csv --truth truth.csv"] {
        assert!(readme.contains(&format!("cargo run --release -- {command}")), "{readme}");
    }

    let listed = run(&folder, "list");
    assert!(listed.status.success(), "{}", text(&listed.stderr));
    let listed = text(&listed.stdout);
    assert!(listed.contains("A body that an unknown heater warms") && !listed.contains("pendulum"), "{listed}");

    let solved = run(&folder, "solve kettle --data data.csv --truth truth.csv --budget 60 --json");
    assert_eq!(solved.status.code(), Some(0), "{}{}", text(&solved.stdout), text(&solved.stderr));
    let object: Value = serde_json::from_slice(&solved.stdout).unwrap();
    // Two per cent of the power that the data were made with.
    let [error, size] = ["P", "P_if_zero"].map(|name| object["errors"][name].as_f64().unwrap());
    assert!(error < 0.02 * size, "{}", object["errors"]);
    let read = run(&folder, "eval nisp-out/answer.nisp --grid 5 --of d(T,t)");
    assert!(read.status.success() && text(&read.stdout).lines().count() == 6, "{}", text(&read.stderr));

    // Its own names stand in its messages, and text files are read too.
    let unknown = text(&run(&folder, "solve kettel").stderr);
    assert!(unknown.contains("did you mean `kettle`?") && unknown.contains("kettle list"), "{unknown}");
    place.put("kettle/rod.pde", "coordinates: x [m]; fields: u [m]; on rod { straight: d(u, x, 2) == 0; }");
    assert!(text(&run(&folder, "explain rod.pde").stdout).contains("rod, scene all"));
}
