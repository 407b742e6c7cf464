//! The `nisp-lab` command: measures how good the answers of `nisp` are, for those who work on it.

mod ablate;
mod cases;
mod frontier;
mod honesty;
mod measure;
mod peers;
mod random;
mod records;
mod rk4;
mod stream;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use nisp_cli::options::show;
use nisp_cli::terminal::end;

/// Measure how good NISP is: error against time, and what each part of the method is worth.
#[derive(Parser)]
#[command(version)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure error against time over methods, widths and precisions, beside classical rivals.
    Frontier(Box<frontier::Options>),
    /// Measure what each part of the method is worth, beside what the paper says of its own.
    Ablate(Box<ablate::Options>),
    /// Measure whether what is said of answers is true, on right and on spoiled data.
    Honesty(Box<honesty::Options>),
    /// Measure errors and error bars of sources on simulated records of many equations.
    Records(records::Options),
    /// Solve problems that others publish with their programs, from texts and data made anew.
    Peers(cases::Cases),
    /// Follow tools that move over the membrane: time of an update, patch and force beside single answers.
    Stream(stream::Options),
}

/// The program's name, in its messages.
const NAME: &str = "nisp-lab";

/// A shipped equation, or one in a text file.
fn entry(name: &str) -> Result<nisp_equations::Entry, String> {
    nisp_cli::Program::shipped().entry(name)
}

fn main() -> ExitCode {
    let result = match Args::try_parse() {
        Ok(Args { command: Command::Frontier(options) }) => frontier::frontier(&options),
        Ok(Args { command: Command::Ablate(options) }) => ablate::ablate(&options),
        Ok(Args { command: Command::Honesty(options) }) => honesty::honesty(&options),
        Ok(Args { command: Command::Records(options) }) => records::records(&options),
        Ok(Args { command: Command::Peers(options) }) => peers::peers(&options),
        Ok(Args { command: Command::Stream(options) }) => stream::stream(&options),
        Err(error) => show(&error),
    };
    end(NAME, result)
}
