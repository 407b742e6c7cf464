//! The `nisp` command: check, explain and solve equations, shipped ones and those in text files.

use std::process::ExitCode;

fn main() -> ExitCode {
    nisp_cli::Program::shipped().run()
}
