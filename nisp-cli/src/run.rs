//! What a command line asks for is done.

use std::ffi::OsString;
use std::process::ExitCode;

use nisp::network::Architecture;
use serde_json::json;

use crate::args::{self, Args, Command, Parsed};
use crate::program::Program;
use crate::terminal::{end, print};
use crate::{calibrate, check, eval, explain, list, new, solve, stream};

impl Program {
    /// Does what the command line of the process asks for.
    pub fn run(&self) -> ExitCode {
        let words: Vec<OsString> = std::env::args_os().collect();
        let is_for_machines = words.iter().any(|word| word == "--json");
        let result = self.ask(words);
        if let (true, Err(message)) = (is_for_machines, &result) {
            // Standard error says it anyway.
            let _ = print(&format!("{}\n", json!({ "status": "error", "error": message })));
        }
        end(self.name, result)
    }

    fn ask(&self, words: Vec<OsString>) -> Result<ExitCode, String> {
        let args = match args::parse(self, words)? {
            Parsed::Shown(code) => return Ok(code),
            Parsed::Asked(Args { command }) => command,
        };
        match args {
            Command::List => list::list(self),
            Command::Check { equation, scene, data, column, latex } => {
                check::check(&self.entry(&equation)?, scene, data, column, latex)
            }
            Command::New { name, rust } => new::new(&name, rust),
            Command::Explain { equation, scene, width, layers } => {
                let architecture = Architecture::modified(width, layers);
                explain::explain(&self.entry(&equation)?, scene.as_deref(), architecture)
            }
            Command::Calibrate(frames) => calibrate::calibrate(self, &frames),
            Command::Eval(options) => eval::eval(self, &options),
            Command::Solve(options) => solve::solve(self, &options),
            Command::Stream(options) => stream::stream(self, &options),
        }
    }
}
