//! The `nisp` command: check, explain and solve equations, shipped ones and those in text files.

mod args;
mod calibrate;
mod check;
mod checkpoint;
mod config;
mod eval;
mod explain;
mod list;
mod new;
mod report;
mod results;
mod solve;
mod stream;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;
use nisp::network::Architecture;
use nisp_cli::options::{one_line, show};
use nisp_cli::terminal::end;

use args::{Args, Command};

/// The program's name, in its messages.
const NAME: &str = "nisp";

fn main() -> ExitCode {
    let result = parse(std::env::args_os().collect()).and_then(|args| match args {
        Parsed::Shown(code) => Ok(code),
        Parsed::Asked(Args { command: Command::List }) => list::list(),
        Parsed::Asked(Args { command: Command::Check { equation, scene, data, column, latex } }) => {
            check::check(&equation, scene, data, column, latex)
        }
        Parsed::Asked(Args { command: Command::New { name } }) => new::new(&name),
        Parsed::Asked(Args { command: Command::Explain { equation, scene, width, layers } }) => {
            explain::explain(&equation, scene.as_deref(), Architecture::modified(width, layers))
        }
        Parsed::Asked(Args { command: Command::Calibrate(frames) }) => calibrate::calibrate(&frames),
        Parsed::Asked(Args { command: Command::Eval(options) }) => eval::eval(&options),
        Parsed::Asked(Args { command: Command::Stream(options) }) => stream::stream(&options),
        Parsed::Asked(Args { command: Command::Solve(options) }) => solve::solve(&options),
    });
    end(NAME, result)
}

enum Parsed {
    Asked(Args),
    /// Help or version, which is all that was wanted.
    Shown(ExitCode),
}

/// Reads the command line, and the configuration that it names.
fn parse(words: Vec<OsString>) -> Result<Parsed, String> {
    let args = match Args::try_parse_from(&words) {
        Ok(args) => args,
        Err(error) => return show(&error).map(Parsed::Shown),
    };
    let Command::Solve(options) = &args.command else { return Ok(Parsed::Asked(args)) };
    let Some(path) = &options.config else { return Ok(Parsed::Asked(args)) };
    let flags = config::flags(path)?;
    // The file alone first, so that a fault of it is said to be one.
    let alone = words[..2].iter().cloned().chain([options.equation.clone().into()]).chain(flags.clone());
    if let Err(error) = Args::try_parse_from(alone) {
        return Err(format!("{}: {}", path.display(), one_line(&error)));
    }
    let both = words[..2].iter().cloned().chain(flags).chain(words[2..].iter().cloned());
    Args::try_parse_from(both).map(Parsed::Asked).or_else(|error| show(&error).map(Parsed::Shown))
}
