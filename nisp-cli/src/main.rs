//! The `nisp` command: list, explain and solve the equations that NISP ships, and measure how well.

mod ablate;
mod args;
mod checkpoint;
mod config;
mod explain;
mod frontier;
mod interrupt;
mod list;
mod measure;
mod report;
mod results;
mod score;
mod solve;

use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind as Usage;
use nisp::network::Architecture;

use args::{Args, Command};

/// Bad input.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let result = parse(std::env::args_os().collect()).and_then(|args| match args {
        Parsed::Shown(code) => Ok(code),
        Parsed::Asked(Args { command: Command::List }) => list::list(),
        Parsed::Asked(Args { command: Command::Explain { equation, scene, width, layers } }) => {
            explain::explain(&equation, scene.as_deref(), Architecture::modified(width, layers))
        }
        Parsed::Asked(Args { command: Command::Solve(options) }) => solve::solve(&options),
        Parsed::Asked(Args { command: Command::Frontier(options) }) => frontier::frontier(&options),
        Parsed::Asked(Args { command: Command::Ablate(options) }) => ablate::ablate(&options),
    });
    result.unwrap_or_else(|message| {
        eprintln!("nisp: {message}");
        ExitCode::from(BAD_INPUT)
    })
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
        Err(error) => return refuse(&error),
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
    Args::try_parse_from(both).map(Parsed::Asked).or_else(|error| refuse(&error))
}

/// Shows help and versions; anything else is bad input.
fn refuse(error: &clap::Error) -> Result<Parsed, String> {
    match error.kind() {
        Usage::DisplayHelp | Usage::DisplayVersion | Usage::DisplayHelpOnMissingArgumentOrSubcommand => {
            // Nobody is left to tell if this fails.
            let _ = error.print();
            let code = if error.use_stderr() { BAD_INPUT } else { 0 };
            Ok(Parsed::Shown(ExitCode::from(code)))
        }
        _ => Err(one_line(error)),
    }
}

/// What is wrong and how to mend it, without the usage.
fn one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let wanted = |line: &&str| !line.is_empty() && !line.starts_with("Usage:") && !line.starts_with("For more");
    let lines: Vec<_> = text.lines().map(str::trim).filter(wanted).collect();
    let text = lines.join(" ");
    format!("{}; see --help", text.strip_prefix("error: ").unwrap_or(&text))
}

/// Writes to standard output; whoever closed it early wanted no more.
fn print(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(format!("standard output: {error}")),
        _ => Ok(()),
    }
}

/// The entry of a name, or what to type instead.
fn entry(name: &str) -> Result<nisp_equations::Entry, String> {
    let entries = nisp_equations::catalogue();
    let names = entries.each_ref().map(|entry| entry.name);
    entries.into_iter().find(|entry| entry.name == name).ok_or_else(|| {
        let near = nisp_data::nearest_name(name, names);
        let hint = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
        format!("there is no `{name}`{hint}; `nisp list` shows what there is: {}", names.join(", "))
    })
}
