//! Runs the command, as those who work on NISP do.

mod ablate;
mod frontier;

use std::path::PathBuf;
use std::process::Command;

use tempfile::TempDir;

/// A folder in which the command runs.
struct Place {
    folder: TempDir,
}

/// What a run left.
struct Ran {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Place {
    fn new() -> Place {
        Place { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, line: &str) -> Ran {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nisp-lab"));
        let output = command.args(line.split_whitespace()).current_dir(self.folder.path()).output().unwrap();
        Ran {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}
