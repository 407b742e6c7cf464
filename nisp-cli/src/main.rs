//! The `nisp` command: list, explain and solve the equations that NISP ships.

mod args;
mod explain;
mod score;
mod solve;

use std::process::ExitCode;

use clap::Parser;

/// Bad input.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let args = args::Args::parse();
    let result = match args.command {
        args::Command::List => {
            for entry in nisp_equations::catalogue() {
                let scenes: Vec<_> = entry.scenes.iter().map(|scene| scene().schema.name).collect();
                println!("{:10} {} (scenes: {})", entry.name, entry.about, scenes.join(", "));
            }
            Ok(ExitCode::SUCCESS)
        }
        args::Command::Explain { equation, scene } => explain::explain(&equation, scene.as_deref()),
        args::Command::Solve(options) => solve::solve(&options),
    };
    result.unwrap_or_else(|message| {
        eprintln!("nisp: {message}");
        ExitCode::from(BAD_INPUT)
    })
}

/// The entry of a name, or what to type instead.
fn entry(name: &str) -> Result<nisp_equations::Entry, String> {
    let entries = nisp_equations::catalogue();
    entries.into_iter().find(|entry| entry.name == name).ok_or_else(|| {
        let names: Vec<_> = entries.iter().map(|entry| entry.name).collect();
        format!("there is no `{name}`; `nisp list` shows what there is: {}", names.join(", "))
    })
}
