//! Runs the command in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

/// A folder with some files, in which the command runs.
pub(crate) struct Place {
    folder: TempDir,
}

/// What a run left.
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Place {
    pub(crate) fn new() -> Place {
        Place { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn put(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nisp"));
        command.args(line.split_whitespace()).current_dir(self.folder.path());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Ran {
        let output = self.command(line).output().unwrap();
        Ran {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The rows of a CSV without its header.
    pub(crate) fn rows(&self, file: &str) -> Vec<Vec<f64>> {
        let text = fs::read_to_string(self.path(file)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    }

    /// Names of everything in the folder.
    pub(crate) fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = entries.collect();
    names.sort();
    names
}

/// A circuit's answer to `f = 6 exp(-3t)`, sampled `rows` times over two seconds.
pub(crate) fn circuit(rows: usize, line: impl Fn(usize, f64, f64) -> String) -> String {
    let sample = |row: usize| {
        let t = 2.0 * row as f64 / (rows - 1) as f64;
        let v = 44.0 / 3.0 * (-2.0 * t).exp() + (-5.0 * t).exp() / 3.0 - 9.0 * (-3.0 * t).exp();
        line(row, t, v)
    };
    (0..rows).map(sample).collect()
}

/// As a table with headers `t_s` and `v_V`.
pub(crate) fn circuit_table() -> String {
    "t_s,v_V\n".to_string() + &circuit(60, |_, t, v| format!("{t},{v}\n"))
}
